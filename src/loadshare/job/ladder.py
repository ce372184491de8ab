"""The ladder: the methods that are tried, in order, until an answer is certified.

The fast method comes first. A position that it does not solve, or whose certificate fails, is
refused if a part of the load already displaces gears too far for the geometry. Otherwise it goes to
a back-end with an exact pass on the identified active set, then to the whole scene and the other
forms of the loop, down to the exact power-cone programme. If all of these fail, it is refused with
figures.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from loadshare.certify import Certificate, certify
from loadshare.certify.validity import LABELS, Validity, refusal_text
from loadshare.contact.findings import StepBudget
from loadshare.contact.runaway import runaway
from loadshare.errors import Refused
from loadshare.job.answer import Answer, refusal_of
from loadshare.job.hot import hot_answers
from loadshare.job.machine import Machine
from loadshare.one_thread import one_thread
from loadshare.scene.assemble import assemble, scene_of
from loadshare.scene.scene import Scene
from loadshare.scene.structure import structure_of
from loadshare.settings import CERTIFY, JOB, PLACES
from loadshare.solver import Iteration, Options, solve_scene
from loadshare.solver.balance import is_unbalanced
from loadshare.solver.balancing import balancing
from loadshare.solver.contradiction import contradiction
from loadshare.solver.position import SceneResults
from loadshare.train.mesh import approach_of
from loadshare.train.placed import train_at
from loadshare.train.situations import situation_of
from loadshare.train.train import Train

_NAMED = 5
"""How many gears of a free motion are named."""
AUTO = "auto"
"""Instead of a back-end's name: the fast method, and Clarabel for positions that it leaves."""


class _Part(NamedTuple):
    """A share of the load, and how far it displaces a train."""

    share: float
    displaced: Validity


def rungs(options: Options) -> Iterator[tuple[str, Options]]:
    """Yield the requested rung, then the whole scene, then the other forms of the loop."""
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
    """Answer positions, all of them by the fast method first.

    Parameters
    ----------
    machine : Machine
    indices : sequence of int
        1-based positions.
    options : Options
        Options for positions that the fast method leaves.
    tolerance : float
    engine : str or None
        Engine of the fast method, by name (`available_engine`); None leaves the fast method out.

    Yields
    ------
    Answer or Refused
        In the order of the positions; a refusal if no rung gives a certified answer.
    """
    if machine.train.is_placed_anew:
        for index in indices:
            yield from climb_all(machine.at(index), [index], options, tolerance, engine)
        return
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


