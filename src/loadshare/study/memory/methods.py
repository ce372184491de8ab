"""Methods for a certified step with memory.

The first holds the slips of some splines fixed. A spline whose slip is at the end of its clearance
and does not change is held by friction and by the stop at once. How they share the force is then
undetermined, and an active set with both is singular. The slip is therefore taken out of the
programme, the force that holds it is found, and this force is split so that the stop takes no more
than friction leaves. The others are for friction with fixed bounds, where programmes with and
without held slips fail.
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
from loadshare.contact.outer import Settled
from loadshare.contact.plan import Plan
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.hot import SEARCHED
from loadshare.scene import assemble
from loadshare.scene.assemble import scene_of
from loadshare.scene.loading import loading_of
from loadshare.scene.scene import Scene
from loadshare.scene.structure import structure_of
from loadshare.settings import CERTIFY, MARCH
from loadshare.solver import Options, Record, solve_scene
from loadshare.solver.hot.proximal import search
from loadshare.solver.position import SceneResults, equilibrium_of, with_ranges
from loadshare.study.positions import BACKEND, certified
from loadshare.train.elements import Spline
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.memory import SlipStop, slip_of
from loadshare.train.situations import situation_of
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


# --- Fallbacks ------------------------------------------------------------------------------------


def searched(train: Train, index: int) -> Answer | None:
    """Return a certified answer by the proximal search, if there is one.

    It handles only friction with fixed bounds, as elements of their own beside the bending shaft.
    """
    structure, situation = structure_of(train), situation_of(train, index)
    scene, loading = scene_of(structure, situation), loading_of(structure, situation)
    iterate, found = search(structure, loading)
    if not found.solved[0]:
        return None
    x = iterate.x[0] * structure.length
    try:
        laws = {r.name: r.law(0.0, x) for r in scene.radials}
    except ValueError:
        # A spline has no law with memory; the general programme reports why.
        return None
    force, row = iterate.force[0] * structure.force, structure.springs
    forces = dict(zip(structure.row_names, force[row:].tolist(), strict=False))
    columns = {r.name: structure.radial_column(j) for j, r in enumerate(scene.radials)}
    pulls = {name: force[k : k + 2] for name, k in columns.items()}
    settled = Settled(x, forces, pulls, laws, kind="force method", iterations=())
    plan, turns = Plan.full(scene), int(found.turns[0])
    about = scene.removed, scene.coordinates
    record = Record(SEARCHED, "force", settled.kind, (), plan, turns, *about)
    return if_certified(train, equilibrium_of(scene, settled), record, SEARCHED)


def negligible_friction(train: Train, index: int) -> Answer | None:
    """Return a certified answer for negligible friction, if there is one.

    The step is solved without friction, which is then added against the change of each slip.
    """
    load = assemble(train, index).force_unit()
    bounds = [s.bound(0.0) for s in train.splines.values()]
    if not all(0.0 < b <= MARCH.negligible * load for b in bounds):
        return None
    free = {
        g: replace(s, friction_force=0.0, clearance=SlipStop(s).law(0.0).reach, stick_limit=None)
        for g, s in train.splines.items()
    }
    try:
        answer = certified(replace(train, splines=free), index)
    except Refused:
        return None
    found, reactions = answer.equilibrium, {}
    for gear, spline in train.splines.items():
        stop = found.radial_reaction[spline.stop_name]
        way = slip_of(free[gear], found) - slips_before(train)[gear]
        far = float(np.linalg.norm(way)) or 1.0
        friction = -spline.bound(0.0) / far * way
        pushes = float(np.linalg.norm(stop)) > spline.bound(0.0)
        reactions[spline.stop_name] = stop - friction if pushes else np.zeros(3)
        reactions[spline.name] = friction
    equilibrium = replace(found, radial_reaction={**found.radial_reaction, **reactions})
    return if_certified(train, equilibrium, answer.record, f"{answer.rung}, friction added")


def alternating(train: Train, index: int) -> Answer | None:
    """Return a certified answer by solving for displacements and slips in turn, if that converges.

    Each turn lowers a convex energy. Convergence is fast where the slips have little room, which is
    where active sets fail: the slip turns about a centre that is nearer than one step.
    """
    gears, slips = tuple(train.splines), dict(slips_before(train))
    for _ in range(MARCH.turns):
        scene = without_slips(assemble(train, index), gears, slips)
        try:
            found, record = solve_scene(scene, BACKEND)
        except Refused:
            return None
        other = {
            g: _slip_at(s, found.displacement[g], slips_before(train)[g])
            for g, s in train.splines.items()
        }
        change = max(float(np.linalg.norm(other[g] - slips[g])) for g in gears)
        far = max(float(np.linalg.norm(found.displacement[g])) for g in gears)
        if change <= MARCH.round_off * far:
            return if_certified(
                train, split_force(train, found, gears, slips), record, "slips in turn"
            )
        slips = other
    return None


def _slip_at(spline: Spline, place: Vector, before: Vector) -> Vector:
    """Return the s within its room that minimises ½ K_w |p − s|² + F_m |s − s₀|, given p and s₀."""
    stiffness, bound = spline.bending_stiffness, spline.bound(0.0)
    room = SlipStop(spline).law(0.0).reach
    force = stiffness * (place - before)
    size = float(np.linalg.norm(force))
    free = before + max(1.0 - bound / size, 0.0) * (place - before) if size > 0.0 else before
    if float(np.linalg.norm(free)) <= room or room == 0.0:
        return free if room > 0.0 else np.zeros(3)
    start = np.asarray(before)
    if float(np.linalg.norm(start)) >= room * (1.0 - MARCH.at_end):
        left = force - least_stop_force(force, start, bound)
        if float(np.linalg.norm(left)) <= bound * (1.0 + MARCH.round_off):
            return start
    # The slip is on the edge of its room, at an angle between those of s₀ and of p.
    out = place / float(np.linalg.norm(place))
    across = start - (start @ out) * out
    width = float(np.linalg.norm(across))
    if width == 0.0:
        return np.asarray(room * out)
    across /= width
    low, high = 0.0, float(np.arctan2(start @ across, start @ out))
    for _ in range(MARCH.halvings):
        angle = 0.5 * (low + high)
        slip = room * (np.cos(angle) * out + np.sin(angle) * across)
        along = np.cos(angle) * across - np.sin(angle) * out
        way = float(np.linalg.norm(slip - start))
        pull = bound / way * (slip - start) if way > 0.0 else np.zeros(3)
        if float((pull - stiffness * (place - slip)) @ along) > 0.0:
            high = angle
        else:
            low = angle
    return np.asarray(slip)
