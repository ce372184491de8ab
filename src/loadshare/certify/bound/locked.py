"""Gears that rigid limits keep from moving: how their limits share the force does not matter.

A gear in a rigid ring without play stays where it is, however its stops, its spline and its ring
share the force on it. Its place, known to within the play of the limits, is taken as given and its
limits are left out; the bound then covers all the rest. Source: formulation, section 16.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.columns import Columns
from loadshare.settings import BOUND
from loadshare.train.equilibria import Equilibria, Names
from loadshare.train.ring import DrumRing, Ring, RoundRing
from loadshare.train.situations import Situations
from loadshare.train.train import Train


def locked(claim: Claim) -> dict[str, Array]:
    """Return how far gears may be from their claimed places, (S,) [m]; infinite where they move.

    Gears that move in all claims may be missing.
    """
    found: dict[str, Array] = {}
    columns = claim.columns
    train = columns.train
    if train.slip is not None:
        return found
    deflection = claim.lengths[0].value[:, columns.flanks].max(axis=1, initial=0.0)
    neighbours = {n for r in train.drums for n in r.neighbours}
    limits: tuple[Ring, ...] = (*train.drums, *train.rounds)
    for limit in limits:
        if math.isfinite(limit.stiffness) or limit.gear in neighbours:
            continue
        play = _drum(claim, limit) if isinstance(limit, DrumRing) else _round(claim, limit)
        other = found.get(limit.gear, np.full(claim.count, np.inf))
        found[limit.gear] = np.where(play <= BOUND.slight * deflection, play, other)
    return found


def _round(claim: Claim, ring: RoundRing) -> Array:
    """Return how far a gear in a rigid round ring may be from its claimed place, (S,)."""
    columns = claim.columns
    q = columns.train.rounds.index(ring)
    off = np.hypot(*claim.lengths[0].value[:, columns.both(q)].T)
    return np.where(claim.graphs[:, q, 3] == 0.0, off, np.inf)


def _drum(claim: Claim, ring: DrumRing) -> Array:
    """Return how far a gear in a rigid drum may be from its claimed place, (S,)."""
    train, columns = claim.columns.train, claim.columns
    if any(train.gears[n].moves for n in ring.neighbours):
        return np.full(claim.count, np.inf)
    frame = train.gears[ring.gear].frame
    across = frame @ ring.across
    drum = train.drums.index(ring)
    stops = columns.stops.start + 2 * drum
    ways, margins, sizes = (v[:, 2 * drum : 2 * drum + 2] for v in claim.arcs)
    distance = np.sqrt((ways**2).sum(axis=2))
    # a·δ ≥ −m for every move δ from the claim that all four limits allow.
    both = np.broadcast_to([-across, across], (claim.count, 2, 2))
    normals = np.concatenate([both, ways / distance[:, :, None]], axis=1)
    lengths = claim.lengths[0].value[:, stops : stops + 2]
    room = np.maximum(np.concatenate([-lengths, margins], axis=1), 0.0)
    room += EPS * np.concatenate([np.abs(room[:, :2]), sizes], axis=1)
    play = _reach(normals, room)
    # Arcs bow away from their tangents by less than this, as long as the play is small.
    bow = np.zeros_like(room)
    bow[:, 2:] = (2.0 * play[:, None]) ** 2 / distance
    further = _reach(normals, room + bow)
    small = further <= np.minimum(2.0 * play, BOUND.bowed * distance.min(axis=1))
    return np.where(small, further, np.inf)


def _reach(normals: Array, room: Array) -> Array:
    """Return the largest moves (S,) that half-planes a·δ ≥ −m allow, by weak duality of pairs.

    Shapes (S, k, 2) and (S, k).
    """
    longest = np.zeros(len(room))
    for way in np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]):
        least = np.full(len(room), np.inf)
        for i, j in combinations(range(room.shape[1]), 2):
            one, other = normals[:, i], normals[:, j]
            both = _cross(one, other)
            # The shares of the pair whose sum is opposed to the move.
            shares = np.stack([-_cross(way, other), -_cross(one, way)], axis=1) / both[:, None]
            holds = (np.abs(both) > BOUND.bowed) & (shares >= -EPS).all(axis=1)
            far = (np.maximum(shares, EPS) * room[:, [i, j]]).sum(axis=1)
            least = np.where(holds, np.minimum(least, far), least)
        longest = np.maximum(longest, least)
    return math.sqrt(2.0) * longest


def _cross(one: Array, other: Array) -> Array:
    """Return the cross products of vectors in a plane."""
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])


def without(claim: Claim, gears: Mapping[str, Array]) -> tuple[Claim, Numbers]:
    """Return claims for the train in which some gears are held at their claimed places.

    Parameters
    ----------
    claim : Claim
    gears : mapping of gear to ndarray, shape (S, 1 or 2)
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
    at_places = np.zeros(claim.answers.displacement.shape)
    for gear in gears:
        at = whole.order[gear]
        at_places[:, at] = claim.answers.displacement[:, at]
    here = _held(claim.situations, held, gears, at_places)
    left = iter(enumerate(whole.names))
    origin = np.array([next(k for k, n in left if n == name) for name in columns.names], dtype=int)
    slack = np.zeros((claim.count, len(columns.names)))
    for gear, play in gears.items():
        at = whole.places[gear]
        moved = np.abs(whole.matrix.high[origin, at : at + 2])
        rounding = EPS * np.abs(here.offset[:, whole.order[gear]]).sum(axis=1)
        slack += (np.broadcast_to(play, (claim.count, 2)) + rounding[:, None]) @ moved.T
    return Claim(columns, here, _answers(claim.answers, held, gears), slack=slack), origin


def _held(here: Situations, held: Train, gears: Iterable[str], moved: Array) -> Situations:
    """Return situations without the elements that hold some gears, moved by (S, gears, 3) [m]."""
    train = here.train
    drums, rounds = ([r.gear not in gears for r in kind] for kind in (train.drums, train.rounds))
    splines = [gear not in gears for gear in train.splines]
    kept = {
        **dict.fromkeys(("arc_shift", "arc_clearance", "stop", "wall"), drums),
        **dict.fromkeys(("round_offset", "round_radius", "round_stiffness", "round_power"), rounds),
        "spline": splines,
    }
    arrays = {name: getattr(here, name)[:, keep] for name, keep in kept.items()}
    return replace(here, train=held, count=len(moved), offset=here.offset + moved, **arrays)


def _answers(answers: Equilibria, held: Train, gears: Iterable[str]) -> Equilibria:
    """Return answers without the forces of the elements that hold some gears."""
    names, whole = Names(held), answers.names
    contacts = [whole.contacts.index(contact) for contact in names.contacts]
    radials = [whole.radials.index(radial) for radial in names.radials]
    free = np.array([gear not in gears for gear in names.gears])
    return replace(
        answers,
        names=names,
        ring_force=answers.ring_force[:, contacts],
        radial_reaction=answers.radial_reaction[:, radials],
        support_force=answers.support_force * free[:, None],
    )
