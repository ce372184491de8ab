"""Solve contact problems that are written explicitly, and judge answers from the arrays alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from loadshare.arguments import check_mapping
from loadshare.array_types import Array, floats
from loadshare.case.table import Table
from loadshare.contact.backends.backend import backend
from loadshare.contact.conflict import conflict
from loadshare.contact.findings import Unsolved
from loadshare.contact.left_open import left_open
from loadshare.contact.outer import Settled, settle
from loadshare.contact.plan import Plan
from loadshare.contact.problem import ContactProblem, Row
from loadshare.contact.problem_checks import check_problem
from loadshare.contact.radial import RadialLaw
from loadshare.contact.record import Options
from loadshare.contact.runaway import runaway
from loadshare.equality import Comparable
from loadshare.errors import Refused
from loadshare.one_thread import one_thread
from loadshare.settings import CONTACT


@dataclass(frozen=True, slots=True)
class Residuals:
    """Residuals of a claimed answer, in forces and lengths of the problem.

    Attributes
    ----------
    balance : float
        Largest unbalanced force along a coordinate.
    law : float
        Largest deviation of a contact or graph from its law, or overlap of an open contact.
    sign : float
        Largest pull of a contact.
    """

    balance: float
    law: float
    sign: float

    @property
    def worst(self) -> float:
        """The largest residual; NaN counts as infinite."""
        every = (self.balance, self.law, self.sign)
        return max((v if v == v else np.inf) for v in every)


@dataclass(frozen=True, slots=True, eq=False)
class ContactAnswer(Comparable):
    """Answer of a contact problem, in the problem's own units.

    Attributes
    ----------
    problem : ContactProblem
    place : mapping of coordinate to float
    force : mapping of row or arc to float
        ≥ 0.
    pull : mapping of radial element to ndarray, shape (2,)
        Force along its offset.
    undetermined : frozenset of str
        Coordinates that the forces leave open; `place` has one of many possible values.
    residuals : Residuals
        Computed from the problem and the figures above, not by any solver.
    """

    problem: ContactProblem
    place: Mapping[str, float]
    force: Mapping[str, float]
    pull: Mapping[str, Array]
    undetermined: frozenset[str]
    residuals: Residuals

    @property
    def passed(self) -> bool:
        """Whether it is an equilibrium to `CONTACT.tolerance`."""
        return self.residuals.worst <= CONTACT.tolerance


@one_thread()
def solve_contact(
    problem: ContactProblem, *, solver: str = "clarabel", method: str = "newton"
) -> ContactAnswer:
    """Solve a contact problem and judge the answer.

    Parameters
    ----------
    problem : ContactProblem
    solver : {"clarabel", "osqp", "cvxpy"}
        Back-end that identifies the active set, which is then solved exactly.
    method : {"newton", "picard", "power"}
        How nonlinear laws are treated.

    Returns
    -------
    ContactAnswer
        With `passed` true.

    Raises
    ------
    TypeError
        If it is no contact problem.
    ValueError
        If the arrays do not fit together; the message names them.
    Refused
        If no equilibrium was found.
    """
    check_problem(problem)
    options = Options(solver=solver, method=method)
    plan, last = Plan.full(problem), "nothing was tried"
    for way in dict.fromkeys((method, "newton", "picard")):
        try:
            settled = settle(problem, plan, backend(solver), replace(options, method=way), way)
        except Unsolved as failure:
            last = str(failure)
            continue
        answer = _answer(problem, settled)
        nowhere = _nowhere(problem, answer.place)
        if answer.passed and not nowhere:
            return answer
        last = f"residual {answer.residuals.worst:.2g} of 1e-9 allowed"
        if nowhere:
            last = f"under the load {', '.join(nowhere)} would come to rest only at infinity"
    against = conflict(problem)
    if against:
        raise Refused(f"rigid limits contradict one another: {', '.join(against)}")
    moved = runaway(problem)
    if moved:
        last = f"the load moves {', '.join(moved)} without end, and too little resists it"
    raise Refused(f"no equilibrium of the contact problem was found: {last}")


def residuals(
    problem: ContactProblem, x: Array, force: Mapping[str, float], pull: Mapping[str, Array]
) -> Residuals:
    """Judge a claimed answer of a contact problem from its arrays alone.

    Parameters
    ----------
    problem : ContactProblem
    x : ndarray, shape (n,)
    force : mapping of row or arc to float
    pull : mapping of radial element to ndarray, shape (2,)
        Force along its offset.

    Raises
    ------
    TypeError
        If it is no contact problem, or force and pull are no mappings.
    ValueError
        If the arrays do not fit together; the message names them.
    """
    check_problem(problem)
    _check_claim(problem, x, force, pull)
    forces = {name: float(floats(value)) for name, value in force.items()}
    pulls = {name: floats(value) for name, value in pull.items()}
    return _residuals(problem, floats(x), forces, pulls)


def _check_claim(problem: ContactProblem, x: Any, force: Any, pull: Any) -> None:
    check_mapping("forces by name", "{'stop': 100.0}", force)
    check_mapping("forces by name", "{'drum': [300.0, 400.0]}", pull)
    radials = [r.name for r in problem.radials]
    wrong = [f"{name}: no row or arc has this name" for name in force if name not in problem.laws]
    wrong += [f"{name}: no radial element has this name" for name in pull if name not in radials]
    parts: list[tuple[str, Any, tuple[int, ...]]] = [("x", x, (problem.size,))]
    parts += [(f"force of {name}", value, ()) for name, value in force.items()]
    parts += [(f"pull of {name}", value, (2,)) for name, value in pull.items()]
    for what, value, shape in parts:
        array = floats(value)
        if not isinstance(array, np.ndarray) or array.shape != shape:
            wrong.append(f"{what}: {value!r} is no array of numbers of shape {shape}")
    if wrong:
        raise ValueError("\n".join(wrong))


def _residuals(
    problem: ContactProblem, x: Array, force: Mapping[str, float], pull: Mapping[str, Array]
) -> Residuals:
    """Judge a claim whose arrays fit the problem."""
    rows = problem.rows_at(x)
    forces = np.array([force.get(r.name, 0.0) for r in rows])
    pushed = [row.vector * f for row, f in zip(rows, forces, strict=True)]
    pulls = {r.name: np.asarray(pull.get(r.name, np.zeros(2))) for r in problem.radials}
    pushed += [r.matrix.T @ pulls[r.name] for r in problem.radials]
    left = problem.stiffness @ x - problem.load + sum(pushed, np.zeros(problem.size))
    laws = {r.name: r.law(r.torque(force), x) for r in problem.radials}
    unit = float(_force_scale(problem, x, force, laws))
    length = problem.length_unit()
    approach = [float(row.vector @ x) - row.gap for row in rows]
    off = [
        d - row.law.compression(f) if f > 0.0 else max(d, 0.0)
        for row, d, f in zip(rows, approach, forces.tolist(), strict=True)
    ]
    graphs = [
        _off_graph(r.offset(x), pulls[r.name], laws[r.name], unit, length) for r in problem.radials
    ]
    return Residuals(
        balance=float(np.abs(left).max(initial=0.0)) / unit,
        law=float(max([np.abs(off).max(initial=0.0) / length, *graphs])),
        sign=float(-forces.min(initial=0.0)) / unit,
    )


def _force_scale(
    problem: ContactProblem, x: Array, force: Mapping[str, float], laws: Mapping[str, RadialLaw]
) -> float:
    """Return the force that a claim is measured by: the largest load or visible elastic force.

    A force that no displacement confirms does not count: reactions of rigid limits could be
    arbitrarily large and would hide an imbalance. So could forces of elements that hardly yield,
    within the lengths by which a claim may be off.
    """
    yields = CONTACT.yields * problem.length_unit()
    rounding = problem.size * np.finfo(float).eps * np.abs(x)
    springs = np.abs(problem.stiffness @ x) - np.abs(problem.stiffness) @ (yields + rounding)
    scales = [*np.abs(problem.load).tolist(), *springs.tolist()]
    scales += [_shown(row, force.get(row.name, 0.0), x, yields) for row in problem.rows_at(x)]
    scales += [laws[r.name].least(r.radius(x) - yields) for r in problem.radials]
    return max(scales) or problem.force_unit()


def _shown(row: Row, force: float, x: Array, yields: float) -> float:
    """Return the least force of a contact on which claim and place agree, up to a length."""
    if not force > 0.0:
        return 0.0
    compressed = min(row.law.compression(force), float(row.vector @ x) - row.gap) - yields
    return row.law.force(compressed) if compressed > 0.0 else 0.0


def _off_graph(offset: Array, pull: Array, law: RadialLaw, unit: float, length: float) -> float:
    """Return a radial element's distance from its graph, in forces and lengths of the problem.

    Its force points along the offset; at the centre it may have any direction.
    """
    radius, size = float(np.linalg.norm(offset)), float(np.linalg.norm(pull))
    across = float(np.linalg.norm(pull - size * offset / radius)) if radius > 0.0 else 0.0
    apart = ((*part.off(radius, size), across if part.end > 0.0 else 0.0) for part in law.parts())
    return min(max(abs(r) / length, abs(f) / unit, a / unit) for r, f, a in apart)


def _nowhere(problem: ContactProblem, place: Mapping[str, float]) -> list[str]:
    """Return coordinates so large that their last digit exceeds the problem's unit of length.

    If the load is exactly the friction along a move that nothing else resists, forces balance ever
    better the farther a body moves, but never exactly.
    """
    far = problem.length_unit() / np.finfo(float).eps
    return [name for name, value in place.items() if abs(value) > far]


def _answer(problem: ContactProblem, settled: Settled) -> ContactAnswer:
    """Turn the outcome of the outer loop into an answer and judge it."""
    force = {r.name: max(settled.forces.get(r.name, 0.0), 0.0) for r in problem.rows_at(settled.x)}
    pull = settled.pulls(problem)
    place = dict(zip(problem.coordinates, settled.x.tolist(), strict=True))
    loose = left_open(problem, settled.x, force, pull)
    found = _residuals(problem, settled.x, force, pull)
    for array in pull.values():
        array.flags.writeable = False
    return ContactAnswer(problem, Table(place), Table(force), Table(pull), loose, found)
