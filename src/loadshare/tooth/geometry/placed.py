"""What the solid teeth of all gears have in common: a gear, and where it stands."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.placement import Placement, fixed


class Toothed(Protocol):
    """A gear of any kind."""

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        ...

    @property
    def youngs_modulus(self) -> float:
        """Modulus of elasticity [Pa]."""
        ...

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""
        ...


G = TypeVar("G", bound=Toothed)


@dataclass(frozen=True)
class PlacedTooth(Generic[G]):
    """Those parts of a `ToothBody` that do not depend on the kind of gear.

    Parameters
    ----------
    gear : HelicoidGear or FaceGear
        The gear.
    placement : Placement
        Where it stands.
    foot : float
        The u at which the fillet ends.
    """

    gear: G
    placement: Placement = field(default_factory=fixed)
    foot: float = 0.4

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return self.gear.teeth

    @property
    def youngs_modulus(self) -> float:
        """Modulus of elasticity [Pa]."""
        return self.gear.youngs_modulus

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""
        return self.gear.poisson

    def to_body(self, points: Array, rotation: Array | float) -> Array:
        """Carry points (..., 3) from the fixed frame to the gear turned by `rotation` [rad]."""
        return self.placement.to_body(points, rotation)

    def to_space(self, points: Array, rotation: Array | float) -> Array:
        """Carry points (..., 3) from the gear turned by `rotation` [rad] to the fixed frame."""
        return self.placement.to_space(points, rotation)
