"""What makes a branch dimensionless."""

from __future__ import annotations

from typing import NamedTuple

from loadshare.scene.scene import Scene


class Units(NamedTuple):
    """Force [N] and length [m] that a branch is measured by."""

    force: float
    length: float

    @classmethod
    def of(cls, scene: Scene) -> Units:
        """Units of a scene."""
        return cls(scene.force_unit(), scene.length_unit())
