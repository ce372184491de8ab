"""The ladder: what is tried, in order, until an answer is certified.

The hot path comes first. What it does not solve, or what its certificate refuses, goes to a
back-end with an exact pass on the identified active set, then to the other forms of the loop, down
to the exact power-cone programme; then it is refused with figures.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from loadshare.certify import Certificate, certify
from loadshare.certify.bound import Bound, bound_of
from loadshare.certify.certificate import certify_later
from loadshare.certify.validity import TOLD, Validity, refusal_told, validity
from loadshare.contact.findings import Work
from loadshare.contact.plan import Plan, Role
from loadshare.errors import Refused
from loadshare.job.least import least_places
from loadshare.job.machine import Answers, Machine, engine_at_hand
from loadshare.scene import assemble
from loadshare.scene.assemble import scene_of
from loadshare.scene.elements import elements_of
from loadshare.scene.scene import Scene
from loadshare.settings import JOB, PLACES
from loadshare.solver import Iteration, Options, Record, solve_scene
from loadshare.solver.balance import is_unbalanced
from loadshare.solver.contradiction import contradiction
from loadshare.solver.position import Known, coordinates_of
from loadshare.solver.runaway import runaway
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of
from loadshare.train.train import Train

HOT, SEARCHED = "hot path", "proximal search"
LIGHTER = (0.5, 0.1)
"""Shares of the load that are looked at where arcs may have lost their hold under all of it."""
AUTO = "auto"
"""Instead of a back-end's name: the hot path, and Clarabel for what it leaves."""


@dataclass(frozen=True, eq=False)
class Answer:
    """A certified equilibrium, and how it was found.

    Attributes
    ----------
    train : Train
    equilibrium : Equilibrium
    certificate : Certificate
    record : Record
        Plan, passes of the outer loop, and what was left out.
    rung : str
        Rung of the ladder that answered.
    claimed : Equilibria or None
        The equilibrium as the only sample, where that is at hand.
    """

    train: Train
    equilibrium: Equilibrium
    certificate: Certificate
    record: Record
    rung: str
    claimed: Equilibria | None = None

    @property
    def scene(self) -> Scene:
        """The contact problem, assembled anew."""
        return assemble(self.train, self.equilibrium.index)

    @cached_property
    def validity(self) -> Validity:
        """Whether its displacements are small enough for the geometry in which it was found."""
        deflection = self.certificate.deflection
        return validity(self.train, self.equilibrium, deflection, self.claimed)


def rungs(options: Options) -> Iterator[tuple[str, Options]]:
    """Yield what was asked for, then the whole scene, then the other forms of the loop."""
    yield f"{options.solver} + exact", options
    if options.reduce:
        yield "whole scene", replace(options, reduce=False)
    for method in ("newton", "picard", "power"):
        if method != options.method:
            yield f"whole scene, {method}", replace(options, reduce=False, method=method)


def climb_all(
    machine: Machine,
    indices: Sequence[int],
    options: Options,
    tolerance: float,
    engine: str | None = "auto",
) -> Iterator[Answer | Refused]:
    """Answer positions, all of them on the hot path first.

    Parameters
    ----------
    machine : Machine
    indices : sequence of int
        1-based positions.
    options : Options
        For what the hot path leaves.
    tolerance : float
    engine : str or None
        Of the hot path, by name (`engine_at_hand`); None leaves it out.

    Yields
    ------
    Answer or Refused
        In the order of the positions; a refusal where no rung gives a certified answer.
    """
    quick: dict[int, Answer] = {}
    steps = math.inf
    if engine is not None and machine.train.slip is None:
        quick, steps = hot_answers(machine, indices, tolerance, engine), JOB.steps
    for index in indices:
        if index in quick:
            yield quick[index]
            continue
        try:
            yield climb(machine.train, index, options, tolerance, steps)
        except Refused as refusal:
            yield refusal


def hot_answers(
    machine: Machine,
    indices: Sequence[int],
    tolerance: float,
    engine: str = "auto",
) -> dict[int, Answer]:
    """Answer what the hot path can, by position."""
    train = machine.train
    situations = machine.situations(indices)
    found = machine.answer(situations, tolerance, engine_at_hand(engine, len(indices)))
    answers = {}
    loose = np.flatnonzero(found.passed & ~found.determined).tolist()
    least, proved = least_places(machine, situations, found, loose, tolerance)
    for row in np.flatnonzero(found.passed).tolist():
        index = indices[row]
        equilibrium = least.get(row) or found.equilibria.one(row, index)
        before = found.verdicts.bounds
        bounds, at = proved.get(row, (before, row))
        every = bounds.force is not None
        bound = Bound.of(bounds, at) if every else bound_of(train, equilibrium)
        if before.force is not None and math.isinf(bound.relative):
            # The forces, and so the bound on torques, are those of the answer before it was moved.
            bound = Bound.of(before, row)
        claimed = found.equilibria.part(slice(row, row + 1))
        certificate = certify_later(train, equilibrium, claimed, tolerance, bound)
        record = _hot_record(machine, found, row)
        rung = SEARCHED if found.searched[row] else HOT
        answers[index] = Answer(train, equilibrium, certificate, record, rung, claimed)
    return answers


