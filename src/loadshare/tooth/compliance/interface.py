"""Interface of all models of a gear's compliance."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from loadshare.tooth.compliance.middle import Foot
from loadshare.tooth.compliance.sheet import Sheet
from loadshare.tooth.geometry.body import Array


@dataclass(frozen=True, slots=True, eq=False)
class Flank:
    """Points on the loaded flank of one tooth.

    Attributes
    ----------
    tooth : int
        Number of the tooth.
    uw : array (n, 2)
        Flank coordinates of the points.
    """

    tooth: int
    uw: Array


class Compliance(ABC):
    """Compliance of one gear without the neighbourhood of its contacts.

    A force on a flank point acts along the flank's normal, into the tooth. Its displacement is read
    where that normal meets the middle surface of the tooth, at the depth h: there the field of a
    concentrated force is smooth, so the result does not depend on how finely the flank is divided.
    The compression between flank and middle surface belongs to the contact law
    (:mod:`loadshare.tooth.contact.strips`). This is Weber and Banaschek's division.
    """

    _flank: Sheet
    """Points of the flank that were loaded, with the interpolation between them."""
    _feet: Foot
    """Where their normals meet the middle surface."""

    def bulk(self, flanks: tuple[Flank, ...]) -> Array:
        """Return the compliance (N, N) [m/N] between all points of all flanks, in order; symmetric.

        Entry (i, j) is the displacement of the middle surface under point i, along the inward
        normal there, for a unit force on point j.
        """
        return self.bulks((flanks,))[0]

    @abstractmethod
    def bulks(self, positions: Sequence[tuple[Flank, ...]]) -> list[Array]:
        """Return `bulk` for the flanks of every position."""

    def depth(self, uw: Array) -> Array:
        """Return depths (n,) [m] of the middle surface along the normals of flank points (n, 2)."""
        return np.asarray(self._flank.weights(uw) @ self._feet.depth)
