"""States of all elements in a scan, determined from forces and displacements alone."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.critical_paths.draw import Path
from loadshare.certify import Judge, Verdicts
from loadshare.certify.bound import Bounds
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.job.many import solve_blocks
from loadshare.settings import CERTIFY
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.line import Line
from loadshare.train.equilibria import Equilibria
from loadshare.train.samples import samples_of

Array = NDArray[np.float64]
StatesByName = dict[str, NDArray[np.str_]]
"""States of each element at the values of a scan, by name."""
BAND = 1e-8
"""Force over load, or radius over deflection, within which a scan does not decide on a state."""
BLOCK = 8192
"""Samples solved together."""
CLIMBING = 20
"""Most samples of a block that go through the slower methods when the fast method has no answer."""


def states_by_name(
    line: Line, values: Array, answers: Equilibria, certified: NDArray[np.bool_]
) -> StatesByName:
    """Determine the state of every element at every value, from forces and displacements alone.

    Returns
    -------
    dict of str to ndarray of str, shape (S,)
        Empty where a state is within round-off of another, or there is no certified answer.
    """
    names, push, length = answers.names, line.structure.force, line.structure.length
    found: StatesByName = {}
    forces = {
        **dict(zip(names.flanks, answers.flank_force.T, strict=True)),
        **dict(zip(names.contacts, answers.ring_force.T, strict=True)),
    }
    for name, force in forces.items():
        state = np.where(force > BAND * push, "closed", np.where(force > 0.0, "", "open"))
        found[name] = np.where(certified, state, "")
    numbers = line.numbers(1, values)
    torque = np.zeros((len(values), len(names.radials)))
    train = line.first
    for k, (_, gear) in enumerate(names.radials):
        for flank, force in zip(names.flanks, answers.flank_force.T, strict=True):
            torque[:, k] += train.transmitted(gear, {flank: 1.0}) * force
    radials = line.structure.radials
    for k, (name, gear) in enumerate(names.radials):
        j = next(i for i, r in enumerate(radials) if r.name == name)
        given = np.broadcast_to(numbers.radial[:, j], (len(values), numbers.radial.shape[2]))
        frame = train.gears[gear].frame
        column = line.structure.radial_column(j)
        centre = numbers.gap[:, column : column + 2] * length
        moved = answers.displacement[:, names.gears.index(gear)] @ frame.T - centre
        radius = np.linalg.norm(moved, axis=1) / length
        law = at.graph(given, torque[:, k] / push, radius)
        force = np.linalg.norm(answers.radial_reaction[:, k], axis=1) / push
        if name.startswith("ring"):
            state = np.where(force > BAND, "on boundary", "inside")
        else:
            state = _spline_state(law, radius, force)
        found[name] = np.where(certified, state, "")
    return found


def _spline_state(law: at.Graph, radius: Array, force: Array) -> Array:
    """Return the state of a spline from scaled radius and force; empty close to a corner."""
    jump = law.bound > law.first * law.stick * (1.0 + 1e-9)
    state = np.where(radius < law.reach, "slip", "stop")
    state = np.where(radius < law.stick, "stick", state)
    near = np.abs(radius - law.stick) <= BAND
    low = law.first * np.where(np.isfinite(law.stick), law.stick, 0.0)
    inside = (force > low + BAND) & (force < law.bound - BAND)
    state = np.where(near, np.where(jump & inside, "about to slip", ""), state)
    return np.where((np.abs(radius - law.reach) <= BAND) & ~near, "", state)


class Balance(Judge):
    """A judge of balance alone: states do not depend on bounds, which take ten times as long."""

    def judge(self, *given: Any, **named: Any) -> Verdicts:
        """Judge equilibria as if all torques were bounded."""
        answers: Equilibria = given[1]
        verdicts = super().judge(*given, **named | {"bounded": False})
        none = Bounds(self.columns, np.zeros(len(answers.rotation)), None, None, None)
        return replace(verdicts, bounds=none)


class Scan(Machine):
    """A machine whose certificate checks balance alone."""

    @cached_property
    def judge(self) -> Judge:
        """Certificate that checks balance alone."""
        return Balance(self.train)


def _thinned(rows: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Return every n-th row, such that at most `most` remain."""
    return rows[:: max(1, -(-len(rows) // most))]


def scanned(path: Path, line: Line, values: Array, engine: str) -> StatesByName:
    """Scan a path; states are empty where no certified answer is known."""
    groups = samples_of(path.case, _table(path, values))
    if len(groups) > 1:
        return _climbed(path, line, values, engine)
    samples = groups[0][1]
    machine = Scan(samples.train)
    parts: list[StatesByName] = []
    for at_ in range(0, len(values), BLOCK):
        block = slice(at_, at_ + BLOCK)
        here = values[block]
        situations = samples.take(block).situations(1)
        solver = engine_named(engine, len(values))
        found = machine.answer(situations, CERTIFY.tolerance, solver, starts=(1,))
        states = states_by_name(line, here, found.equilibria, found.passed)
        left = _thinned(np.flatnonzero(~found.passed), CLIMBING)
        if len(left):
            for name, more in _climbed(path, line, here[left], engine).items():
                states[name][left] = more
        parts.append(states)
    return {name: np.concatenate([p[name] for p in parts]) for name in parts[0]}


def _climbed(path: Path, line: Line, values: Array, engine: str) -> StatesByName:
    """Return states from the whole sequence of methods, from the fast method to the slowest."""
    states: StatesByName = {}
    table = _table(path, values)
    for block in solve_blocks(path.case, table, positions=[1], engine=engine, workers=1):
        rows = block.rows
        here = states_by_name(line, values[rows], block.equilibria[0], block.certified[:, 0])
        for name, found in here.items():
            states.setdefault(name, np.full(len(values), "", dtype="<U16"))[rows] = found
    return states


def _table(path: Path, values: Array) -> dict[str, Array]:
    unit = f" [{path.unit}]" if path.unit else ""
    return {f"{key}{unit}": values for key in path.keys}
