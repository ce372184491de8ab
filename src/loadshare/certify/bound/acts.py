"""Which elements act at a claim, and how."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.settings import BOUND

Acts = NDArray[np.int8]


class Act:
    """How an element acts.

    Plain numbers: comparing arrays with members of an enumeration takes ten times as long.
    """

    OPEN = 0
    """Not at all."""
    STICK = 1
    """As a spring about its centre."""
    PINNED = 2
    """Rigidly."""
    STEP = 3
    """Rigidly along its line, at the radius S1 where the force steps up to the level."""
    SLIP = 4
    """With a given force along its line."""
    STOP = 5
    """Along its line: a closed flank, stop or arc, a ring, a spline at its clearance."""
    WAYS = 6
    """Number of ways to act."""


OPEN, CLOSED, LIGHT, ENDLESS = range(4)
"""How an element acts in large batches.

Not at all; by its law; by the law of a light Hertz contact, which is soft; without force, where it
yields without limit, as a radial element with almost no force may do as well.
"""


def first_acts(claim: Claim, noise: float = BOUND.noise) -> Acts:
    """Return how the elements act according to the claimed forces, shape (S, elements).

    Parameters
    ----------
    claim : Claim
    noise : float
        Largest friction, over the largest force, that is put aside.
    """
    columns = claim.columns
    pushes, flanks = claim.pushes, columns.flanks
    largest = np.abs(pushes[:, flanks]).max(axis=1, initial=0.0)[:, None]
    deflection = claim.lengths[0].value[:, flanks].max(axis=1, initial=0.0)[:, None]
    faint = (np.abs(pushes) <= BOUND.noise * largest) & (claim.gaps > BOUND.apart * deflection)
    closed = (pushes != 0.0) & ~faint
    scalar = np.where(closed, Act.STOP, Act.OPEN).astype(np.int8)
    radials = np.zeros((claim.count, 0), np.int8)
    if columns.claims.radials:
        radials = _radial_acts(claim, noise * largest)
    return np.concatenate([scalar, radials], axis=1)


def unmoved(claim: Claim, distance: Array) -> Flags:
    """Return which radial elements are splines with memory whose slip changed by rounding only."""
    train, columns = claim.columns.train, claim.columns
    found = np.zeros(distance.shape, dtype=bool)
    for k, gear in enumerate(train.splines if train.slip is not None else ()):
        before = np.linalg.norm((train.slip or {})[gear])
        place = np.abs(claim.answers.displacement[:, columns.order[gear]]).max(axis=1)
        at = columns.claims.splines.start + k
        found[:, at] = distance[:, at] <= EPS * (before + place)
    return found


def alike(codes: Acts | Flags) -> list[Numbers]:
    """Return the numbers of rows with the same codes, group by group."""
    if (codes == codes[:1]).all():
        return [np.arange(len(codes))]
    group = np.zeros(len(codes), dtype=np.int64)
    for at in range(0, codes.shape[1], BOUND.digits):
        digits = codes[:, at : at + BOUND.digits].astype(np.int64)
        number = digits @ Act.WAYS ** np.arange(digits.shape[1])
        _, number = np.unique(number, return_inverse=True)
        _, group = np.unique(group * (number.max() + 1) + number, return_inverse=True)
    order = np.argsort(group, kind="stable")
    return np.split(order, np.cumsum(np.bincount(group))[:-1])


def _radial_acts(claim: Claim, noise: Array) -> Acts:
    columns = claim.columns
    pair = claim.forces[:, columns.radials].reshape(claim.count, -1, 2)
    where = claim.lengths[0].value[:, columns.radials].reshape(claim.count, -1, 2)
    size, distance = (np.sqrt((v**2).sum(axis=2)) for v in (pair, where))
    distance = np.where(unmoved(claim, distance), 0.0, distance)
    first, stick, level, reach, last = claim.graphs.transpose(2, 0, 1)
    with np.errstate(invalid="ignore"):
        end = np.where(stick > 0.0, first * stick, 0.0)
    held = np.where(np.isinf(last), Act.PINNED, Act.STICK)
    below = size < level * (1.0 - BOUND.corner)
    steps = end < level * (1.0 - BOUND.corner)
    ways = (
        (np.isinf(stick), Act.STICK),
        ((level <= noise) & (size <= noise) & (distance < reach), Act.OPEN),
        ((level == 0.0) & (stick == 0.0) & (reach == 0.0), held),
        ((level == 0.0) & (size == 0.0), Act.OPEN),
        (steps & below & (stick == 0.0), Act.PINNED),
        (steps & below & (size > end), Act.STEP),
        ((distance < stick) & (stick > 0.0), Act.STICK),
        ((size <= end) & steps & (stick > 0.0), Act.STICK),
        ((distance < reach) & (distance > 0.0) & (level > 0.0), Act.SLIP),
        ((distance == 0.0) & (level > 0.0) & (stick == 0.0), Act.PINNED),
    )
    found = np.full(size.shape, Act.STOP)
    # The first condition that holds counts.
    for there, way in reversed(ways):
        found = np.where(there, way, found)
    return found.astype(np.int8)
