"""Stretches of one active set between solved points, and the quantities on which laws depend."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import FOLLOW
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.equations import Equations
from loadshare.study.follow.numbers import Numbers
from loadshare.study.follow.ranges import Enclosure, RangeAlong, sampled


class OffsetBounds(NamedTuple):
    """Bounds on an offset along stretches; every entry of shape (B,).

    Attributes
    ----------
    least : ndarray
        Lower bound of the radius.
    off : ndarray
        By how much the radius may differ from that in the middle.
    sagitta : ndarray
        By how much the radius may exceed the offset's part along the direction in the middle.
    turn : ndarray
        How far the direction may turn: largest ratio of the part across to that along.
    """

    least: Array
    off: Array
    sagitta: Array
    turn: Array

    @property
    def rise(self) -> Array:
        """By how much the unit vector's part along that in the middle may fall short of one."""
        return np.asarray(np.minimum(0.5 * self.turn**2, 2.0))


class Stretches:
    """Stretches of one set between solved points.

    Parameters
    ----------
    equations : Equations
    ends : ndarray, shape (B, 2, size)
        Unknowns at both ends.
    numbers : Numbers
        At NODES equidistant values of each stretch, one stretch after another.

    Attributes
    ----------
    width : int
        Number of quantities V z on which laws depend: approaches, then offsets of arcs and radial
        elements, then the unknowns themselves.
    inputs : ndarray, shape (B, width, size)
        V.
    frames : mapping of switch to ndarray, shape (B, k, k)
        Directions in which an offset is expressed: its own in the middle, then those across. A
        force along an offset is stiff along it and may be soft across; in other directions each
        component would count as both.
    """

    def __init__(self, equations: Equations, ends: Array, numbers: Numbers) -> None:
        e = self.equations = equations
        self.numbers, self.count = numbers, len(ends)
        tau = np.linspace(0.0, 1.0, FOLLOW.nodes)[:, None]
        chord = (1.0 - tau) * ends[:, :1] + tau * ends[:, 1:]
        self.flat = chord.reshape(-1, e.size)
        self.chord = sampled(chord)
        self.middle = np.arange(self.count) * FOLLOW.nodes + FOLLOW.nodes // 2
        self.at_middle = numbers.take(self.middle)
        self.vectors = self.own(self.at_middle.vectors)
        self.columns: dict[int, slice] = {}
        start = e.scalars
        for k in (*e.arcs, *e.radials):
            self.columns[k] = slice(start, start + (3 if k in e.arcs else 2))
            start = self.columns[k].stop
        self.z_in, self.width = start, start + e.size
        with np.errstate(all="ignore"):
            self.state = e.state(self.flat, numbers)
            self.approach = self.sampled(self.state.approach)
            polars = self.state.polars
            self.frames = {k: _framed(p.along[self.middle]) for k, p in polars.items()}
            self.offsets = {
                k: sampled(self.split(p.offset) @ self.frames[k].transpose(0, 2, 1))
                for k, p in polars.items()
            }
            self.radii = {k: p.radius[self.middle] for k, p in polars.items()}
        self.inputs = np.zeros((self.count, self.width, e.size))
        self.inputs[:, : e.scalars, : e.n] = self.vectors[:, : e.scalars]
        for k, columns in self.columns.items():
            self.inputs[:, columns, : e.n] = self.frames[k] @ e.matrix(k, self.at_middle)
        self.inputs[:, self.z_in :] = np.eye(e.size)

    @classmethod
    def at_points(cls, equations: Equations, z: Array, numbers: Numbers) -> Stretches:
        """Return stretches without length at points z (S, size)."""
        rows = np.repeat(np.arange(len(z)), FOLLOW.nodes)
        return cls(equations, np.stack([z, z], axis=1), numbers.take(rows))

    def split(self, values: Array) -> Array:
        """Return values of all nodes (B·NODES or 1, ...) as (B, NODES, ...)."""
        shape = (self.count * FOLLOW.nodes, *values.shape[1:])
        return np.broadcast_to(values, shape).reshape(self.count, FOLLOW.nodes, *values.shape[1:])

    def sampled(self, values: Array) -> RangeAlong:
        """Enclose a quantity known at all nodes (B·NODES or 1, ...)."""
        return sampled(self.split(values))

    def own(self, values: Array) -> Array:
        """Return values (B or 1, ...) of the middles for every stretch."""
        return np.broadcast_to(values, (self.count, *values.shape[1:]))

    def turning(self) -> list[tuple[int, int | None]]:
        """Return arcs and radial elements whose force turns, and where in z it is if unknown."""
        e = self.equations
        turning = (at.SLIP, at.STOP, at.WALL, at.CORNER)
        acting = e.polar_at.items()
        return [(k, w) for k, w in acting if k in e.arcs or int(e.states[k]) in turning]

    def around(self, k: int, dev: Array) -> OffsetBounds:
        """Bound an offset, and how far its direction may turn from that in the middle."""
        off = self.offsets[k].off + dev[:, self.columns[k]]
        least = self.radii[k] - off[:, 0]
        across = np.sqrt((off[:, 1:] ** 2).sum(axis=1))
        turn = np.where(least > 0.0, across / least, np.inf)
        sagitta = across * turn
        return OffsetBounds(np.where(least > 0.0, least, 0.0), off[:, 0] + sagitta, sagitta, turn)

    def felt(self, k: int, dev: Array, turn: Array) -> Array:
        """Bound by how much the deviation of an offset may change its radius."""
        part = dev[:, self.columns[k]]
        across = np.sqrt((part[:, 1:] ** 2).sum(axis=1))
        whole = np.sqrt((part * part).sum(axis=1))
        return np.asarray(np.fmin(part[:, 0] + turn * across, whole))

    def unknown(self, where: int, dev: Array, bend: Array) -> Enclosure:
        """Enclose an unknown."""
        inner = self.z_in + where
        return Enclosure(self.chord[where], dev[:, inner], bend[:, inner])


def _framed(along: Array) -> Array:
    """Return orthonormal directions (B, k, k) that begin with given ones (B, k) unless zero."""
    first = np.eye(along.shape[1])[0]
    ways = np.where(np.any(along, axis=1, keepdims=True), along, first)
    mirror = ways + np.where(ways[:, :1] < 0.0, -1.0, 1.0) * first
    dyad = mirror[:, :, None] * mirror[:, None, :]
    frames = np.eye(along.shape[1]) - 2.0 * dyad / (mirror**2).sum(axis=1)[:, None, None]
    frames[:, 0] = ways
    return np.asarray(frames)
