"""Where rows and radial elements stand, as the numbers in the code of a set.

A radial law is a chain of at most three pieces (:mod:`loadshare.contact.radial`), told by five
numbers: it rises with `first` up to `stick`, jumps to `bound`, stays level up to `reach`, and rises
with `last` beyond. A round ring has first = stick = bound = 0; a rigid one has an infinite `last`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.contact.radial import ROUNDING as WRITTEN
from loadshare.scene.scene import Array

OPEN = 0
"""A row without contact; a radial element that moves freely and carries nothing."""
CLOSED = 1
"""A row in contact."""
STICK, CORNER, PINNED, SLIP, STOP, WALL = 1, 2, 3, 4, 5, 6
"""Radial: on the first rise; on the jump at S1; on a jump at the centre; level; on the last rise;
against a rigid stop."""

PASSES = 60
"""Newton passes on one set."""
SWING, DAMPED = 15, 5
"""Of so many passes the last few go half the way; sets that settle at all mostly do in ten."""
SETTLED = 1e-14
"""Change of forces and coordinates between passes, relative to the largest, that ends them."""
STALLED = 1e-11
"""The same for passes that no longer improve."""
LAW = 1e-13
"""Misfit of a law, relative to the largest compression, that ends the passes."""
CREEP = 1e-8
"""Change from pass to pass below which what does not settle is left to the certificate."""
PROXIMAL = 1e-8
"""Term, relative to the largest entry, that makes a singular matrix of redundants definite."""
SHARED = 1e-9
"""Part of a redundant in the elements that yield below which only rigid ones take part."""
NOISE = 1e-13
"""Distance between rigid elements, over the lengths at hand, that is round-off."""
REFINEMENTS = 4
"""Refinements of a solution with it."""
SMALL = 1e-15
"""Pivot, over the largest, that counts as none."""
REFINED = 1e-9
"""Residual, relative to the largest redundant, from which on a matrix counts as singular."""
HURRY = 1e-3
"""Violation of a sign, relative to the largest quantity of its sort, that no later pass mends."""
NEARLY = 1e-2
"""Misfit of the laws, relative, from which on signs are looked at before passes settle."""
SIGN = 1e-12
"""Violation of a sign, relative to the largest quantity of its sort, that counts as round-off."""
FLOOR = 1e-6
"""Smallest cube root of a force at which a tangent is taken, relative to the load's."""
SHRINK = 0.46
"""Factor on the cube root of the force of a flank that is not compressed."""
PATIENCE = 6
"""Passes after which a flank that stays uncompressed is taken for open."""

OUTSIDE = 2
"""Passes after which a radial element that stays beyond its level piece has left it."""
BEYOND = 1.01
"""Radius over S2 from which on it does."""
BURST = 1e6
"""Force over the load from which on rigid contacts contradict one another."""
SOFTEST = 1e8
"""Largest compliance of a radial element across its offset."""
FAR = 1e3
"""Way from where proximal passes ended, over how far they went, that only a drift explains."""
FAINT = 1e-12
"""Friction bound, over the load, at which a slipping element is held at least across its slip."""
DRIFT = 1e-12
"""Share of the load along a loose move from which on it counts."""

DONE, OTHER, FAILED = 0, 1, 2
"""Verdicts on a set: consistent; another set is proposed; no answer on this set."""


class Graph(NamedTuple):
    """Five numbers of radial laws, each of shape (S,)."""

    first: Array
    stick: Array
    bound: Array
    reach: Array
    last: Array
    valid: np.ndarray


def graph(numbers: Array, torque: Array) -> Graph:
    """Return the radial laws of one element.

    Parameters
    ----------
    numbers : ndarray, shape (S or 1, 6)
        See :class:`loadshare.scene.elements.Data`.
    torque : ndarray, shape (S,)
        Torque over force unit [m] that the element transmits.

    Returns
    -------
    Graph
        ``valid`` is false where the law would drop or S2 lies inside S1: such a sample is refused
        with a message by the next rung.
    """
    first, given, reach, fixed, per_torque, last = (numbers[:, k] for k in range(6))
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = np.where(np.isnan(fixed), per_torque * np.abs(torque), fixed)
        continuous = np.where(first > 0.0, bound / first, 0.0)
    stick = np.where(np.isnan(given), continuous, np.minimum(given, continuous))
    asked = np.where(np.isnan(given), 0.0, given)
    valid = (first * asked <= bound * (1.0 + WRITTEN)) & (np.isnan(given) | (reach >= stick))
    throughout = (reach < stick) & np.isnan(given)
    stick = np.where(throughout, np.inf, stick)
    found = (first, stick, bound, reach, last, valid)
    if any(v.shape != torque.shape for v in found):
        return Graph(*(np.broadcast_to(v, torque.shape) for v in found))
    return Graph(*found)
