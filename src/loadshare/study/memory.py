"""One step with memory, certified: by the general programme, or with slips or bounds held fast.

A spline whose slip stood at the end of its clearance and does not change is held by friction and by
the stop at once. How they share its force is then open, and an active set with both is singular.
There the slip is taken out of the programme, the force that holds it is found, and it is split so
that the stop takes no more than friction leaves. Where friction follows the torque, steps with
given bounds lead to those that belong to the torques. The certificate judges it by the full law.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations, islice, product

import numpy as np

from loadshare.array_types import Array
from loadshare.certify import certify
from loadshare.contact.findings import Work
from loadshare.contact.outer import Settled
from loadshare.contact.plan import Plan
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.hot import SEARCHED
from loadshare.job.ladder import rungs
from loadshare.scene import assemble
from loadshare.scene.assemble import scene_of
from loadshare.scene.loading import loading_of
from loadshare.scene.scene import Scene
from loadshare.scene.structure import structure_of
from loadshare.settings import CERTIFY, MARCH
from loadshare.solver import Options, Record, solve_scene
from loadshare.solver.hot.proximal import search
from loadshare.solver.position import Known, equilibrium_of, with_ranges
from loadshare.study.positions import BACKEND, certified
from loadshare.train.elements import Spline
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.memory import SlipStop, slip_of
from loadshare.train.situations import situation_of
from loadshare.train.train import Train

_ENDLESS = math.inf, math.inf
"""Newton steps in all, and for every plan, where neither has a limit."""


@dataclass(slots=True)
class Ways:
    """What solved the step before, which is tried first at the next.

    Attributes
    ----------
    held : dict of tuple of str to tuple of str
        Gears whose slip was held, by those whose slip stood at an end.
    bounds : dict of gear to float
        Friction [N] that belonged to the torques, where it was found by way of fixed bounds.
    """

    held: dict[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)
    bounds: dict[str, float] = field(default_factory=dict)


def stepped(train: Train, index: int, ways: Ways | None = None) -> Answer:
    """Solve and certify a position of a train whose splines remember their slip.

    Parameters
    ----------
    train : Train
        One that remembers (`Train.remembering`).
    index : int
        1-based.
    ways : Ways, optional
        Of the step before, renewed.

    Raises
    ------
    Refused
        If the position has no certified equilibrium.
    """
    if not train.splines:
        # There is nothing that remembers.
        return certified(replace(train, slip=None), index)
    assert train.slip is not None
    # A slip that stood at the end of its clearance mostly stays there.
    ends = tuple(g for g, s in train.splines.items() if _at_end(s, train.slip[g]))
    follows, ways = any(s.friction_force is None for s in train.splines.values()), ways or Ways()
    # Where friction follows the torque, given bounds lead to those of the torques.
    if ways.bounds and (answer := _followed(train, index, ways)) is not None:
        return answer
    sets = sorted((*_subsets(ends), ()), key=lambda gears: gears != ways.held.get(ends))
    # What a plan does not find soon, a wider one mostly does, or another set.
    limits = ((MARCH.quick, math.inf),) if follows else ((math.inf, MARCH.quick_plan), _ENDLESS)
    for (steps, each), gears in product(limits, sets):
        answer = _held(train, index, gears, islice(rungs(BACKEND), 1), steps, (each,))
        if answer is not None:
            ways.held[ends] = gears
            return answer
    followed = partial(_followed, ways=ways)
    for other in (followed,) if follows else (_all_but_free, _searched, _in_turn):
        answer = other(train, index)
        if answer is not None:
            return answer
    try:
        return certified(train, index)
    except Refused:
        for gears in _subsets([*train.splines]):
            answer = _held(train, index, gears, rungs(BACKEND))
            if answer is not None:
                return answer
        raise


def _followed(train: Train, index: int, ways: Ways) -> Answer | None:
    r"""Return a certified answer where friction follows the torque, by way of fixed bounds.

    With bounds F that are given the step is convex and its torques T are unique, so they depend on
    F continuously. They do not grow with it either: what sticks does not ask for the bound. So
    :math:`F = \tau \lvert T(F)\rvert/r` has a solution (Brouwer), which Broyden's method finds.
    """
    gears = [g for g, s in train.splines.items() if s.friction_force is None]
    rate = np.array([train.splines[g].friction_per_torque for g in gears])
    drive = float(np.abs(situation_of(train, index).torque).max(initial=0.0))
    bounds = np.array([ways.bounds.pop(g, 0.0) for g in gears])
    inverse, least = np.eye(len(gears)), math.inf
    before: tuple[Array, Array] | None = None
    for _ in range(MARCH.passes):
        try:
            fixed = _bounded(train, dict(zip(gears, bounds.tolist(), strict=True)))
            answer = stepped(fixed, index, ways)
        except Refused:
            return None
        found = answer.equilibrium
        torque = [train.transmitted(g, found.flank_force) for g in gears]
        off = rate * np.abs(torque) - bounds
        far = float(np.abs(off).max())
        # What is that close and comes no closer is as close as rounding of the torques lets it.
        as_close = far <= MARCH.close * float(bounds.max()) and far > 0.5 * least
        if as_close or far <= MARCH.settled * float(rate.max()) * drive:
            break
        least = min(least, far)
        if before is not None:
            inverse = _broyden(inverse, bounds - before[0], off - before[1])
        before = bounds, off
        bounds = np.maximum(bounds + inverse @ off, 0.0)
    judged = _judged(train, found, answer.record, f"{answer.rung}, friction followed")
    if judged is not None:
        ways.bounds.update(zip(gears, bounds.tolist(), strict=True))
    return judged


def _judged(train: Train, found: Equilibrium, record: Record, rung: str) -> Answer | None:
    """Return an equilibrium as an answer if its certificate passes."""
    certificate = certify(train, found, CERTIFY.tolerance)
    return Answer.of(train, found, certificate, record, rung) if certificate.passed else None


def _bounded(train: Train, bounds: Mapping[str, float]) -> Train:
    """Return the train with some friction bounds [N] fixed."""
    fixed = {g: replace(train.splines[g], friction_force=b) for g, b in bounds.items()}
    return replace(train, splines={**train.splines, **fixed})


def _broyden(inverse: Array, step: Array, change: Array) -> Array:
    """Inverse of −Jacobian that also turns a change of what is off into the step that made it."""
    moved = -inverse @ change
    along = float(step @ moved)
    if abs(along) <= MARCH.singular * float(step @ step):
        return inverse
    return np.asarray(inverse + np.outer(step - moved, step @ inverse) / along)


def _searched(train: Train, index: int) -> Answer | None:
    """Return a certified answer by the proximal search, if there is one.

    It knows friction with fixed bounds only, as elements of their own next to a shaft that bends.
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
        # A spline has no law with memory; the general programme says why.
        return None
    force, row = iterate.force[0] * structure.force, structure.springs
    forces = dict(zip(structure.row_names, force[row:].tolist(), strict=False))
    columns = {r.name: structure.radial_column(j) for j, r in enumerate(scene.radials)}
    settled = Settled(
        x=x,
        forces=forces,
        radial_forces={name: force[k : k + 2] for name, k in columns.items()},
        laws=laws,
        kind="force method",
        iterations=(),
    )
    plan = Plan.full(scene)
    record = Record(
        SEARCHED, "force", settled.kind, (), plan, int(found.turns[0]), scene.removed,
        scene.coordinates,
    )  # fmt: skip
    return _judged(train, equilibrium_of(scene, settled), record, SEARCHED)


