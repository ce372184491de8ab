"""Loads for sizing: forces of meshes, torques of shafts, forces on bearings and mounts.

Also how a train yields: transmission error and stiffness of the train and of its meshes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

from loadshare.equality import Comparable
from loadshare.results.figures import Figures

Pair = tuple[float, float]
Value = TypeVar("Value")


@dataclass(frozen=True, eq=False)
class _OfAnswer(Comparable):
    """Figures of one answer, by name.

    Attributes
    ----------
    figures : Figures
        Of this answer and others.
    row : int
        Its number among them.
    """

    figures: Figures
    row: int

    def _said(self) -> dict[str, Any]:
        """Return what it says by name: the other answers of `figures` do not count."""
        return {name: getattr(self, name) for name in vars(type(self)) if name[0] != "_"}


class Loads(_OfAnswer):
    """The loads of one answer, by name; `Figures` says what each is."""

    @property
    def meshes(self) -> dict[str, float]:
        """Force of every mesh along its line of action, drive flank less coast flank [N]."""
        return self.figures.by_name(self.row, "mesh_force", "mesh")

    @property
    def shafts(self) -> dict[str, float]:
        """Torque of every shaft from its first gear to its second [N·m], of rigid ones as well."""
        return self.figures.by_name(self.row, "shaft_torque", "shaft")

    @property
    def gears(self) -> dict[str, float]:
        """External torque on every gear [N·m], counter-clockwise about its axis.

        Loads, and on the output and on held gears the torque that balances all others.
        """
        return self._of_bodies(self.figures.by_name(self.row, "gear_torque", "gear"))

    @property
    def bearings(self) -> dict[str, Pair]:
        """Force of every gear on its bearing, of a planet on its pin [N], in its frame.

        Supports and bearings with clearance together, without splines and rings.
        """
        force = self.figures.bearing_force[self.row]
        found = zip(self.figures.train.gears, force.tolist(), strict=True)
        return self._of_bodies({name: (x, y) for name, (x, y) in found})

    def _of_bodies(self, found: dict[str, Value]) -> dict[str, Value]:
        """Return figures without those of the harmonics of rims."""
        gears = self.figures.train.gears
        return {name: value for name, value in found.items() if gears[name].rim_of is None}


class Elastic(_OfAnswer):
    """Transmission errors and tangent stiffnesses of one answer; `Figures` says what each is.

    Gaps, errors and displacements of the gears count, as well as the deflection of teeth and
    shafts. Where forces leave a rotation open, the errors are those of the least one.
    """

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
        """The same as torque per angle at the gear that the mesh names first [N·m/rad]."""
        return self.figures.by_name(self.row, "mesh_torsional_stiffness", "mesh")
