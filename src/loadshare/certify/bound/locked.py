"""Gears that rigid limits keep from moving: how their limits share the force does not matter.

A gear in a rigid ring without play stays where it is, however its stops, its spline and its ring
share the force on it. Its place, known to within the play of the limits, is taken as given and its
limits are left out; the bound then covers all the rest. Source: formulation, section 16.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.columns import Columns
from loadshare.settings import BOUND
from loadshare.train.equilibria import Equilibria
from loadshare.train.ring import DrumRing, Ring, RoundRing
from loadshare.train.situations import Situations
from loadshare.train.train import Train


def locked(claim: Claim) -> dict[str, float]:
    """Return the gears that cannot move, and how far each may be from its claimed place [m].

    Parameters
    ----------
    claim : Claim
        A single one.
    """
    found: dict[str, float] = {}
    columns = claim.columns
    train = columns.train
    if train.slip is not None:
        return found
    deflection = float(claim.lengths[0].value[0, columns.flanks].max(initial=0.0))
    neighbours = {n for r in train.drums for n in r.neighbours}
    limits: tuple[Ring, ...] = (*train.drums, *train.rounds)
    for limit in limits:
        if math.isfinite(limit.stiffness) or limit.gear in neighbours:
            continue
        play = _drum(claim, limit) if isinstance(limit, DrumRing) else _round(claim, limit)
        if play <= BOUND.slight * deflection:
            found[limit.gear] = play
    return found


def _round(claim: Claim, ring: RoundRing) -> float:
    """Return how far a gear in a rigid round ring may be from its claimed place."""
    columns = claim.columns
    q = columns.train.rounds.index(ring)
    radius = float(claim.graphs[0, q, 3])
    off = math.hypot(*claim.lengths[0].value[0, columns.both(q)].tolist())
    return off if radius == 0.0 else math.inf


def _drum(claim: Claim, ring: DrumRing) -> float:
    """Return how far a gear in a rigid drum may be from its claimed place."""
    train, columns = claim.columns.train, claim.columns
    if any(train.gears[n].moves for n in ring.neighbours):
        return math.inf
    frame = train.gears[ring.gear].frame
    across = frame @ ring.across
    drum = train.drums.index(ring)
    stops = columns.stops.start + 2 * drum
    ways, margins, sizes = (v[0, 2 * drum : 2 * drum + 2] for v in claim.arcs)
    distance = np.sqrt((ways**2).sum(axis=1))
    # a·δ ≥ −m for every move δ from the claim that all four limits allow.
    normals = np.array([-across, across, *(ways / distance[:, None])])
    room = np.maximum([*-claim.lengths[0].value[0, stops : stops + 2], *margins], 0.0)
    room += EPS * np.array([*np.abs(room[:2]), *sizes])
    play = _reach(normals, room)
    # Arcs bow away from their tangents by less than this, as long as the play is small.
    bow = np.array([0.0, 0.0, *((2.0 * play) ** 2 / distance)])
    further = _reach(normals, room + bow)
    return further if further <= min(2.0 * play, BOUND.bowed * float(distance.min())) else math.inf


def _reach(normals: Array, room: Array) -> float:
    """Return the largest move that half-planes a·δ ≥ −m allow, by weak duality of every pair."""
    longest = 0.0
    for direction in (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0):
        longest = max(longest, min(_supports(normals, room, np.array(direction)), default=math.inf))
    return math.sqrt(2.0) * longest


def _supports(normals: Array, room: Array, direction: Array) -> Iterator[float]:
    """Yield bounds on how far moves may go along a direction."""
    for i, j in combinations(range(len(normals)), 2):
        pair = normals[[i, j]].T
        if abs(np.linalg.det(pair)) > BOUND.bowed:
            shares = np.linalg.solve(pair, -direction)
            if (shares >= -EPS).all():
                yield float(np.maximum(shares, EPS) @ room[[i, j]])


def without(claim: Claim, gears: Mapping[str, float | Array]) -> tuple[Claim, Numbers]:
    """Return the claim for the train in which some gears are held at their claimed places.

    Parameters
    ----------
    claim : Claim
        A single one.
    gears : mapping of gear to float or ndarray, shape (2,)
        How far each may be from there [m], in any direction or along its axes.

    Returns
    -------
    claim : Claim
        With what these places leave open of lengths as `slack`.
    columns : ndarray of int
        Number of each of its columns among those of the whole train.
    """
    train, whole = claim.columns.train, claim.columns
    held = replace(
        train,
        gears={n: replace(g, support=None) if n in gears else g for n, g in train.gears.items()},
        splines={n: s for n, s in train.splines.items() if n not in gears},
        rings={n: r for n, r in train.rings.items() if n not in gears},
        bearings={n: b for n, b in train.bearings.items() if n not in gears},
    )
    columns = Columns(held)
    here = _held(claim.situations, held, gears)
    for gear in gears:
        here.offset[:, whole.order[gear]] += claim.answers.displacement[0, whole.order[gear]]
    answer = Equilibria.empty(held, 1)
    answer.put(0, claim.answers.one(0, int(here.index[0])))
    left = iter(enumerate(whole.names))
    origin = np.array([next(k for k, n in left if n == name) for name in columns.names], dtype=int)
    slack = np.zeros(len(columns.names))
    for gear, play in gears.items():
        at = whole.places[gear]
        moved = np.abs(whole.matrix.high[origin, at : at + 2])
        rounding = EPS * np.abs(here.offset[0, whole.order[gear]]).sum()
        slack += moved @ (np.broadcast_to(play, 2) + rounding)
    return Claim(columns, here, answer, slack=slack), origin


def _held(here: Situations, held: Train, gears: Iterable[str]) -> Situations:
    """Return the situation without the elements that hold some gears."""
    train = here.train
    drums, rounds = ([r.gear not in gears for r in kind] for kind in (train.drums, train.rounds))
    splines = [gear not in gears for gear in train.splines]
    kept = {
        **dict.fromkeys(("arc_shift", "arc_clearance", "stop", "wall"), drums),
        **dict.fromkeys(("round_radius", "round_stiffness", "round_power"), rounds),
        "spline": splines,
    }
    arrays = {name: getattr(here, name)[:, keep] for name, keep in kept.items()}
    return replace(here, train=held, offset=here.offset.copy(), **arrays)