def _all_but_free(train: Train, index: int) -> Answer | None:
    """Return a certified answer for friction that is next to nothing.

    That without it, to which friction is added along the way that each slip has gone.
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
        way = slip_of(free[gear], found) - _before(train)[gear]
        far = float(np.linalg.norm(way)) or 1.0
        friction = -spline.bound(0.0) / far * way
        pushes = float(np.linalg.norm(stop)) > spline.bound(0.0)
        reactions[spline.stop_name] = stop - friction if pushes else np.zeros(3)
        reactions[spline.name] = friction
    equilibrium = replace(found, radial_reaction={**found.radial_reaction, **reactions})
    return _judged(train, equilibrium, answer.record, f"{answer.rung}, friction added")


def _in_turn(train: Train, index: int) -> Answer | None:
    """Return a certified answer by giving slips and displacements in turn, if that settles.

    Each step lessens a convex energy. It settles fast where the slips have little room, which is
    where active sets fail: a slip turns about a centre that is nearer than a step.
    """
    gears, slips = tuple(train.splines), dict(_before(train))
    for _ in range(MARCH.turns):
        scene = _without_slip(assemble(train, index), gears, slips)
        try:
            found, record = solve_scene(scene, BACKEND)
        except Refused:
            return None
        other = {
            g: _slip_at(s, found.displacement[g], _before(train)[g])
            for g, s in train.splines.items()
        }
        change = max(float(np.linalg.norm(other[g] - slips[g])) for g in gears)
        far = max(float(np.linalg.norm(found.displacement[g])) for g in gears)
        if change <= MARCH.round_off * far:
            return _judged(train, _split(train, found, gears, slips), record, "slips in turn")
        slips = other
    return None


def _slip_at(spline: Spline, place: Vector, before: Vector) -> Vector:
    """Slip s that a displacement p gives: least ½ K_w |p − s|² + F_m |s − s₀| within the room."""
    stiffness, bound = spline.bending_stiffness, spline.bound(0.0)
    room = SlipStop(spline).law(0.0).reach
    force = stiffness * (place - before)
    size = float(np.linalg.norm(force))
    free = before + max(1.0 - bound / size, 0.0) * (place - before) if size > 0.0 else before
    if float(np.linalg.norm(free)) <= room or room == 0.0:
        return free if room > 0.0 else np.zeros(3)
    start = np.asarray(before)
    if float(np.linalg.norm(start)) >= room * (1.0 - MARCH.at_end):
        left = force - _least(force, start, bound)
        if float(np.linalg.norm(left)) <= bound * (1.0 + MARCH.round_off):
            return start
    # On the edge of the room, between the way to the slip before and the way to the displacement.
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


def _subsets(gears: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield all sets of gears but the empty one, the largest first."""
    for count in range(len(gears), 0, -1):
        yield from combinations(gears, count)


