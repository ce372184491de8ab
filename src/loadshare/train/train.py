"""The machine as a whole."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar, overload

import numpy as np

from loadshare.array_types import Numbers
from loadshare.train.elements import Shaft, Spline, Stage
from loadshare.train.gear import ORIGIN, Gear, Vector
from loadshare.train.mesh import Approach, Mesh, approach_of
from loadshare.train.offset import Angle, Offset, turned_about
from loadshare.train.period import Period
from loadshare.train.ring import Bearing, DrumRing, Ring, RoundRing
from loadshare.train.seen import speed_in_mesh
from loadshare.train.turning import March, Turning, cycle_gear, turning_of

At = TypeVar("At", int, Numbers)
"""A position (1-based), or many of them."""


@dataclass(frozen=True, eq=False)
class Train:
    """A gear train in SI units: geometry, laws, errors and operating point.

    If samples share a machine, numbers that vary are arrays of S values; such a train only serves
    to be turned into `Situations`.

    Attributes
    ----------
    name : str
    gears : mapping of str to Gear
    meshes : mapping of str to Mesh
    shafts : mapping of str to Shaft
    splines, rings, bearings, offsets : mapping of gear name to Spline, Ring, Bearing, Offset
    stages : tuple of Stage
    input, output : str
    input_torque : tuple of float
        One, or one per position [N·m].
    external : mapping of str to float
        Further external torques [N·m].
    positions : int
        Positions of a mesh cycle.
    rotating : bool
        Whether gears turn over the mesh cycle.
    march : tuple of (str, float, int) or None
        Reference gear, its revolutions and the number of steps.
    forces : mapping of gear to ndarray (3,)
        External forces, weights among them, fixed in the housing [N].
    period : Period or None
        Common period of all meshes, if the positions run through it.
    slip : mapping of gear to ndarray (3,), or None
        Slip s₀ [m] of every spline at the position before, for friction with memory; None for
        friction without.
    uneven : bool
        Whether whatever holds a turning set differs between directions, so that every position has
        a train of its own (see `placed.py`).
    placed : int or None
        The position whose train this is; all vectors are then in the frame of the housing.
    held_at : mapping of flank to int, or None
        Positions of their laws (0-based) at which flanks are held over all positions.
    """

    name: str
    gears: Mapping[str, Gear]
    meshes: Mapping[str, Mesh]
    shafts: Mapping[str, Shaft]
    splines: Mapping[str, Spline]
    rings: Mapping[str, Ring]
    bearings: Mapping[str, Bearing]
    offsets: Mapping[str, Offset]
    stages: tuple[Stage, ...]
    input: str
    output: str
    input_torque: tuple[float, ...]
    external: Mapping[str, float]
    positions: int
    rotating: bool
    march: March | None
    forces: Mapping[str, Vector] = field(default_factory=dict)
    period: Period | None = None
    slip: Mapping[str, Vector] | None = None
    uneven: bool = False
    placed: int | None = None
    held_at: Mapping[str, int] | None = None

    def remembering(self, slip: Mapping[str, Vector]) -> Train:
        """Return the train with the slip [m] of every spline from which its friction starts."""
        return replace(self, slip=dict(slip))

    @property
    def count(self) -> int:
        """Number of positions to solve."""
        return self.turning.steps

    @cached_property
    def turning(self) -> Turning:
        """How far the input turns over the positions."""
        return turning_of(self.gears, self.positions, self.rotating, self.march, self.period)

    @property
    def is_placed_anew(self) -> bool:
        """Whether every position has a train of its own, and this is not one of them."""
        return self.uneven and self.placed is None

    @cached_property
    def order(self) -> dict[str, int]:
        """Index of every gear."""
        return {name: k for k, name in enumerate(self.gears)}

    @cached_property
    def held(self) -> tuple[str, ...]:
        """Gears that do not turn: the output, whose load the balance determines, and held ones."""
        return (self.output, *(name for name, gear in self.gears.items() if gear.held))

    @cached_property
    def approaches(self) -> dict[str, Approach]:
        """How the approach of every flank depends on the bodies, by name of the flank."""
        return {
            mesh.flank_name(drive): approach_of(mesh, drive, self.gears)
            for mesh in self.meshes.values()
            for drive in mesh.flanks
        }

    @cached_property
    def driving(self) -> dict[str, tuple[tuple[str, float], ...]]:
        """Flanks of every mesh, the drive flank first, and their torques per force [m]."""
        return {
            name: tuple((mesh.flank_name(d), mesh.lever(d)) for d in mesh.flanks)
            for name, mesh in self.meshes.items()
        }

    @cached_property
    def floating(self) -> tuple[str, ...]:
        """Gears whose rest position is reported: free ones, those on a spline, those in a ring."""
        return tuple(
            n for n, g in self.gears.items() if g.floats or n in self.splines or n in self.limits
        )

    @cached_property
    def limits(self) -> dict[str, tuple[Ring, ...]]:
        """Rings and bearings that limit how far gears float, by gear."""
        found: dict[str, tuple[Ring, ...]] = {}
        for limit in (*self.rings.values(), *self.bearings.values()):
            found[limit.gear] = (*found.get(limit.gear, ()), limit)
        return found

    @cached_property
    def drums(self) -> tuple[DrumRing, ...]:
        """Rings that roll on the rings of two neighbours."""
        return tuple(r for r in self.rings.values() if isinstance(r, DrumRing))

    @cached_property
    def rounds(self) -> tuple[RoundRing, ...]:
        """Round rings, then bearings."""
        rings = (r for r in self.rings.values() if isinstance(r, RoundRing))
        return (*rings, *self.bearings.values())

    @cached_property
    def cycle(self) -> str | None:
        """Gear whose pitch makes a mesh cycle; None if gears do not rotate over the cycle.

        It is the input gear, or else the nearest to it whose teeth are known. In a march it has no
        effect.
        """
        return cycle_gear(self.gears) if self.rotating else None

    @property
    def stands_still(self) -> bool:
        """Whether gears do not rotate over the positions."""
        return self.march is None and self.cycle is None

    @overload
    def rotations(self, index: int) -> dict[str, float]: ...

    @overload
    def rotations(self, index: Numbers) -> dict[str, Vector]: ...

    def rotations(self, index: int | Numbers) -> dict[str, float] | dict[str, Vector]:
        """Return the angle [rad] by which every gear has turned at position `index` (1-based).

        `index` may be an array of positions.

        In a mesh cycle the gears turn by one pitch of the gear `cycle` over the cycle, or over the
        common period of all meshes. In a march they turn through whole revolutions.

        Raises
        ------
        IndexError
            If there is no such position.
        """
        least, most = (index, index) if isinstance(index, int) else (index.min(), index.max())
        if not 1 <= least <= most <= self.count:
            raise IndexError(f"position {index}: this case has positions 1 to {self.count}")
        turned = self.turning.after(index - 1)
        angles: dict[str, Any] = {n: turned * gear.ratio for n, gear in self.gears.items()}
        return angles

    def offset(self, gear: str, rotation: Mapping[str, Angle]) -> Vector:
        """Return the centre offset (…, 3) [m] of a gear, seen from the carrier it turns about.

        As the housing sees it in a train that is placed.

        Parameters
        ----------
        gear : str
        rotation : mapping of str to float or ndarray
            By which every gear has turned [rad].
        """
        errors = self.offsets.get(gear)
        if errors is None:
            return ORIGIN
        here, turned = self.gears[gear], self.frame_angle(gear, rotation)
        offset = errors.at(here, rotation[gear], turned)
        return offset if self.placed is None else turned_about(here, offset, turned)

    def push(self, gear: str, rotation: Mapping[str, Angle]) -> Vector:
        """Return the external force (…, 3) [N] on a gear, seen from the carrier it turns about.

        As the housing sees it in a train that is placed.

        Parameters
        ----------
        gear : str
        rotation : mapping of str to float or ndarray
            By which every gear has turned [rad].
        """
        force = self.forces.get(gear)
        if force is None:
            return ORIGIN
        turned = 0.0 if self.placed is not None else self.frame_angle(gear, rotation)
        return turned_about(self.gears[gear], force, -turned) if np.any(turned) else force

    @overload
    def frame_angle(self, gear: str, rotation: Mapping[str, float]) -> float: ...

    @overload
    def frame_angle(self, gear: str, rotation: Mapping[str, Angle]) -> Angle: ...

    def frame_angle(self, gear: str, rotation: Mapping[str, Angle]) -> Angle:
        """Return the angle [rad] by which the carrier from which a gear is seen has turned.

        Parameters
        ----------
        gear : str
        rotation : mapping of str to float or ndarray
            By which every gear has turned [rad].
        """
        here = self.gears[gear]
        if here.frame_of is None:
            return 0.0
        carrier = self.gears[here.frame_of]
        along = 1.0 if carrier.axis @ here.axis > 0.0 else -1.0
        return along * carrier.sense * rotation[carrier.name]

    def slip_seen_next(self, gear: str, slip: Vector, index: int) -> Vector:
        """Return the slip (3,) [m] after position `index` (1-based) as seen at the next position.

        Seen from a carrier, a vector fixed in the housing rotates backwards; seen from the housing,
        in a train whose positions are placed, one fixed on a carrier rotates with it.
        """
        here = self.gears[gear]
        if (here.carrier is not None) != self.uneven or index == self.count:
            return slip
        now, then = (self.frame_angle(gear, self.rotations(k)) for k in (index, index + 1))
        return turned_about(here, slip, then - now if self.uneven else now - then)

    def mesh_positions(self, index: At) -> dict[str, At]:
        """Return the position (0-based) of its laws at which every drive flank is, by mesh.

        See `flank_positions`, which includes coast flanks.
        """
        found = self.flank_positions(index)
        return {mesh: found[mesh] for mesh in self.meshes}

    def flank_positions(
        self, index: At, rotation: Mapping[str, Any] | None = None
    ) -> dict[str, At]:
        """Return the position of its laws (0-based) of every flank at position `index` (1-based).

        In a mesh cycle all meshes go through theirs together, each flank from its own phase; over
        their common period each goes through its own. In a march a mesh whose teeth are known is at
        the position that its rotation reaches; others have one law for all positions.
        """
        rotation = rotation or self.rotations(index)
        count, held = self.positions, self.held_at or {}
        found: dict[str, Any] = {}
        # Many flanks are at the same position.
        known: dict[tuple[Any, ...], Any] = {}
        together = self.march is None and self.period is None
        for mesh in self.meshes.values():
            for drive in mesh.flanks:
                name, phase = mesh.flank_name(drive), mesh.phase if drive else mesh.coast_phase
                key = together or mesh.name, phase, mesh.averaged, drive == mesh.named_backwards
                if key not in known:
                    passed = self._passed(mesh, index - 1, rotation)
                    known[key] = mesh.position(drive, (passed + phase) * count, count)
                found[name] = held.get(name, known[key])
        if isinstance(index, int):
            return {flank: int(at) for flank, at in found.items()}
        return {flank: np.asarray(at, dtype=np.intp) for flank, at in found.items()}

    def _passed(self, mesh: Mesh, step: Any, rotation: Mapping[str, Any]) -> Any:
        """Return the fraction of its cycle that a mesh has passed since the first position [-]."""
        if self.march is None and self.period is not None:
            return step * self.period.cycles[mesh.name] % self.count / self.count
        driver = self.gears[mesh.driver]
        if self.march is None or driver.teeth is None:
            return step % self.positions / self.positions
        turned = rotation[self.input] * abs(speed_in_mesh(self.gears, mesh.driver, mesh.driven))
        return turned * driver.teeth / (2.0 * math.pi) % 1.0

    def levers(self, gear: str) -> dict[str, float]:
        """Return the torque over a gear's shaft or spline per unit of every flank's force [m]."""
        flanks = self.approaches.items()
        return {name: to.turning[gear] for name, to in flanks if gear in to.turning}

    def transmitted(self, gear: str, flank_force: Mapping[str, float]) -> float:
        """Return the torque [N·m] that reaches a gear over its shaft or spline, not its meshes.

        Parameters
        ----------
        gear : str
        flank_force : mapping of flank to float
            [N]; a flank that is not named carries nothing.
        """
        return sum(a * flank_force.get(name, 0.0) for name, a in self.levers(gear).items())