@one_thread()
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
        Options of the first rung.
    tolerance : float
    steps : float
        Newton steps of exact solves in all; unlimited by default.

    Raises
    ------
    Refused
        If no rung gives a certified answer; the message says what failed at the first rung and
        carries its figures.
    """
    train = train_at(train, index)
    structure = structure_of(train)
    scene = scene_of(structure, situation_of(train, index))
    _refuse_if_contradicted(scene, JOB.plainly)
    if is_unbalanced(structure, scene.load, tolerance):
        _refuse_if_driven(scene)
    lighter = cache(partial(_under_less, train, index, tolerance))
    if math.isfinite(steps):
        _refuse_if_too_large(index, lighter())
    first: Refused | None = None
    known = SceneResults(work=StepBudget(steps))
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
            # The same answer as that of an earlier rung.
            continue
        seen.append(record.iterations)
        certificate = certify(train, equilibrium, tolerance)
        if certificate.passed:
            return Answer.of(train, equilibrium, certificate, record, rung)
        first = first or uncertified(index, certificate)
        if not options.polish:
            break
    _refuse_if_contradicted(scene)
    _refuse_if_driven(scene)
    raise _with_large(first or Refused(f"position {index}: nothing was tried"), lighter())


def _refuse_if_contradicted(scene: Scene, overlap: float = PLACES.overlap) -> None:
    """Refuse a position whose rigid limits provably contradict one another, and name them."""
    against = contradiction(scene, overlap)
    if against:
        raise Refused(
            f"position {scene.position}: rigid limits contradict one another: "
            f"{', '.join(against)}; give one of them more clearance or float, or a stiffness"
        )


def _refuse_if_driven(scene: Scene) -> None:
    """Refuse a position whose load provably moves something without end, and name it."""
    moves = runaway(scene)
    if moves:
        first = next(iter(moves))
        floats = [g for g in scene.displacement if {f"gear {g} x", f"gear {g} y"} & {*moves}]
        also = f"; nothing limits the float of gear {', '.join(floats)}" if floats else ""
        turning = [g for g in scene.rotation if f"gear {g} rotation" in moves]
        if len(turning) == len(moves) > 1:
            named = f"{', '.join(turning[:_NAMED])}{', …' if len(turning) > _NAMED else ''}"
            hint = _balancing_torque(scene, moves) or _balancing_with_backlash(scene)
            hint = hint or _still_output(scene) or "hold one (held = true) or give it a torque"
            also = f"; gears {named} turn together: {hint}"
        closing = _other_flanks(scene, moves)
        if closing and not runaway(_with_backlash(scene, closing)):
            named = f"{', '.join(closing[:_NAMED])}{', …' if len(closing) > _NAMED else ''}"
            one = f"mesh {named} a backlash: its other flank"
            more = f"meshes {named} a backlash: their other flanks"
            also += f"; give {more if closing[1:] else one} could stop it"
        raise Refused(
            f"position {scene.position}: nothing balances the load on {first}: no contact, "
            f"support or limit holds it{also}"
        )


def _other_flanks(scene: Scene, moves: Mapping[str, float]) -> list[str]:
    """Return the meshes with one flank only whose other flank a move would close."""
    train = train_at(scene.train, scene.position)
    move = np.array([moves.get(name, 0.0) for name in scene.coordinates])
    found = []
    for name, mesh in train.meshes.items():
        if len(mesh.flanks) > 1:
            continue
        approach = approach_of(mesh, False, train.gears)
        parts = [float(push @ scene.moved(g, move)) for g, push in approach.shifting.items()]
        for gear, lever in approach.turning.items():
            turning = scene.rotation[gear]
            if turning.index is not None:
                parts.append(lever * turning.rate * float(move[turning.index]))
        if math.fsum(parts) > PLACES.named * max(map(abs, parts), default=0.0):
            found.append(name)
    return found


def _balancing_torque(scene: Scene, moves: Mapping[str, float]) -> str:
    """Say which value a given torque on a turning gear would need for balance, if one is given."""
    for name in scene.train.external:
        if name == scene.train.input or f"gear {name} rotation" not in moves:
            continue
        needed = balancing(scene, moves, name)
        if needed is not None:
            sign = -1.0 if scene.train.gears[name].ratio < 0.0 else 1.0
            return (
                f"their torques do not cancel, as they would with operating.external.{name} = "
                f'"{sign * needed:.15g} N*m"'
            )
    return ""


def _balancing_with_backlash(scene: Scene) -> str:
    """Say the same with both flanks: a torque of the wrong sense presses the wrong flanks."""
    both = _with_backlash(scene, scene.train.meshes) if scene.train.external else None
    moves = runaway(both) if both is not None else {}
    return _balancing_torque(both, moves) if both is not None and moves else ""


def _with_backlash(scene: Scene, names: Iterable[str]) -> Scene:
    """Return the scene with both flanks of the meshes named."""
    meshes = dict(scene.train.meshes)
    meshes |= {n: replace(m, backlash=0.0) for n in names if not (m := meshes[n]).flanks[1:]}
    return assemble(replace(scene.train, meshes=meshes), scene.position)


def _still_output(scene: Scene) -> str:
    """Say that the output takes no power, if it stands still while the input turns."""
    train = scene.train
    if train.gears[train.output].ratio:
        return ""
    return (
        f"gear {train.output}, the output, stands still as gear {train.input} turns (a geared "
        "neutral), so no torque on it balances that of the input"
    )


def _under_less(train: Train, index: int, tolerance: float) -> _Part | None:
    """Return a part of the load that has an answer, if arcs may fail to hold all of it.

    A gear may roll along arcs until nothing holds it; without arcs the problem is convex.
    """
    for share in JOB.lighter if train.drums and train.slip is None else ():
        torque = tuple(share * t for t in train.input_torque)
        external = {g: share * t for g, t in train.external.items()}
        forces = {g: share * f for g, f in train.forces.items()}
        lighter = Machine(replace(train, input_torque=torque, external=external, forces=forces))
        for answer in hot_answers(lighter, [index], tolerance).values():
            return _Part(share, answer.validity)
    return None


def _refuse_if_too_large(index: int, part: _Part | None) -> None:
    """Refuse a position that is displaced too far for its geometry under a part of its load."""
    if part is not None and part.displaced.refused:
        text = refusal_text(part.displaced.refused)
        raise Refused(f"position {index}: under {part.share:.0%} of the load, {text}")


def _with_large(refusal: Refused, part: _Part | None) -> Refused:
    """Add to a refusal the displacements that are large already under a part of the load."""
    # Displacements that are never refused, however large, are no reason for a refusal.
    large = {} if part is None else part.displaced.warned
    large = {name: m for name, m in large.items() if m.refusal is not None}
    if part is None or not large:
        return refusal
    text = "; ".join(
        f"{LABELS[name]} {m.value:.3g} at {m.where} (warning above {m.warning:.3g})"
        for name, m in large.items()
    )
    return Refused(
        f"{refusal}; under {part.share:.0%} of the load, displacements are already large for the "
        f"geometry: {text}; check the load and the stiffnesses",
        refusal.figures,
    )


def uncertified(index: int, certificate: Certificate) -> Refused:
    """Return the refusal of an answer whose certificate does not pass."""
    far = certificate.claims.validities[certificate.row].refused
    if far and certificate.worst <= CERTIFY.largest:
        # Near an equilibrium; rounding of such displacements may be all that is wrong.
        return refusal_of(index, far)
    figures = {name: r.scaled for name, r in certificate.failing.items()}
    if figures:
        shortfall = f"the answer is not an equilibrium: {certificate.shortfall}"
        return Refused(f"position {index}: {_runs_away(certificate) or shortfall}", figures)
    error, allowed = certificate.proved, certificate.tolerance
    proved = "not proved at all" if math.isinf(error) else f"proved to {error:.1e} only"
    return Refused(
        f"position {index}: forces and laws are in balance to {certificate.worst:.1e}, but the "
        f"torques are {proved} (of the largest torque; allowed {allowed:.0e}): parts of very "
        "different stiffness share the load, or contacts are on the verge",
        {"torque_bound": error},
    )


def _runs_away(certificate: Certificate) -> str:
    """Say that an attempt ran away by more than the largest gear's radius, if gears float."""
    train = certificate.claims.train
    far = max((r.value for r in certificate.failing.values() if r.unit == "m"), default=0.0)
    free = [gear for gear in train.floating if gear not in train.limits]
    if not free or not far > max(gear.base_radius for gear in train.gears.values()):
        return ""
    return (
        f"the floating gears run away: the attempt ends {far:.1e} m off, as happens if the load is "
        "balanced only up to rounding in the geometry; nothing limits the float of gear "
        f"{', '.join(free)}: support one, or define symmetric gears by teeth and copies"
    )