def _at_end(spline: Spline, slip: Vector) -> bool:
    if spline.friction_force is None:
        # Its room changes with the torque, so that friction and stop hardly ever meet.
        return False
    room = SlipStop(spline).law(0.0).reach
    return float(np.linalg.norm(slip)) >= room * (1.0 - MARCH.at_end)


def _held(
    train: Train,
    index: int,
    gears: tuple[str, ...],
    tries: Iterable[tuple[str, Options]],
    steps: float = math.inf,
    plans: Sequence[float] = (MARCH.quick_plan, math.inf),
) -> Answer | None:
    """Return a certified answer with the slip of some splines held, if there is one.

    Within so many Newton steps in all, and for every plan; with each of several limits of a plan.
    """
    scene = whole = assemble(train, index)
    if gears:
        scene = _without_slip(whole, gears, _before(train))
    for (rung, options), few in product(tries, plans):
        known = Known(work=Work(steps), each=few)
        try:
            found, record = solve_scene(scene, options, known)
        except Refused:
            continue
        split = _split(train, found, gears, _before(train))
        answer = _judged(train, split, record, rung + ", slip held" * bool(gears))
        if answer is not None:
            split = with_ranges(split, whole)
            certificate = certify(train, split, CERTIFY.tolerance)
            return Answer.of(train, split, certificate, answer.record, answer.rung)
    return None


def _before(train: Train) -> Mapping[str, Vector]:
    assert train.slip is not None
    return {gear: np.asarray(slip) for gear, slip in train.slip.items()}


def _without_slip(scene: Scene, gears: tuple[str, ...], slips: Mapping[str, Vector]) -> Scene:
    """Return the scene with the slips of some splines held."""
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


def _split(
    train: Train, found: Equilibrium, gears: tuple[str, ...], slips: Mapping[str, Vector]
) -> Equilibrium:
    """Share the force that holds a slip between friction and the stop."""
    reactions = dict(found.radial_reaction)
    for gear in gears:
        spline, before, slip = train.splines[gear], _before(train)[gear], slips[gear]
        force = spline.bending_stiffness * (found.displacement[gear] - slip)
        torque = train.transmitted(gear, found.flank_force)
        bound, reach = spline.bound(torque), SlipStop(spline).law(torque).reach
        way = float(np.linalg.norm(slip - before))
        stop = np.zeros(3)
        if way > 0.0:
            stop = force - bound / way * (slip - before)
        elif float(np.linalg.norm(slip)) >= reach * (1.0 - MARCH.at_end):
            stop = _least(force, slip, bound)
        reactions[spline.name], reactions[spline.stop_name] = stop - force, -stop
    return replace(found, radial_reaction=reactions)


def _least(force: Vector, outward: Vector, bound: float) -> Vector:
    """Least push of the stop that leaves friction no more than its bound."""
    size = float(np.linalg.norm(outward))
    along = outward / size if size > 0.0 else force / (float(np.linalg.norm(force)) or 1.0)
    pushed = float(force @ along)
    sideways = max(float(force @ force) - pushed**2, 0.0)
    return np.asarray(max(pushed - np.sqrt(max(bound**2 - sideways, 0.0)), 0.0) * along)
