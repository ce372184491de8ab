"""One step with memory, certified: by the general programme, or with some splines held fast.

A spline whose slip stood at the end of its clearance and does not change is held by friction and by
the stop at once. How they share its force is then open, and an active set with both is singular.
There the slip is taken out of the programme, the force that holds it is found, and it is split so
that the stop takes no more than friction leaves. The certificate judges it by the full law.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import combinations, islice

import numpy as np

from loadshare.certify import certify
from loadshare.certify.certificate import TOLERANCE
from loadshare.errors import Refused
from loadshare.job.ladder import Answer, rungs
from loadshare.scene import assemble
from loadshare.scene.scene import Array, Scene
from loadshare.solver import Options, solve_scene
from loadshare.solver.position import of_least_norm
from loadshare.study.answers import BACKEND, certified
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.memory import SlipStop
from loadshare.train.train import Spline, Train

AT_END = 1e-6
"""Room left in a clearance, over the clearance, below which its end is near."""


def stepped(train: Train, index: int) -> Answer:
    """Solve and certify a position of a train whose splines remember their slip.

    Parameters
    ----------
    train : Train
        One that remembers (`Train.remembering`).
    index : int
        1-based.

    Raises
    ------
    Refused
        If the position has no certified equilibrium.
    """
    assert train.slip is not None
    # A slip that stood at the end of its clearance mostly stays there.
    ends = [g for g, s in train.splines.items() if _at_end(s, train.slip[g])]
    for gears in _subsets(ends):
        answer = _held(train, index, gears, islice(rungs(BACKEND), 1))
        if answer is not None:
            return answer
    try:
        return certified(train, index)
    except Refused as refusal:
        for gears in _subsets(list(train.splines)):
            answer = _held(train, index, gears, rungs(BACKEND))
            if answer is not None:
                return answer
        raise refusal from None


def _subsets(gears: list[str]) -> Iterator[tuple[str, ...]]:
    """Yield all sets of gears but the empty one, the largest first."""
    for count in range(len(gears), 0, -1):
        yield from combinations(gears, count)


def _at_end(spline: Spline, slip: Vector) -> bool:
    if spline.friction_force is None:
        # Its room changes with the torque, so that friction and stop hardly ever meet.
        return False
    room = SlipStop(spline).law(0.0).reach
    return float(np.linalg.norm(slip)) >= room * (1.0 - AT_END)


def _held(
    train: Train, index: int, gears: tuple[str, ...], tries: Iterable[tuple[str, Options]]
) -> Answer | None:
    """Return a certified answer with the slip of some splines held, if there is one."""
    scene = _without_slip(assemble(train, index), gears)
    for rung, options in tries:
        try:
            found, record = solve_scene(scene, options)
        except Refused:
            continue
        split = _split(train, found, gears)
        certificate = certify(train, split, TOLERANCE)
        if certificate.passed:
            ranges = of_least_norm(assemble(train, index), split).undetermined
            split = replace(split, undetermined=ranges)
            certificate = certify(train, split, TOLERANCE)
            return Answer(train, split, certificate, record, f"{rung}, slip held")
    return None


def _without_slip(scene: Scene, gears: tuple[str, ...]) -> Scene:
    """Return the scene with the slip of some splines held where it was."""
    train = scene.train
    assert train.slip is not None
    gone: dict[int, float] = {}
    for gear in gears:
        before = train.gears[gear].frame @ train.slip[gear]
        first = scene.coordinates.index(f"spline {gear} slip x")
        gone |= {first: float(before[0]), first + 1: float(before[1])}
    kept = np.array([k for k in range(scene.size) if k not in gone])
    lost, values = np.array(list(gone)), np.array(list(gone.values()))

    def cut(array: Array) -> Array:
        return np.asarray(array[..., kept])

    return replace(
        scene,
        coordinates=tuple(scene.coordinates[k] for k in kept),
        stiffness=scene.stiffness[np.ix_(kept, kept)],
        load=scene.load[kept] - scene.stiffness[np.ix_(kept, lost)] @ values,
        rows=tuple(replace(r, vector=cut(r.vector)) for r in scene.rows),
        arcs=tuple(replace(a, relative=cut(a.relative)) for a in scene.arcs),
        radials=tuple(
            replace(r, matrix=cut(r.matrix))
            for r in scene.radials
            if not _holds(r.name, train, gears)
        ),
    )


def _holds(name: str, train: Train, gears: tuple[str, ...]) -> bool:
    return any(name in (train.splines[g].name, train.splines[g].stop_name) for g in gears)


def _split(train: Train, found: Equilibrium, gears: tuple[str, ...]) -> Equilibrium:
    """Share the force that holds a slip between friction and the stop."""
    assert train.slip is not None
    reactions = dict(found.radial_reaction)
    for gear in gears:
        spline, before = train.splines[gear], np.asarray(train.slip[gear])
        force = spline.bending_stiffness * (found.displacement[gear] - before)
        torque = train.transmitted(gear, found.flank_force)
        bound, reach = spline.bound(torque), SlipStop(spline).law(torque).reach
        stop = np.zeros(3)
        if float(np.linalg.norm(before)) >= reach * (1.0 - AT_END):
            stop = _least(force, before, bound)
        reactions[spline.name], reactions[spline.stop_name] = stop - force, -stop
    return replace(found, radial_reaction=reactions)


def _least(force: Vector, outward: Vector, bound: float) -> Vector:
    """Least push of the stop that leaves friction no more than its bound."""
    size = float(np.linalg.norm(outward))
    along = outward / size if size > 0.0 else force / (float(np.linalg.norm(force)) or 1.0)
    pushed = float(force @ along)
    sideways = max(float(force @ force) - pushed**2, 0.0)
    return np.asarray(max(pushed - np.sqrt(max(bound**2 - sideways, 0.0)), 0.0) * along)
