"""Errors of gears: each moves a centre without costing energy."""

from __future__ import annotations

from typing import Annotated

from pydantic import Tag

from loadshare.case.element import TABLE, Element, shaped
from loadshare.case.gears import Components
from loadshare.case.quantity import Angle, Distance, Length, Quantity


class Offset(Element):
    """An installation error given by size and direction."""

    amount: Distance
    """Size of the offset [length]."""

    direction: Angle
    """Direction of the offset, counter-clockwise from the x axis [angle].

    Seen with the gear's axis pointing at the viewer.
    """


class Eccentricity(Element):
    """A manufacturing error: the offset of the base circle, which turns with the gear."""

    amount: Distance
    """Size of the offset [length]."""

    direction: Angle = Quantity("0 deg", 0.0)
    """Direction of the offset on the gear [angle]."""

    phase: Angle = Quantity("0 deg", 0.0)
    """Angle added to the direction at the first position [angle]."""


class Pin(Element):
    """The position error of a planet's pin, relative to the carrier's axis."""

    radial: Length = Quantity("0 um", 0.0)
    """Radial error, positive outwards [length]."""

    tangential: Length = Quantity("0 um", 0.0)
    """Tangential error, positive counter-clockwise about the carrier's axis [length]."""

    angular: Angle = Quantity("0 rad", 0.0)
    """Angular error about the carrier's axis, positive counter-clockwise [angle]."""


class Errors(Element):
    """The errors of one gear; each displaces its centre without elastic energy."""

    installation: (
        Annotated[
            Components | Annotated[Offset, Tag(TABLE)],
            shaped("a list of 2 or 3 lengths, or a table of amount and direction"),
        ]
        | None
    ) = None
    """Fixed offset of the centre [length]: components along x, y and z, or size and direction in
    the gear's plane.

    It is fixed in the housing, or for a planet on its carrier.
    """

    pin: Pin | None = None
    """Position error of a planet's pin: radial, tangential [length] or angular [angle]."""

    eccentricity: Eccentricity | None = None
    """Offset that turns with the gear: amount [length], direction and phase [angle]."""