def _hot_record(machine: Machine, found: Answers, row: int) -> Record:
    """How the hot path answered."""
    elements, code = machine.elements, found.code[row]
    basis = elements.basis(code)
    acting = code[: elements.rows] != 0
    rows = {
        name: Role.IN_PLAY if acts else Role.OPEN
        for name, acts in zip(elements.row_names, acting, strict=True)
    }
    radials = {
        r.name: Role.IN_PLAY if place else Role.OPEN
        for r, place in zip(elements.radials, code[elements.rows :], strict=True)
    }
    redundants = basis.redundant.shape[1]
    return Record(
        solver=HOT,
        method="force",
        kind=f"force method, {redundants} redundant{'' if redundants == 1 else 's'}",
        iterations=(),
        plan=Plan(rows, radials),
        rounds=int(found.turns[row]),
        removed=elements.removed,
        coordinates=elements.coordinates.names,
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


def climb(
    train: Train, index: int, options: Options, tolerance: float, steps: float = math.inf
) -> Answer:
    """Answer position `index`, climbing until the certificate passes.

    Parameters
    ----------
    train : Train
    index : int
        1-based.
    options : Options
        Of the first rung.
    tolerance : float
    steps : float
        Newton steps of exact solves in all; as many as it takes by default.

    Raises
    ------
    Refused
        If no rung gives a certified answer; the message says what failed at the first rung and
        carries its figures.
    """
    elements = elements_of(train)
    scene = scene_of(elements, situation_of(train, index))
    _refuse_if_contradicted(scene, JOB.plainly)
    if is_unbalanced(elements, scene.load):
        _refuse_if_driven(scene)
    first: Refused | None = None
    known = Known(work=Work(steps))
    seen: list[tuple[Iteration, ...]] = []
    for rung, rung_options in rungs(options):
        try:
            equilibrium, record = solve_scene(scene, rung_options, known)
        except Refused as refusal:
            if first is None:
                first = refusal
                _refuse_if_driven(scene)
            continue
        if any(record.iterations is others for others in seen):
            # The same answer once more.
            continue
        seen.append(record.iterations)
        certificate = certify(train, equilibrium, tolerance)
        if certificate.passed:
            return Answer(train, equilibrium, certificate, record, rung)
        first = first or uncertified(index, certificate)
        if not options.polish:
            break
    _refuse_if_contradicted(scene)
    _refuse_if_driven(scene)
    raise _far_before(
        train, index, tolerance, first or Refused(f"position {index}: nothing was tried")
    )


def _refuse_if_contradicted(scene: Scene, overlap: float = PLACES.overlap) -> None:
    """Refuse a position whose rigid limits are shown to leave no place, and name them."""
    against = contradiction(scene, overlap)
    if against:
        raise Refused(
            f"position {scene.position}: rigid limits contradict one another: "
            f"{', '.join(against)}; give one of them more clearance or float, or a stiffness"
        )


def _refuse_if_driven(scene: Scene) -> None:
    """Refuse a position whose load is shown to move something without end, and name what."""
    moves = runaway(scene)
    if moves:
        floats = [g for g in scene.displacement if {f"gear {g} x", f"gear {g} y"} & {*moves}]
        also = f"; nothing limits the float of gear {', '.join(floats)}" if floats else ""
        raise Refused(
            f"position {scene.position}: nothing balances the load on {moves[0]}: no contact, "
            f"support or limit holds it{also}"
        )


def _far_before(train: Train, index: int, tolerance: float, refusal: Refused) -> Refused:
    """Add to a refusal what a part of the load displaces too far for the geometry already.

    Only arcs can lose their hold on a gear that rolls along them: without, the problem is convex.
    """
    for share in LIGHTER if train.drums and train.slip is None else ():
        torque = tuple(share * t for t in train.input_torque)
        external = {g: share * t for g, t in train.external.items()}
        lighter = Machine(replace(train, input_torque=torque, external=external))
        for answer in hot_answers(lighter, [index], tolerance).values():
            told = "; ".join(
                f"{TOLD[name]} {m.value:.3g} at {m.where} (told of above {m.warning:.3g})"
                for name, m in answer.validity.warned.items()
            )
            if told:
                return Refused(
                    f"{refusal}; under {share:.0%} of the load displacements are large for the "
                    f"geometry already: {told}; check the load and the stiffnesses",
                    refusal.figures,
                )
    return refusal


def displaced(answer: Answer) -> Refused | None:
    """Return why an answer is refused for its displacements; None if it is not."""
    beyond = answer.validity.refused
    if not beyond:
        return None
    told = f"position {answer.equilibrium.index}: {refusal_told(beyond)}"
    return Refused(told, {name: m.value for name, m in beyond.items()})


def uncertified(index: int, certificate: Certificate) -> Refused:
    """Return the refusal of an answer whose certificate does not pass."""
    failing = certificate.failing
    told = "; ".join(
        f"{name.replace('_', ' ')} {r.value:.3g} {r.unit} at {r.where} "
        f"({r.scaled:.1e} of the case, allowed {certificate.tolerance:.0e})"
        for name, r in failing.items()
    )
    figures = {name: r.scaled for name, r in failing.items()}
    if failing:
        return Refused(f"position {index}: the answer is not an equilibrium: {told}", figures)
    error, allowed = certificate.bound.relative, certificate.tolerance
    proved = "not proved at all" if math.isinf(error) else f"proved to {error:.1e} only"
    return Refused(
        f"position {index}: forces and laws are in balance to {certificate.worst:.1e}, but the "
        f"torques are {proved} (of the largest torque; allowed {allowed:.0e}): parts of very "
        "unlike stiffness share the load, or contacts stand on the verge",
        {"torque_bound": error},
    )
