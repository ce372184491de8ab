"""Ranges of quantities along stretches of the parameter, including what lies between samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.settings import FOLLOW


@dataclass(frozen=True, slots=True, eq=False)
class RangeAlong:
    """A quantity along stretches, as a function of the fraction τ ∈ [0, 1]; shape (B, ...).

    Attributes
    ----------
    nodes : ndarray, shape (B, NODES, ...)
        Values along the chord.
    rate, spread : ndarray
        Its derivative with respect to τ lies within `spread` of `rate`.
    """

    nodes: Array
    rate: Array
    spread: Array

    @property
    def low(self) -> Array:
        """Lower bound along the chord."""
        return np.asarray(self.nodes.min(axis=1) - self.spread / (2.0 * (FOLLOW.nodes - 1)))

    @property
    def high(self) -> Array:
        """Upper bound along the chord."""
        return np.asarray(self.nodes.max(axis=1) + self.spread / (2.0 * (FOLLOW.nodes - 1)))

    @property
    def middle(self) -> Array:
        """Value in the middle."""
        return np.asarray(self.nodes[:, FOLLOW.nodes // 2])

    @property
    def off(self) -> Array:
        """Largest distance from the value in the middle."""
        return np.asarray(np.maximum(self.high - self.middle, self.middle - self.low))

    @property
    def most(self) -> Array:
        """Upper bound on the size: that in the middle and the largest distance from it."""
        return np.asarray(np.abs(self.middle) + self.off)

    def __getitem__(self, key: object) -> RangeAlong:
        """Return a part of the quantity."""
        whole = key if isinstance(key, tuple) else (key,)
        at_nodes = (slice(None), slice(None), *whole)
        inner = (slice(None), *whole)
        return RangeAlong(self.nodes[at_nodes], self.rate[inner], self.spread[inner])

    def __neg__(self) -> RangeAlong:
        return RangeAlong(-self.nodes, -self.rate, self.spread)

    def __sub__(self, other: RangeAlong) -> RangeAlong:
        return RangeAlong(
            self.nodes - other.nodes, self.rate - other.rate, self.spread + other.spread
        )


def sampled(nodes: Array) -> RangeAlong:
    """Enclose a smooth quantity known at the nodes (B, NODES, ...)."""
    slopes = (FOLLOW.nodes - 1) * np.diff(nodes, axis=1)
    low, high = slopes.min(axis=1), slopes.max(axis=1)
    noise = 4.0 * FOLLOW.nodes * np.finfo(float).eps * np.abs(nodes).max(axis=1)
    # Half the range is the spread that the samples show; as much again may lie between them.
    return RangeAlong(nodes, 0.5 * (low + high), (high - low) + noise)


@dataclass(frozen=True, slots=True, eq=False)
class Enclosure:
    """A quantity of the true branch: its range along the chord, and how far off that it may be.

    Attributes
    ----------
    chord : RangeAlong
    off, bend : ndarray, shape (B,)
        Largest distance from the chord, of the quantity and of its derivative.
    """

    chord: RangeAlong
    off: Array
    bend: Array

    def __neg__(self) -> Enclosure:
        return Enclosure(-self.chord, self.off, self.bend)

    def __sub__(self, other: Enclosure) -> Enclosure:
        return Enclosure(self.chord - other.chord, self.off + other.off, self.bend + other.bend)

    def clear(self, verge: float) -> Flags:
        """Return whether it is positive between the ends: off zero, or leaving it at one end."""
        chord = self.chord
        rises = chord.rate - chord.spread - self.bend > 0.0
        falls = chord.rate + chord.spread + self.bend < 0.0
        first, last = chord.nodes[:, 0] >= -verge, chord.nodes[:, -1] >= -verge
        return np.asarray((chord.low - self.off >= -verge) | (first & rises) | (last & falls))
