"""Radial laws: a force along an offset whose size is a monotone graph of the offset's size.

A clearance spline (formulation, section 5) and a round limit ring are both such graphs. A graph is
a chain of pieces that carry the same force and add their lengths; vertical steps lie between the
pieces. Written so, its energy is an inf-convolution and every piece is one second-order cone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from loadshare.array_library import library_of
from loadshare.array_types import Array
from loadshare.settings import LAWS


@dataclass(frozen=True, slots=True)
class Piece:
    """One rising or level piece of a graph.

    Parameters
    ----------
    force : float
        Force at its start [N].
    stiffness : float
        Its slope [N/m]; 0 for a level piece.
    length : float
        Its length in radius [m]; infinite for a last piece without end.
    name : str
        What an engineer calls it: "stick", "slip", "stop", "inside".
    """

    force: float
    stiffness: float
    length: float
    name: str

    @property
    def end_force(self) -> float:
        """Force at its end [N]."""
        return self.force if self.stiffness == 0.0 else self.force + self.stiffness * self.length


class GraphPart(NamedTuple):
    """A piece of a graph, or a step between two.

    Attributes
    ----------
    state : object
        State of an element that is on this part.
    begin, end : float
        Radii [m].
    low, high : float
        Forces at `begin` [N].
    slope : float
        [N/m].
    """

    state: Any
    begin: float
    end: float
    low: float
    high: float
    slope: float

    def off(self, radius: float, force: float) -> tuple[float, float]:
        """Return how far a radius [m] and a force [N] are from this part."""
        inner = min(max(radius, self.begin), self.end)
        rise = self.slope * (inner - self.begin) if self.slope else 0.0
        return radius - inner, force - min(max(force, self.low + rise), self.high + rise)


def nearest(parts: Iterable[GraphPart], radius: float, force: float) -> Any:
    """Return the state of the part of a graph nearest to a radius and a force without units."""
    return min(parts, key=lambda part: math.hypot(*part.off(radius, force))).state


@dataclass(frozen=True, slots=True)
class RadialLaw:
    """A monotone graph from radius [m] to force [N], as a chain of pieces.

    If the last piece is finite, the graph ends in a vertical step without end: a rigid stop.
    """

    pieces: tuple[Piece, ...]

    def start(self, piece: int) -> float:
        """Return the radius [m] at which a piece begins."""
        return math.fsum(p.length for p in self.pieces[:piece])

    @property
    def reach(self) -> float:
        """Largest admissible radius [m]; infinite without a rigid stop."""
        return self.start(len(self.pieces))

    @property
    def strength(self) -> float:
        """Largest force [N] that the graph admits; finite only where it ends in a level piece."""
        last = self.pieces[-1]
        return last.force if last.stiffness == 0.0 and math.isinf(last.length) else math.inf

    def step(self, corner: int) -> tuple[float, float]:
        """Return the force interval [N] of the step before piece `corner`, or of the final stop."""
        low = self.pieces[corner - 1].end_force if corner > 0 else 0.0
        high = self.pieces[corner].force if corner < len(self.pieces) else math.inf
        return low, high

    def parts(self) -> Iterator[GraphPart]:
        """Yield the pieces, then the steps between and after them, by number and kind."""
        for k, piece in enumerate(self.pieces):
            begin = self.start(k)
            force, end = piece.force, begin + piece.length
            yield GraphPart((k, False), begin, end, force, force, piece.stiffness)
        for k in range(len(self.pieces) + 1):
            low, high = self.step(k)
            if high > low:
                yield GraphPart((k, True), self.start(k), self.start(k), low, high, 0.0)

    def level(self, force: float, band: float) -> tuple[float, float] | None:
        """Return radii [m] between which a force acts, within `band` [N]; None if at one only."""
        at = [
            k
            for k, piece in enumerate(self.pieces)
            if piece.stiffness == 0.0 and piece.length > 0.0 and abs(force - piece.force) <= band
        ]
        return (self.start(at[0]), self.start(at[-1] + 1)) if at else None

    def least(self, radius: float) -> float:
        """Return the least force [N] that the graph admits at a radius [m]; past a stop, at it."""
        force, left = 0.0, radius
        for piece in self.pieces:
            if left <= 0.0:
                break
            force = piece.force + piece.stiffness * min(left, piece.length)
            left -= piece.length
        return force

    def energy(self, radius: float) -> float:
        """Return ∫F dR [J] up to `radius` [m], or to the rigid stop if that comes first."""
        total, left = 0.0, radius
        for piece in self.pieces:
            inner = min(left, piece.length)
            if inner <= 0.0:
                break
            total += piece.force * inner + 0.5 * piece.stiffness * inner**2
            left -= inner
        return total

    def scaled(self, force_unit: float, length_unit: float) -> RadialLaw:
        """Return the law with forces in `force_unit` [N] and lengths in `length_unit` [m]."""
        return RadialLaw(
            tuple(
                Piece(
                    p.force / force_unit,
                    p.stiffness * length_unit / force_unit,
                    p.length / length_unit,
                    p.name,
                )
                for p in self.pieces
            )
        )


def spline_law(
    bending_stiffness: float, stick_limit: float | None, clearance: float, friction: float
) -> RadialLaw:
    """Return the law of a clearance spline: stick, slip, stop (formulation, section 5).

    Parameters
    ----------
    bending_stiffness : float
        K_w of the spline shaft [N/m].
    stick_limit : float or None
        S1 [m]; None takes F_m/K_w, where stick passes into slip without a jump.
    clearance : float
        S2 [m], beyond which the shaft bends again.
    friction : float
        Friction bound F_m [N].

    Raises
    ------
    ValueError
        If K_w S1 > F_m, so that the force would drop (several equilibria), or if S2 < S1. The
        message names the numbers.
    """
    continuous = friction / bending_stiffness
    s1 = continuous if stick_limit is None else stick_limit
    if bending_stiffness * s1 > friction * (1.0 + LAWS.written):
        raise ValueError(
            f"the spline's force would drop from K_w S1 = {bending_stiffness * s1:.6g} N to "
            f"F_m = {friction:.6g} N where it starts to slip (K_w = {bending_stiffness:.6g} N/m, "
            f"S1 = {s1:.6g} m): several equilibria would be possible"
        )
    s1 = min(s1, continuous)
    if clearance < s1:
        if stick_limit is not None:
            raise ValueError(
                f"the spline's clearance S2 = {clearance:.6g} m is smaller than the radius "
                f"S1 = {s1:.6g} m where it starts to slip"
            )
        # The clearance closes before friction is overcome: the shaft bends throughout.
        return RadialLaw((Piece(0.0, bending_stiffness, math.inf, "stick"),))
    pieces = (
        Piece(0.0, bending_stiffness, s1, "stick"),
        Piece(friction, 0.0, clearance - s1, "slip"),
        Piece(friction, bending_stiffness, math.inf, "stop"),
    )
    return RadialLaw(tuple(p for p in pieces if p.length > 0.0))


def round_ring_law(radius: float, stiffness: float) -> RadialLaw:
    """Return a round ring's law: free inside `radius` [m], then rigid or of `stiffness` [N/m]."""
    free = Piece(0.0, 0.0, radius, "inside")
    if math.isinf(stiffness):
        return RadialLaw((free,))
    wall = Piece(0.0, stiffness, math.inf, "on boundary")
    return RadialLaw((free, wall) if radius > 0.0 else (wall,))


