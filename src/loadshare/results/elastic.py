"""How a train yields: transmission error of train and meshes, stiffness of both."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.results.figures import Figures


@dataclass(frozen=True)
class Elastic:
    """Transmission errors and tangent stiffnesses of one answer; `Figures` says what each is.

    Gaps, errors and displacements of the gears count as well as what teeth and shafts yield. Where
    forces leave a rotation open, the errors are those of the least one.

    Attributes
    ----------
    figures : Figures
        Of the answer among others.
    row : int
        Its number among them.
    """

    figures: Figures
    row: int

    @property
    def transmission_error(self) -> dict[str, float]:
        """Loaded transmission error of the train [rad], by "input" and "output"."""
        return self.figures.by_name(self.row, "transmission_error", "side")

    @property
    def torsional_stiffness(self) -> dict[str, float]:
        """Tangent stiffness dT/dφ of the train [N·m/rad], by "input" and "output"."""
        return self.figures.by_name(self.row, "torsional_stiffness", "side")

    @property
    def mesh_transmission_error(self) -> dict[str, float]:
        """Loaded transmission error of every mesh along its line of action [m]."""
        return self.figures.by_name(self.row, "mesh_transmission_error", "mesh")

    @property
    def mesh_stiffness(self) -> dict[str, float]:
        """Tangent stiffness of every mesh along its line of action, at its force [N/m]."""
        return self.figures.by_name(self.row, "mesh_stiffness", "mesh")

    @property
    def mesh_torsional_stiffness(self) -> dict[str, float]:
        """The same as torque by angle at the gear that the mesh names first [N·m/rad]."""
        return self.figures.by_name(self.row, "mesh_torsional_stiffness", "mesh")
