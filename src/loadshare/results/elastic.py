"""How a train yields: transmission error of train and meshes, stiffness of both."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from loadshare.certify.bound.tangent import Tangent, tangent_of
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train


@dataclass(frozen=True)
class Elastic:
    """Transmission errors and tangent stiffnesses of one answer.

    Gaps, errors and displacements of the gears count as well as what teeth and shafts yield. Where
    forces leave a rotation open, the errors are those of the least one.

    Attributes
    ----------
    train : Train
    answer : Equilibrium
    """

    train: Train
    answer: Equilibrium

    @cached_property
    def _tangent(self) -> Tangent:
        return tangent_of(self.train, self.answer)

    @cached_property
    def transmission_error(self) -> dict[str, float]:
        """Loaded transmission error of the train [rad], by "input" and "output".

        How far the input turns beyond what its ratio to the output says; positive in its running
        sense, in which the output lags behind. Referred to the output it is smaller by the ratio of
        the speeds.
        """
        ahead = self.answer.rotation[self.train.input]
        return {"input": ahead, "output": ahead * self._ratio}

    @cached_property
    def torsional_stiffness(self) -> dict[str, float]:
        """Tangent stiffness dT/dφ of the train [N·m/rad], referred to "input" and to "output".

        Of the torque on the input by its rotation, the output held. What carries is taken to go on
        carrying, what slips to go on slipping. 0 where nothing resists.
        """
        stiffness = self._tangent.torsion(self.train.input)
        ratio = self._ratio**2
        return {"input": stiffness, "output": stiffness / ratio if ratio else 0.0}

    @cached_property
    def mesh_transmission_error(self) -> dict[str, float]:
        """Loaded transmission error of every mesh along its line of action [m].

        How far the base circle of the gear that drives runs ahead of the other's, seen from their
        carrier: r₁φ₁ − r₂φ₂.
        """
        phi = self.answer.rotation
        return {
            name: sum(
                arm * phi[gear]
                for gear, arm in self.train.approaches[mesh.flank_name(True)].turning.items()
            )
            for name, mesh in self.train.meshes.items()
        }

    @cached_property
    def mesh_stiffness(self) -> dict[str, float]:
        """Tangent stiffness of every mesh along its line of action, at its force [N/m].

        Of both flanks where both carry; 0 where none does.
        """
        flanks = dict(zip(self.train.approaches, self._tangent.flanks.tolist(), strict=True))
        return {
            name: sum(flanks[mesh.flank_name(drive)] for drive in mesh.flanks)
            for name, mesh in self.train.meshes.items()
        }

    @cached_property
    def mesh_torsional_stiffness(self) -> dict[str, float]:
        """The same as torque by angle at the gear that the mesh names first [N·m/rad]."""
        meshes = self.train.meshes
        return {name: k * meshes[name].told_radius ** 2 for name, k in self.mesh_stiffness.items()}

    @property
    def _ratio(self) -> float:
        """Speed of the output over that of the input."""
        return abs(self.train.gears[self.train.output].ratio)
