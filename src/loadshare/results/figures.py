"""All figures of answers as arrays, computed from many claims, or from one, at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags
from loadshare.certify.bound import Columns, torque_bounds
from loadshare.certify.bound.one import columns_of
from loadshare.certify.bound.tangent import Tangents, tangents_of
from loadshare.certify.floats import FloatPlaces
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.residuals import RESIDUALS, pushed_by_rings, scaled_residuals
from loadshare.certify.state import ClaimedState
from loadshare.certify.validity import Measuring, measuring
from loadshare.results.share import (
    MeshTorques,
    carries,
    mesh_torques,
    over_meshes,
    shares,
    torques_of_flanks,
)
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Range
from loadshare.train.situations import Situations
from loadshare.train.train import Train

COMPONENTS = ("x", "y")
"""Components of a displacement in the gear's transverse frame."""
SIDES = ("input", "output")
"""Sides to which figures of the whole train are referred."""


class Figures:
    """Figures of S answers of a train, which are the first axis of every array.

    Elements are in the order of the train; figures that do not exist are NaN.

    Parameters
    ----------
    train : Train
        Of the answers, placed and remembering slip where they are.
    situations : Situations
    answers : Equilibria
        With displacements of least norm.
    undetermined : sequence of mapping of coordinate to (float, float)
        Ranges of the coordinates that the forces of each answer leave open.
    proved : ndarray, shape (S,)
        Largest distance of a torque from the exact one, over the largest torque.
    """

    def __init__(
        self,
        train: Train,
        situations: Situations,
        answers: Equilibria,
        undetermined: Sequence[Mapping[str, Range]],
        proved: Array,
    ) -> None:
        self.train, self.situations, self.answers = train, situations, answers
        self.undetermined, self.proved = undetermined, proved
        self.count = len(answers.rotation)

    @cached_property
    def state(self) -> ClaimedState:
        """The mechanics evaluated at the claims."""
        with np.errstate(all="ignore"):
            return ClaimedState(mechanics_of(self.train), self.situations, self.answers)

    @cached_property
    def columns(self) -> Columns:
        """The mechanics as columns of a matrix."""
        return columns_of(self.train)

    @property
    def measuring(self) -> Measuring:
        """The measures of displacements."""
        return measuring(self.train)

    @cached_property
    def _torques(self) -> MeshTorques:
        return mesh_torques(self.train, self.answers.flank_force)

    @property
    def torque(self) -> Array:
        """Torque on the driver, drive less coast [N·m], (S, meshes)."""
        return self._torques.net

    @cached_property
    def coast_torque(self) -> Array:
        """Part on the coast flank [N·m], (S, meshes)."""
        torques = torques_of_flanks(self.train, self.answers.flank_force)
        return over_meshes(self.train, np.maximum(-torques, 0.0))

    @cached_property
    def share(self) -> Array:
        """Ω over the stage's mean, (S, meshes)."""
        return shares(self._torques, self.train.stages)

    @cached_property
    def pair_share(self) -> Array:
        """Ω over the group's mean, (S, meshes)."""
        return shares(self._torques, self.train.stages, pairs=True)

    @cached_property
    def mesh_position(self) -> Array:
        """Position of every mesh in its own cycle, from 1, (S, meshes)."""
        index = np.broadcast_to(self.situations.index, self.count)
        every = self.train.mesh_positions(index).values()
        return np.array([at + 1 for at in every]).reshape(-1, self.count).T

    @cached_property
    def mesh_force(self) -> Array:
        """Force of every mesh along its line of action [N], (S, meshes).

        Positive where the gear that the mesh names first drives.
        """
        flanks = self.columns.all_flanks
        signs = [1.0 if mesh.is_drive(drive) else -1.0 for mesh, drive in flanks]
        return over_meshes(self.train, self.answers.flank_force * np.array(signs))

    @cached_property
    def shaft_torque(self) -> Array:
        """Torque of every shaft from its first gear to its second [N·m], (S, shafts)."""
        shafts = len(self.train.shafts)
        return self.state.torque.T if shafts else np.zeros((self.count, 0))

    @cached_property
    def gear_torque(self) -> Array:
        """External torque on every gear, counter-clockwise about its axis [N·m], (S, gears).

        Loads, and on the output and on held gears the torque that balances all others.
        """
        of, state = self.state.of, self.state
        torque = np.broadcast_to(state.here.torque, (len(of.order), self.count)).copy()
        for group in of.groups:
            for held in (gear for gear in group if gear in of.held):
                torque[held] -= state.moment[group].sum(axis=0)
        senses = [np.nan if g.rim_of else g.sense for g in self.train.gears.values()]
        return np.asarray(torque.T * np.array(senses) + 0.0)

    @cached_property
    def bearing_force(self) -> Array:
        """Force of every gear on its bearing, of a planet on its pin [N], (S, gears, 2).

        In its frame; supports and bearings with clearance together, without splines and rings.
        """
        of, state = self.state.of, self.state
        pushing = of.pushing.reshape(-1, len(of.order), 3)
        pushed = -np.einsum("egk,es->gks", pushing, state.claim.flank_force)
        pushed += pushed_by_rings(state)
        if state.pushed is not None:
            pushed += state.pushed[1]
        found = np.full((self.count, len(of.order), 2), np.nan)
        for k, (name, gear) in enumerate(self.train.gears.items()):
            if gear.rim_of is not None:
                continue
            own = pushed[k].T @ gear.plane.T
            if gear.support is not None:
                own = gear.in_plane(state.claim.support_force[k].T)
            bearing = self.train.bearings.get(name)
            if bearing is not None:
                own = own - state.reaction[of.pulls.index(bearing.name)].T @ gear.plane.T
            found[:, k] = own
        return found

    @cached_property
    def _tangents(self) -> Tangents:
        return tangents_of(self.columns, self.situations, self.answers)

    @property
    def _ratio(self) -> float:
        """Speed of the output over that of the input."""
        return abs(self.train.gears[self.train.output].ratio)

    @cached_property
    def transmission_error(self) -> Array:
        """Loaded transmission error of the train, referred to input and output [rad], (S, 2).

        How far the input turns beyond what its ratio to the output gives; positive in its running
        sense, where the output lags behind. Referred to the output it is smaller by the ratio of
        the speeds.
        """
        ahead = self.answers.rotation[:, self.train.order[self.train.input]]
        return np.stack([ahead, ahead * self._ratio], axis=1)

    @cached_property
    def torsional_stiffness(self) -> Array:
        """Tangent stiffness dT/dφ, referred to input and output [N·m/rad], (S, 2).

        Torque on the input per rotation, with the output held. Elements that carry are taken to
        continue to carry, those that slip to continue to slip. 0 where nothing resists.
        """
        stiffness, ratio = self._tangents.torsion(self.train.input), self._ratio**2
        output = stiffness / ratio if ratio else np.zeros(self.count)
        return np.stack([stiffness, output], axis=1)

    @cached_property
    def mesh_transmission_error(self) -> Array:
        """Loaded transmission error of every mesh along its line of action [m], (S, meshes).

        How far the base circle of the gear that the mesh names first runs ahead of the other's, in
        the sense in which it would drive that one, seen from their carrier: r₁φ₁ − r₂φ₂.
        """
        arms = np.zeros((len(self.train.gears), len(self.train.meshes)))
        for m, mesh in enumerate(self.train.meshes.values()):
            turning = self.train.approaches[mesh.flank_name(True)].turning
            for gear, arm in turning.items():
                arms[self.train.order[gear], m] = -arm if mesh.named_backwards else arm
        return np.asarray((self.answers.rotation[:, :, None] * arms).sum(axis=1))

    @cached_property
    def mesh_stiffness(self) -> Array:
        """Tangent stiffness of every mesh along its line of action, (S, meshes) [N/m].

        At its force; the sum of both flanks where both carry, 0 where none does.
        """
        force = self.answers.flank_force
        carry = carries(force, force.max(axis=1, initial=0.0)[:, None])
        return over_meshes(self.train, np.where(carry, self._tangents.flanks, 0.0))

    @cached_property
    def mesh_torsional_stiffness(self) -> Array:
        """The same as torque per angle at the gear that the mesh names first [N·m/rad]."""
        radii = np.array([mesh.first_radius for mesh in self.train.meshes.values()])
        return np.asarray(self.mesh_stiffness * radii**2)

    @property
    def rotation(self) -> Array:
        """Elastic rotation of every gear [rad], (S, gears)."""
        return self.answers.rotation

    @cached_property
    def displacement(self) -> Array:
        """Displacement of every centre in the gear's transverse frame [m], (S, gears, 2)."""
        planes = np.array([gear.plane for gear in self.train.gears.values()])
        return np.asarray(np.einsum("gak,sgk->sga", planes, self.answers.displacement))

    def _ranges(self, what: str) -> Array:
        """Return the least and largest value of every gear's open coordinate, (S, gears, 2)."""
        found = np.full((self.count, len(self.train.gears), 2), np.nan)
        for s, open_ in enumerate(self.undetermined):
            for g, gear in enumerate(self.train.gears if open_ else ()):
                found[s, g] = open_.get(f"gear {gear} {what}", np.nan)
        return found

    @cached_property
    def rotation_range(self) -> Array:
        """Least and largest rotation where forces leave it open [rad], (S, gears, 2)."""
        return self._ranges("rotation")

    @cached_property
    def displacement_range(self) -> Array:
        """Least and largest displacement where forces leave it open [m], (S, gears, 2, 2)."""
        return np.stack([self._ranges(axis) for axis in COMPONENTS], axis=2)

    @cached_property
    def _rests(self) -> FloatPlaces:
        with np.errstate(all="ignore"):
            return FloatPlaces(self.state, self.undetermined, CERTIFY.band)

    @property
    def margin(self) -> Array:
        """Distance of every float to its nearest boundary [m], (S, floats)."""
        return self._rests.margin.T

    @property
    def on_boundary(self) -> Flags:
        """Whether every float rests on a boundary, (S, floats)."""
        return self._rests.on_boundary.T

    @property
    def reaction(self) -> Array:
        """Force of its rings on every float [N], (S, floats, 2)."""
        return np.moveaxis(self._rests.reaction, 2, 0)

    @cached_property
    def rest(self) -> NDArray[np.str_]:
        """Where every float rests, in words, (S, floats)."""
        words = [self._rests.rest(gear) for gear in self.train.floating]
        return np.array(words, dtype=str).reshape(-1, self.count).T

    @cached_property
    def spline(self) -> NDArray[np.str_]:
        """Stage of every float's spline, (S, floats); empty without one."""
        words = [self._rests.stage_name(gear) for gear in self.train.floating]
        return np.array(words, dtype=str).reshape(-1, self.count).T

    @cached_property
    def torque_bound(self) -> Array:
        """Bound on every torque's distance from the exact equilibrium's [N·m], (S, meshes)."""
        return torque_bounds(self.columns, self.situations, self.answers, self.proved)

    @cached_property
    def residual(self) -> Array:
        """Scaled residuals of the certificate, (S, figures), in the order of `RESIDUALS`."""
        with np.errstate(all="ignore"):
            return scaled_residuals(self.state)

    @cached_property
    def measured(self) -> dict[str, Array]:
        """Size of the displacements for the geometry, by measure, (S,) each."""
        every = self.measuring.every(self.situations, self.answers, self.state.deflection)
        largest = {name: values.max(axis=0) for name, values in every.items()}
        return {name: np.where(v < 0.0, np.nan, v) for name, v in largest.items()}

    @cached_property
    def names(self) -> dict[str, list[str]]:
        """Names along the axes after the first."""
        train = self.train
        return {
            "mesh": list(train.meshes),
            "gear": list(train.gears),
            "shaft": list(train.shafts),
            "side": list(SIDES),
            "component": list(COMPONENTS),
            "end": ["least", "largest"],
            "float": list(train.floating),
            "figure": list(RESIDUALS),
        }

    def by_name(self, row: int, name: str, dim: str) -> dict[str, float]:
        """Return a figure of an answer, by the names along an axis."""
        return dict(zip(self.names[dim], getattr(self, name)[row].tolist(), strict=True))

    def as_numbers(self, name: str, names: Mapping[str, Sequence[str]]) -> Array:
        """Return a figure by its name as numbers; of "validity", the measures in `names`."""
        if name != "validity":
            return np.asarray(getattr(self, name), dtype=float)
        none = np.full(self.count, np.nan)
        return np.stack([self.measured.get(m, none) for m in names["measure"]], axis=1)
