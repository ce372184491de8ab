"""An answer in physical terms: what a solver claims, and what the certificate judges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from loadshare.train.gear import Vector


@dataclass(frozen=True, slots=True, eq=False)
class Equilibrium:
    """Displacements and forces of a train at one position.

    Attributes
    ----------
    index : int
        1-based position.
    rotation : mapping of gear to float
        φ [rad], positive in the running sense.
    displacement : mapping of gear to ndarray, shape (3,)
        p [m], for every gear.
    flank_force : mapping of flank to float
        F [N] of every flank that can touch, by flank name.
    ring_force : mapping of contact to float
        Force [N] of every arc and stop, ≥ 0.
    radial_reaction : mapping of element to ndarray, shape (3,)
        Force [N] of every spline and round ring on its gear.
    undetermined : tuple of str
        Coordinates that the equilibrium does not determine; the least-norm displacement is given.
    """

    index: int
    rotation: Mapping[str, float]
    displacement: Mapping[str, Vector]
    flank_force: Mapping[str, float]
    ring_force: Mapping[str, float]
    radial_reaction: Mapping[str, Vector]
    undetermined: tuple[str, ...] = ()
