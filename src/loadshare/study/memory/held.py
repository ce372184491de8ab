"""A certified step with the slips of some splines held fixed.

A spline whose slip is at the end of its clearance and does not change is held by friction and by
the stop at once. How they share the force is then undetermined, and an active set with both is
singular. The slip is therefore taken out of the programme, the force that holds it is found, and
this force is split so that the stop takes no more than friction leaves.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from loadshare.array_types import Array
from loadshare.certify import certify
from loadshare.contact.findings import StepBudget
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.scene import assemble
from loadshare.scene.scene import Scene
from loadshare.settings import CERTIFY, MARCH
from loadshare.solver import Options, Record, solve_scene
from loadshare.solver.position import SceneResults, with_ranges
from loadshare.train.elements import Spline
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.memory import SlipStop
from loadshare.train.train import Train


def with_slips_held(
    train: Train,
    index: int,
    gears: tuple[str, ...],
    tries: Iterable[tuple[str, Options]],
    steps: float = math.inf,
    plans: Sequence[float] = (MARCH.quick_plan, math.inf),
) -> Answer | None:
    """Return a certified answer with the slip of some splines held, if there is one.

    A try has at most `steps` Newton steps in all; each of `plans` is tried as the limit of a plan.
    """
    scene = whole = assemble(train, index)
    if gears:
        scene = without_slips(whole, gears, slips_before(train))
    for (rung, options), few in product(tries, plans):
        known = SceneResults(work=StepBudget(steps), each=few)
        try:
            found, record = solve_scene(scene, options, known)
        except Refused:
            continue
        split = split_force(train, found, gears, slips_before(train))
        answer = if_certified(train, split, record, rung + ", slip held" * bool(gears))
        if answer is not None:
            split = with_ranges(split, whole)
            certificate = certify(train, split, CERTIFY.tolerance)
            return Answer.of(train, split, certificate, answer.record, answer.rung)
    return None


def if_certified(train: Train, found: Equilibrium, record: Record, rung: str) -> Answer | None:
    """Return an equilibrium as an answer if its certificate passes."""
    certificate = certify(train, found, CERTIFY.tolerance)
    return Answer.of(train, found, certificate, record, rung) if certificate.passed else None


def slip_at_end(spline: Spline, slip: Vector) -> bool:
    """Return whether a slip is at the end of its clearance."""
    if spline.friction_force is None:
        # Its room changes with the torque, so friction and stop hardly ever hold it together.
        return False
    room = SlipStop(spline).law(0.0).reach
    return float(np.linalg.norm(slip)) >= room * (1.0 - MARCH.at_end)


def slips_before(train: Train) -> Mapping[str, Vector]:
    """Return the slip of every spline at the previous step [m], by gear."""
    assert train.slip is not None
    return {gear: np.asarray(slip) for gear, slip in train.slip.items()}


def without_slips(scene: Scene, gears: tuple[str, ...], slips: Mapping[str, Vector]) -> Scene:
    """Return the scene with the slips of some splines held at given values."""
    train = scene.train
    gone: dict[int, float] = {}
    held: set[str] = set()
    for gear in gears:
        held |= {train.splines[gear].name, train.splines[gear].stop_name}
        before = train.gears[gear].frame @ slips[gear]
        first = scene.coordinates.index(f"spline {gear} slip x")
        gone |= {first: float(before[0]), first + 1: float(before[1])}
    others = np.array([k for k in range(scene.size) if k not in gone])
    kept = [r for r in scene.radials if r.name not in held]
    lost, values = np.array(list(gone)), np.array(list(gone.values()))

    def cut(array: Array) -> Array:
        return np.asarray(array[..., others])

    return replace(
        scene,
        coordinates=tuple(scene.coordinates[k] for k in others),
        stiffness=scene.stiffness[np.ix_(others, others)],
        load=scene.load[others] - scene.stiffness[np.ix_(others, lost)] @ values,
        springs=cut(scene.springs),
        rows=tuple(replace(r, vector=cut(r.vector)) for r in scene.rows),
        arcs=tuple(replace(a, relative=cut(a.relative)) for a in scene.arcs),
        radials=tuple(replace(r, matrix=cut(r.matrix)) for r in kept),
    )


def split_force(
    train: Train, found: Equilibrium, gears: tuple[str, ...], slips: Mapping[str, Vector]
) -> Equilibrium:
    """Split the force that holds each slip between friction and the stop."""
    reactions = dict(found.radial_reaction)
    for gear in gears:
        spline, before, slip = train.splines[gear], slips_before(train)[gear], slips[gear]
        force = spline.bending_stiffness * (found.displacement[gear] - slip)
        torque = train.transmitted(gear, found.flank_force)
        bound, reach = spline.bound(torque), SlipStop(spline).law(torque).reach
        way = float(np.linalg.norm(slip - before))
        stop = np.zeros(3)
        if way > 0.0:
            stop = force - bound / way * (slip - before)
        elif float(np.linalg.norm(slip)) >= reach * (1.0 - MARCH.at_end):
            stop = least_stop_force(force, slip, bound)
        reactions[spline.name], reactions[spline.stop_name] = stop - force, -stop
    return replace(found, radial_reaction=reactions)


def least_stop_force(force: Vector, outward: Vector, bound: float) -> Vector:
    """Return the least force of the stop that leaves friction no more than its bound."""
    size = float(np.linalg.norm(outward))
    along = outward / size if size > 0.0 else force / (float(np.linalg.norm(force)) or 1.0)
    pushed = float(force @ along)
    sideways = max(float(force @ force) - pushed**2, 0.0)
    return np.asarray(max(pushed - np.sqrt(max(bound**2 - sideways, 0.0)), 0.0) * along)