def tangent_wall(
    reach: Array, stiffness: Array, power: Array, radius: Array, faint: Array | float
) -> tuple[Array, Array]:
    """Return the tangent of a wall F = K (R − reach)^power: its start [m] and stiffness [N/m].

    Parameters
    ----------
    reach, stiffness, power : ndarray
        [m], K [N/m^power], above 1.
    radius : ndarray
        R at which the tangent touches [m].
    faint : float or ndarray
        Least force at the point of tangency [N]: without a force there is no stiffness.
    """
    xp = library_of(radius)
    gap = xp.maximum(radius - reach, (faint / stiffness) ** (1.0 / power))
    return reach + gap * (1.0 - 1.0 / power), power * stiffness * gap ** (power - 1.0)


@dataclass(frozen=True, slots=True)
class RollingLaw:
    """A bearing of balls (power 3/2) or rollers (10/9): F = K (R − clearance)^power.

    Parameters
    ----------
    clearance : float
        [m].
    stiffness : float
        K [N/m^power].
    power : float
        Above 1.
    faint : float
        Least force [N] at which a tangent is taken (see `tangent_wall`).
    """

    clearance: float
    stiffness: float
    power: float
    faint: float

    def touching(self, radius: float) -> RadialLaw:
        """Return the law whose wall is the tangent of this one at a radius [m]."""
        clearance, stiffness, power, at = map(
            np.asarray, (self.clearance, self.stiffness, self.power, radius)
        )
        begin, slope = tangent_wall(clearance, stiffness, power, at, self.faint)
        return round_ring_law(float(begin), float(slope))
