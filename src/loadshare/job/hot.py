"""The first rung of the ladder: positions of a case on the hot path, all of them at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from loadshare.certify import Certificate
from loadshare.certify.bound import Bound, bound_of
from loadshare.certify.certificate import certify_later
from loadshare.contact.plan import Plan, Role
from loadshare.job.answer import Answer
from loadshare.job.engines import engine_at_hand
from loadshare.job.least import least_places
from loadshare.job.machine import Answers, Machine
from loadshare.settings import JOB
from loadshare.solver import Record
from loadshare.solver.position import coordinates_of
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import Situations
from loadshare.train.train import Train

HOT, SEARCHED = "hot path", "proximal search"


def hot_answers(
    machine: Machine,
    indices: Sequence[int],
    tolerance: float,
    engine: str = "auto",
) -> dict[int, Answer]:
    """Answer what the hot path can, by position."""
    situations = machine.situations(indices)
    found = machine.answer(situations, tolerance, engine_at_hand(engine, len(indices)))
    deflection = found.verdicts.deflection
    moved = machine.measuring.worst(situations, found.equilibria, deflection, refusal=True)
    small = (moved < JOB.small).tolist()
    flanks, forces = found.equilibria.names.flanks, found.equilibria.flank_force
    answers = {}
    for row in np.flatnonzero(found.passed).tolist():
        index = indices[row]
        answers[index] = Answer(
            machine.train,
            index,
            SEARCHED if found.searched[row] else HOT,
            dict(zip(flanks, forces[row].tolist(), strict=True)),
            partial(_placed, machine, situations, found, row, index, tolerance),
            partial(_record, machine, found, row),
            small[row],
        )
    return answers


def _placed(
    machine: Machine,
    situations: Situations,
    found: Answers,
    row: int,
    index: int,
    tolerance: float,
) -> tuple[Equilibrium, Certificate]:
    """Return an answer at its place of least norm, and its certificate."""
    train, first = machine.train, found.equilibria.one(row, index)
    equilibrium = first
    if not found.determined[row]:
        equilibrium = least_places(machine, situations, found, [row], tolerance)[row]
    claimed = found.equilibria.part(slice(row, row + 1))
    torques = float(found.verdicts.bounds.relative[row])
    prove = partial(_bound, train, equilibrium, first)
    return equilibrium, certify_later(train, equilibrium, claimed, tolerance, torques, prove)


def _bound(train: Train, equilibrium: Equilibrium, first: Equilibrium) -> Bound:
    """Bound an answer; where nothing is proved at its least place, where it was found first.

    The forces, and so the bounds on torques, are the same.
    """
    bound = bound_of(train, equilibrium)
    return bound_of(train, first) if math.isinf(bound.relative) else bound


def _record(machine: Machine, found: Answers, row: int) -> Record:
    """How the hot path answered."""
    structure, states = machine.structure, found.states[row]
    basis = structure.basis(states)
    acting = states[: structure.rows] != 0
    rows = {
        name: Role.IN_PLAY if acts else Role.OPEN
        for name, acts in zip(structure.row_names, acting, strict=True)
    }
    radials = {
        r.name: Role.IN_PLAY if place else Role.OPEN
        for r, place in zip(structure.radials, states[structure.rows :], strict=True)
    }
    redundants = basis.redundant.shape[1]
    return Record(
        solver=HOT,
        method="force",
        kind=f"force method, {redundants} redundant{'' if redundants == 1 else 's'}",
        iterations=(),
        plan=Plan(rows, radials),
        rounds=int(found.turns[row]),
        removed=structure.removed,
        coordinates=structure.coordinates.names,
    )


def left_out(answer: Answer) -> tuple[tuple[str, str], ...]:
    """What did not act in an answer of the hot path, and the figure that says so."""
    scene, found = answer.scene, answer.equilibrium
    plan = answer.record.plan
    x = coordinates_of(scene, found)
    idle = [
        (row.name, f"open by {(row.gap - float(row.vector @ x)) * 1e6:.4g} µm")
        for row in scene.rows_at(x)
        if plan.rows[row.name] is Role.OPEN
    ]
    idle += [
        (r.name, f"moves freely, {float(np.linalg.norm(r.matrix @ x - r.centre)) * 1e6:.4g} µm out")
        for r in scene.radials
        if plan.radials[r.name] is Role.OPEN
    ]
    return scene.removed + tuple(idle)
