"""Contact states: whether a row is closed, and on which piece of its graph a radial element is.

An active set is one such number for every row and every radial element.

A radial law is a chain of at most three pieces (:mod:`loadshare.contact.radial`), given by five
numbers: it rises with `first` up to `stick`, jumps to `bound`, stays level up to `reach`, and rises
with `last` beyond. A round ring has first = stick = bound = 0; a rigid one has an infinite `last`.
A last piece that is a power law is replaced by its tangent at the element's radius.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from loadshare.array_library import library_of
from loadshare.array_types import Array
from loadshare.contact.radial import tangent_wall
from loadshare.settings import LAWS

OPEN = 0
"""A row without contact; a radial element that moves freely and carries nothing."""
CLOSED = 1
"""A row in contact."""
STICK, CORNER, PINNED, SLIP, STOP, WALL = 1, 2, 3, 4, 5, 6
"""States of a radial element: on the first rise; on the jump at S1; on a jump at the centre; level;
on the last rise; against a rigid stop."""

FREE, LEVEL, HELD = 0, 1, 2
"""What the force of a radial element determines of its offset: nothing; the direction, on a level
piece; radius and direction."""

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


def graph(numbers: Array, torque: Array, radius: Array | float = 0.0) -> Graph:
    """Return the radial laws of one element.

    Parameters
    ----------
    numbers : ndarray, shape (S or 1, 8)
        See :class:`loadshare.scene.loading.Loading`.
    torque : ndarray, shape (S,)
        Torque over force unit [m] that the element transmits.
    radius : ndarray, shape (S,), or float
        Radius at which the element is, over the length unit.

    Returns
    -------
    Graph
        ``valid`` is false where the law would drop or S2 lies inside S1: such a sample is refused
        with a message by the next rung.
    """
    xp = library_of(torque)
    first, given, reach, fixed, per_torque, last, power = (numbers[:, k] for k in range(7))
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = xp.where(xp.isnan(fixed), per_torque * xp.abs(torque), fixed)
        continuous = xp.where(first > 0.0, bound / first, 0.0)
    stick = xp.where(xp.isnan(given), continuous, xp.minimum(given, continuous))
    given_or_zero = xp.where(xp.isnan(given), 0.0, given)
    valid = (first * given_or_zero <= bound * (1.0 + LAWS.written)) & (
        xp.isnan(given) | (reach >= stick)
    )
    throughout = (reach < stick) & xp.isnan(given)
    stick = xp.where(throughout, math.inf, stick)
    if xp.any(power != 1.0):
        # The tangent is not used where the law is not a power, such as friction without a stop.
        with np.errstate(invalid="ignore"):
            begin, slope = tangent_wall(
                reach, last, power, radius + xp.zeros_like(reach), numbers[:, 7]
            )
        reach, last = (xp.where(power != 1.0, v, w) for v, w in ((begin, reach), (slope, last)))
    found = (first, stick, bound, reach, last, valid)
    if any(v.shape != torque.shape for v in found):
        return Graph(*(xp.broadcast_to(v, torque.shape) for v in found))
    return Graph(*found)


def reached(numbers: Array, size: Array) -> Array:
    """Return the radii at which the last pieces of radial laws carry forces of given sizes.

    Parameters
    ----------
    numbers : ndarray, shape (k, 8)
    size : ndarray, shape (k,)
    """
    return np.asarray(numbers[:, 2] + (size / numbers[:, 5]) ** (1.0 / numbers[:, 6]))
