"""What the rest of the analysis needs to know of one gear's solid tooth."""

from __future__ import annotations

from typing import Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.float64]


class ToothBody(Protocol):
    """One gear's solid tooth, in the gear's own frame.

    The gear's axis is z, and tooth 0 is centred on +x: at the middle of the face width for a
    cylindrical gear; a face gear's teeth point to +z. Tooth k is tooth 0 turned by 2πk/`teeth`
    about z. Side +1 is the flank that leads when the gear turns by a positive angle, side −1 the
    one that trails.
    """

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        ...

    @property
    def shape(self) -> Literal["external", "internal", "face"]:
        """Kind of gear body."""
        ...

    @property
    def rim(self) -> float:
        """Inner radius (external), outer radius (internal), thickness below root (face) [m]."""
        ...

    @property
    def youngs_modulus(self) -> float:
        """Modulus of elasticity [Pa]."""
        ...

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""
        ...

    @property
    def foot(self) -> float:
        """The u at which the fillet ends and the flank begins."""
        ...

    def outline(self, u: ArrayLike, w: ArrayLike, side: int) -> Array:
        """Boundary of half of tooth 0 at a width station.

        Parameters
        ----------
        u : array_like
            0 in the middle of the root space, `foot` at the end of the fillet, 1 at the tip
            corner. The curve is smooth on either side of `foot`.
        w : array_like
            Width station, 0 to 1; broadcast against `u`.
        side : {+1, −1}
            Which half.

        Returns
        -------
        array (..., 3)
            Points [m].
        """
        ...

    def locate(self, points: Array) -> tuple[Array, Array]:
        """Flank coordinates (u, w) of points on the flanks of any tooth, gear frame.

        Parameters
        ----------
        points : array (..., 3)
            Points [m]. What does not lie on a flank is projected.

        Returns
        -------
        u, w : array (...)
            Not clipped: a point beyond the tip has u > 1.
        """
        ...

    def to_body(self, points: Array, rotation: Array | float) -> Array:
        """Carry points (..., 3) from the fixed frame to the gear turned by `rotation` [rad]."""
        ...

    def to_space(self, points: Array, rotation: Array | float) -> Array:
        """Carry points (..., 3) from the gear turned by `rotation` [rad] to the fixed frame."""
        ...
