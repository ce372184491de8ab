"""An answer in physical terms, as a solver claims it and the certificate judges it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from loadshare.equality import Comparable
from loadshare.train.gear import Vector

Range = tuple[float, float]
"""Least and largest value."""


@dataclass(frozen=True, slots=True, eq=False)
class Equilibrium(Comparable):
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
    shaft_torque : mapping of shaft to float
        Torque [N·m] of elastic shafts from the first gear to the second; that of a shaft that is
        not named follows from its wind-up. A claimed torque stays exact where a stiff shaft's
        wind-up is lost in the digits of the rotations.
    support_force : mapping of gear to ndarray, shape (2,)
        Force [N] on elastic bearings, in the gear's transverse frame; that of a gear that is not
        named follows from its displacement.
    undetermined : mapping of coordinate to (float, float)
        Coordinates that the forces do not determine, as "gear 4 x" or "gear 4 rotation", with the
        least and the largest value that each may take [m, rad], infinite without a limit. The
        values claimed above are those of least norm.
    """

    index: int
    rotation: Mapping[str, float]
    displacement: Mapping[str, Vector]
    flank_force: Mapping[str, float]
    ring_force: Mapping[str, float]
    radial_reaction: Mapping[str, Vector]
    undetermined: Mapping[str, Range] = field(default_factory=dict)
    shaft_torque: Mapping[str, float] = field(default_factory=dict)
    support_force: Mapping[str, Vector] = field(default_factory=dict)
