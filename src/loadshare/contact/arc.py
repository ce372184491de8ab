"""Exclusion arcs: where a body rolls on a neighbour (formulation, section 6)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.array_library import library_of
from loadshare.array_types import Array, floats


@dataclass(frozen=True, slots=True, eq=False)
class Arc:
    """The exclusion arc between a body and a neighbour: |d₀ + Δ| ≥ a − c_x.

    It holds on the side on which the body is mounted. Beyond the neighbour, where
    (d₀ + Δ)·nominal ≤ 0, it is continued by its face at rest, so that such a place is never free.

    Attributes
    ----------
    nominal : ndarray, shape (3,)
        From the neighbour's nominal centre to the body's [m]; its length is a.
    shift : ndarray, shape (3,)
        What errors add to it [m]: d₀ = nominal + shift.
    clearance : float
        c_x [m].
    """

    nominal: Array
    shift: Array
    clearance: float

    def __post_init__(self) -> None:
        for name in ("nominal", "shift"):
            object.__setattr__(self, name, floats(getattr(self, name)))

    @property
    def distance(self) -> float:
        """a, the nominal centre distance [m]."""
        return math.sqrt(float(self.nominal @ self.nominal))

    @property
    def start(self) -> Array:
        """d₀ [m]."""
        return np.asarray(self.nominal + self.shift)

    def normal(self, relative: Array) -> Array:
        """Return the unit outward push on the body at the relative displacement Δ (3,) [m]."""
        d = self.nominal if self.beyond(relative) else self.start + relative
        return d / math.sqrt(float(d @ d))

    def beyond(self, relative: Array) -> bool:
        """Return whether Δ (3,) [m] leads past the neighbour, where no body can be."""
        return not float(self.nominal @ (self.start + relative)) > 0.0

    def margin(self, relative: Array) -> float:
        """Return the distance beyond the arc [m], |d₀ + Δ| − a + c_x, accurate for small Δ.

        At rest and without errors it is the clearance, to the last digit.
        """
        moved = self.shift + relative
        if self.beyond(relative):
            return float(self.nominal @ moved) / self.distance + self.clearance
        return float(rolled(self.nominal, moved)[2]) + self.clearance

    def face(self, relative: Array) -> tuple[Array, float]:
        """Return the tangent half-plane at Δ: unit normal n (3,) and bound g [m] of n·Δ ≥ −g."""
        n = self.normal(relative)
        return n, self.margin(relative) - float(n @ relative)


def rolled(nominal: Array, moved: Array) -> tuple[Array, Array, Array]:
    """Return vectors between centres, their lengths, and the growth of these without cancellation.

    Parameters
    ----------
    nominal, moved : ndarray, shape (…, 3)
        Vector at rest, and the displacement added to it [m].
    """
    xp = library_of(moved)
    d = nominal + moved
    length, before = xp.sqrt(xp.sum(d * d, axis=-1)), xp.sqrt(xp.sum(nominal * nominal, axis=-1))
    grown = 2.0 * xp.sum(moved * nominal, axis=-1) + xp.sum(moved * moved, axis=-1)
    return d, length, grown / (length + before)
