"""What is known about a problem before any solver sees it: whether an equilibrium exists.

The energy is convex and its curved parts grow faster than any linear one, so a minimum exists
exactly when two linear programmes have an answer: forces that balance the load (no direction in
which the train runs away) and displacements that all rigid limits admit. Both are written here from
the train alone and solved by HiGHS, which no method on the map uses. The margin decides: an
imbalance of the size of round-off (below `NONE`) counts as zero, one above `SOME` is real, and a
problem in between is not suitable for the map.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.train.placed import train_at
from loadshare.train.ring import DrumRing, RoundRing
from loadshare.train.situations import Situations, situation_of
from loadshare.train.train import Train

Array = NDArray[np.float64]

NONE, SOME = 1e-12, 1e-5
"""Imbalance over load, or overlap over clearance: below `NONE` it counts as zero, above `SOME` as
real."""
ROUNDING = 1e-3
"""Overlap over centre distance that `NONE` and `SOME` refer to if clearances are smaller."""
FACETS = 64
"""Number of sides of the polygon that replaces a rigid round ring."""


@dataclass(frozen=True, slots=True)
class Truth:
    """What is known about a problem in advance.

    Attributes
    ----------
    solvable : bool
    elements : tuple of str
        For a problem without an answer: a refusal must name at least one of these.
    why : str
        The figure that decides, in words.
    """

    solvable: bool
    elements: tuple[str, ...]
    why: str


def truth_of(train: Train, index: int = 1) -> Truth:
    """Decide whether a position has an equilibrium.

    Raises
    ------
    ValueError
        If round-off would decide.
    """
    train = train_at(train, index)
    situation = situation_of(train, index)
    imbalance, gears = _imbalance(train, situation)
    overlap, rings = _overlap(train, situation)
    for figure, what in ((imbalance, "imbalance"), (overlap, "overlap")):
        if NONE < figure < SOME:
            raise ValueError(f"{train.name}: {what} {figure:.1e} is neither none nor some")
    if imbalance >= SOME:
        why = f"no forces balance {imbalance:.2g} of the load on gears {', '.join(gears)}"
        return Truth(False, gears, why)
    if overlap >= SOME:
        return Truth(False, rings, f"the limits of {', '.join(rings)} overlap by {overlap:.2g}")
    return Truth(True, (), f"imbalance {imbalance:.0e}, overlap {overlap:.0e}")


def _imbalance(train: Train, situation: Situations) -> tuple[float, tuple[str, ...]]:
    """Return the smallest unbalanced fraction of the load, and the gears that it pushes away."""
    rows: dict[tuple[str, int], int] = {}
    for name, gear in train.gears.items():
        if name != train.output:
            rows[name, 2] = len(rows)
        if gear.moves:
            rows[name, 0] = len(rows)
            rows[name, 1] = len(rows)
    columns: list[Array] = []
    lower: list[float] = []

    def column(low: float, *entries: tuple[str, int, float]) -> None:
        values = np.zeros(len(rows))
        for gear, axis, value in entries:
            if (gear, axis) in rows:
                values[rows[gear, axis]] += value
        columns.append(values)
        lower.append(low)

    def push(gear: str, direction: Array) -> list[tuple[str, int, float]]:
        plane = train.gears[gear].frame @ direction
        return [(gear, 0, float(plane[0])), (gear, 1, float(plane[1]))]

    for to in train.approaches.values():
        turns = [(g, 2, -arm / train.gears[g].base_radius) for g, arm in to.turning.items()]
        moves = [part for g, along in to.shifting.items() for part in push(g, -along)]
        column(0.0, *turns, *moves)
    for shaft in train.shafts.values():
        ends = (shaft.first, -1.0), (shaft.second, 1.0)
        size = min(train.gears[g].base_radius for g, _ in ends)
        column(-math.inf, *((g, 2, s * size / train.gears[g].base_radius) for g, s in ends))
    for name, gear in train.gears.items():
        limits = train.limits.get(name, ())
        if any(isinstance(r, RoundRing) for r in limits) or name in train.splines:
            held = (True, True)
        else:
            held = tuple(gear.support > 0.0) if gear.support is not None else (False, False)
        for axis in (0, 1):
            if held[axis]:
                column(-math.inf, (name, axis, 1.0))
        for ring in (r for r in limits if isinstance(r, DrumRing)):
            for side, neighbour in enumerate(ring.neighbours):
                normal = situation.arc(ring, side).normal(np.zeros(3))
                column(0.0, *push(name, normal), *push(neighbour, -normal))
            for sign in (1.0, -1.0):
                column(0.0, *push(name, -sign * ring.across))
    load = np.zeros(len(rows))
    for name, torque in situation.torques.items():
        if (name, 2) in rows:
            load[rows[name, 2]] += torque / train.gears[name].base_radius
    for (name, gear), force in zip(train.gears.items(), situation.push[0], strict=True):
        entries = push(name, force)
        if gear.carrier is not None:
            arm = train.gears[gear.carrier].base_radius
            entries += [
                *push(gear.carrier, force),
                (gear.carrier, 2, float(force @ gear.pin_motion) / arm),
            ]
        for body, axis, value in entries:
            if (body, axis) in rows:
                load[rows[body, axis]] += value
    size = float(np.abs(load).max(initial=0.0))
    if size == 0.0:
        return 0.0, ()
    matrix = np.array(columns).T
    values, ray = _least_gap(matrix, -load / size, np.array(lower))
    names = {g for (g, axis), k in rows.items() if abs(ray[k]) > 1e-6}
    return values, tuple(g for g in train.gears if g in names)


def _least_gap(matrix: Array, right: Array, lower: Array) -> tuple[float, Array]:
    """Return min ‖A z − r‖₁ over z ≥ lower, and the multipliers of the rows."""
    from scipy.optimize import linprog

    count, size = matrix.shape
    eye = np.eye(count)
    answer = linprog(
        np.concatenate([np.zeros(size), np.ones(2 * count)]),
        A_eq=np.hstack([matrix, eye, -eye]),
        b_eq=right,
        bounds=[*((low, None) for low in lower), *[(0.0, None)] * (2 * count)],
        method="highs-ds",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    if answer.x is None:
        raise RuntimeError(f"HiGHS gave no answer: {answer.message}")
    left = float(np.abs(matrix @ answer.x[:size] - right).sum())
    return left, np.asarray(answer.eqlin.marginals)


def _overlap(train: Train, situation: Situations) -> tuple[float, tuple[str, ...]]:
    """Return by how much the rigid limits exclude each other, and the rings that do."""
    where = {n: 2 * k for k, n in enumerate(n for n, g in train.gears.items() if g.moves)}
    rows: list[Array] = []
    bounds: list[float] = []
    owner: list[str] = []
    reach = 0.0

    def limit(ring: str, bound: float, *pushes: tuple[str, Array]) -> None:
        row = np.zeros(2 * len(where))
        for gear, direction in pushes:
            if gear in where:
                row[where[gear] : where[gear] + 2] += train.gears[gear].frame @ direction
        rows.append(row)
        bounds.append(bound)
        owner.append(ring)

    for name, ring in ((n, r) for n, found in train.limits.items() for r in found):
        if not math.isinf(ring.stiffness):
            continue
        if isinstance(ring, RoundRing):
            frame = train.gears[name].frame
            for angle in np.linspace(0.0, 2.0 * math.pi, FACETS, endpoint=False):
                along = np.array([math.cos(angle), math.sin(angle)]) @ frame
                limit(ring.gear, ring.radius + float(along @ ring.offset), (name, along))
            continue
        for side, neighbour in enumerate(ring.neighbours):
            arc = situation.arc(ring, side)
            normal, bound = arc.face(np.zeros(3))
            reach = max(reach, ROUNDING * arc.distance)
            limit(ring.gear, bound, (name, -normal), (neighbour, normal))
        limit(ring.gear, ring.up, (name, ring.across))
        limit(ring.gear, ring.down, (name, -ring.across))
    if min(bounds, default=0.0) >= 0.0:
        return 0.0, ()
    size = max(max(abs(b) for b in bounds), reach)
    from scipy.optimize import linprog

    matrix, right = np.array(rows), np.array(bounds) / size
    count = matrix.shape[1]
    answer = linprog(
        np.append(np.zeros(count), 1.0),
        A_ub=np.hstack([matrix, -np.ones((len(rows), 1))]),
        b_ub=right,
        bounds=[*[(None, None)] * count, (0.0, None)],
        method="highs-ds",
    )
    if answer.x is None:
        raise RuntimeError(f"HiGHS gave no answer: {answer.message}")
    held = {owner[k] for k in np.flatnonzero(np.abs(answer.ineqlin.marginals) > 1e-9)}
    return float(answer.x[-1]), tuple(r for r in train.limits if r in held)
