"""Measurements on the machine: shares or torques, and their uncertainties."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from loadshare.case.element import Count, Element, Number, Positive, Rule, Text
from loadshare.case.quantity import TORQUE, Quantity, Torque

COEFFICIENTS = ("share", "pair_share", "omega", "pair_omega")


class Measurement(Element):
    """Measured figures, to be compared with computed ones."""

    position: Count | None = None
    """Position of the figures [-]; when left out: the mean of all, for omega the largest."""

    torque: dict[str, Torque] | None = None
    """Torques on the drivers, by mesh [torque]."""

    torque_uncertainty: Annotated[Quantity, TORQUE.bounded(above=0)] | None = None
    """Standard deviation of each torque [torque]."""

    share: dict[str, Number] | None = None
    """Load-sharing coefficients over the mean of the stage, by mesh [-]."""

    pair_share: dict[str, Number] | None = None
    """Load-sharing coefficients over the mean of the group, by mesh [-]."""

    omega: dict[str, Number] | None = None
    """Largest share of a stage, by stage, or of the system [-]."""

    pair_omega: dict[str, Number] | None = None
    """Largest pair share of a stage, by stage, or of the system [-]."""

    uncertainty: Positive | None = None
    """Standard deviation of each coefficient [-]."""

    source: Text = ""
    """Where the figures come from."""

    def rules(self) -> Iterator[Rule]:
        """Yield missing figures and uncertainties."""
        given = [key for key in COEFFICIENTS if getattr(self, key)]
        if not given and not self.torque:
            yield Rule("contains no measured value", allowed=", ".join(("torque", *COEFFICIENTS)))
        if self.torque and self.torque_uncertainty is None:
            yield Rule.required("torque_uncertainty", "torque", TORQUE.allowed)
        if given and self.uncertainty is None:
            yield Rule.required("uncertainty", given[0], "a number above 0")
