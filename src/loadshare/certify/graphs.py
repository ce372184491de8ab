"""Graphs of radial elements (formulation, section 5).

Where `contact.radial` has a chain of pieces, a graph here has five figures, so that the same few
lines judge all elements of all samples.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.settings import LAWS


class Graph(NamedTuple):
    """Force over radius of Q elements in S samples: a rise, a level, and a rise or a stop.

    Attributes
    ----------
    first : ndarray, shape (Q, S)
        Slope of the first rise [N/m].
    stick : ndarray, shape (Q, S)
        Radius where it ends [m]; infinite where it never ends.
    bound : ndarray, shape (Q, S)
        Force of the level [N].
    reach : ndarray, shape (Q, S)
        Radius where the level ends [m].
    last : ndarray, shape (Q, S)
        Slope from there on [N/m]; infinite for a rigid stop.
    """

    first: Array
    stick: Array
    bound: Array
    reach: Array
    last: Array


def wall(reach: Array, stiffness: Array, power: Array, radius: Array) -> tuple[Array, Array]:
    """Return where the tangent of a wall F = K (R − reach)^power begins [m], and its slope [N/m].

    Inside the reach, it is the tangent of a wall that is barely pressed.

    Parameters
    ----------
    reach, stiffness, power : ndarray
        [m], K [N/m^power], [-].
    radius : ndarray
        R where it touches [m].
    """
    bent = power != 1.0
    least = np.where(reach > 0.0, reach, 1.0) * np.finfo(float).eps
    gap = np.where(bent, np.maximum(radius - reach, least), 1.0)
    begin = np.where(bent, reach + gap * (1.0 - 1.0 / power), reach)
    return begin, np.where(bent, power * stiffness * gap ** (power - 1.0), stiffness)


def spline_graphs(numbers: Array, torque: Array, *, memory: bool) -> tuple[list[Graph], Flags]:
    """Return the graphs of splines that transmit torques [N·m], and which splines have none.

    With memory they are those of friction and of the stop at the end of the slip; then no step is
    allowed where a spline starts to slip.

    Parameters
    ----------
    numbers : ndarray, shape (5, …)
        As `Situations` has them.
    torque : ndarray, shape (…)
    memory : bool
    """
    stiffness, given, reach, fixed, per_torque = numbers
    bound = np.where(np.isnan(fixed), per_torque * np.abs(torque), fixed)
    continuous, free = bound / stiffness, np.isnan(given)
    stick = np.fmin(given, continuous)
    lawless = stiffness * given > bound * (1.0 + LAWS.written)
    lawless |= ~free & (reach < stick)
    if not memory:
        stick = np.where((reach < stick) & free, np.inf, stick)
        return [Graph(stiffness, stick, bound, reach, stiffness)], lawless
    lawless |= stiffness * given < bound * (1.0 - LAWS.written)
    zero, endless = np.zeros_like(bound), np.full_like(bound, np.inf)
    room = np.maximum(reach - continuous, 0.0)
    friction = Graph(zero, zero, bound, endless, endless)
    return [friction, Graph(zero, zero, zero, room, endless)], lawless


def interval(graph: Graph, radius: Array, band: Array) -> tuple[Array, Array]:
    """Return the least and largest forces [N] that graphs admit within a band [m] of radii [m]."""
    first, stick, bound, reach, last = graph
    throughout = np.isinf(stick)
    low, high = np.full(radius.shape, np.inf), np.zeros(radius.shape)
    level_end = np.maximum(reach, np.where(throughout, 0.0, stick))
    inner, outer = radius - band, radius + band
    pieces = (
        (0.0, stick, 0.0, first, stick > 0.0),
        (stick, level_end, bound, 0.0, level_end > stick),
        (level_end, np.inf, bound, last, np.isfinite(last) & ~throughout),
    )
    for begin, end, force, slope, there in pieces:
        on = there & (outer >= begin) & (inner <= end)
        rising = np.where(slope > 0.0, slope, 0.0)
        least, most = (np.clip(place, begin, end) - begin for place in (inner, outer))
        low = np.where(on, np.minimum(low, force + rising * least), low)
        high = np.where(on, np.maximum(high, force + rising * most), high)
    low = np.where(radius <= band, 0.0, low)
    stopped = np.isinf(last) & (radius >= reach - band)
    low = np.where(stopped, np.minimum(low, bound), low)
    high = np.where(stopped, np.inf, high)
    return low, high


def strength(graph: Graph) -> Array:
    """Return the largest force [N] that graphs admit: finite only where they end in a level."""
    return np.where(np.isinf(graph.reach) & np.isinf(graph.last), graph.bound, np.inf)


def energy(graph: Graph, radius: Array) -> Array:
    """Return the strain energy [J] of graphs at radii [m]."""
    first, stick, bound, reach, last = graph
    rise = np.minimum(radius, stick)
    throughout = np.isinf(stick)
    level = np.where(throughout, 0.0, np.clip(radius, stick, reach) - stick)
    beyond = np.where(throughout, 0.0, np.maximum(radius - reach, 0.0))
    rising = np.isfinite(last) & (beyond > 0.0)
    tail = np.where(rising, bound * beyond + 0.5 * np.where(rising, last, 0.0) * beyond**2, 0.0)
    return np.asarray(0.5 * first * rise**2 + bound * np.where(level > 0.0, level, 0.0) + tail)


def complementary(graph: Graph, force: Array) -> Array:
    """Return the conjugate energy [J] of graphs at forces [N]."""
    first, stick, bound, reach, last = graph
    throughout = np.isinf(stick)
    has_rise = first > 0.0
    stiff = np.where(has_rise, first, 1.0)
    end = np.where(throughout, np.inf, first * stick)
    under = np.minimum(force, end)
    total = np.where(has_rise, under**2 / (2.0 * stiff), 0.0)
    rest = np.where(throughout, 0.0, np.maximum(force - end, 0.0))
    total += np.where(rest > 0.0, rest * np.where(throughout, 0.0, stick), 0.0)
    over = np.where(throughout, 0.0, np.maximum(force - bound, 0.0))
    total += np.where(over > 0.0, over * (reach - np.where(throughout, 0.0, stick)), 0.0)
    rising = np.isfinite(last)
    tail = np.where(rising, over**2 / (2.0 * np.where(rising, last, 1.0)), 0.0)
    return np.asarray(total + tail)
