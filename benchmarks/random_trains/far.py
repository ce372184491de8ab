"""Check whether a reference moves too far for the geometry in which it was found."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.limit import TooLong, limited
from benchmarks.reference import NoReference, Reference, reference
from loadshare.train import Train
from loadshare.train.gear import Vector
from loadshare.train.mesh import Mesh
from loadshare.train.situations import situation_of

FAR = 1e-2
"""Displacement or compression, over the smallest base radius, above which it is no longer small."""
NEGLECTED = 0.99
"""Approach that linear geometry misses, over the deflection, from which on linear geometry is not
valid. The library refuses from 1 on, by an estimate."""
TURNED = 0.15
"""Angle [rad] by which a line of action turns from which on forces have other directions. The
library refuses from 0.176 on, by an estimate."""
LIGHTER = (0.5, 0.1)
"""Shares of the load that are tried if there is no reference."""
SECONDS = 20.0
"""Processor time that a reference at a lighter load may take [s]."""


def is_far(train: Train, index: int, exact: Reference) -> bool:
    """Return whether the displacements of a reference are too large to be meaningful.

    Parameters
    ----------
    train : Train
    index : int
        1-based position.
    exact : Reference
    """
    smallest = min(g.base_radius for g in train.gears.values())
    furthest = [abs(float(v)) for p in exact.displacement.values() for v in p]
    furthest += compressions(train, index, exact)
    far = max(furthest, default=0.0) > FAR * smallest or turned(train, index, exact) >= TURNED
    return far or neglected(train, index, exact) >= NEGLECTED


def compressions(train: Train, index: int, exact: Reference) -> list[float]:
    """Return the compression of every flank [m]."""
    at = train.flank_positions(index)
    return [
        mesh.law(at[name]).compression(max(exact.force[name], 0.0))
        for mesh in train.meshes.values()
        for name in map(mesh.flank_name, mesh.flanks)
    ]


def is_far_before(train: Train, index: int) -> bool:
    """Return whether a part of the load already displaces a train too far.

    Soft rings may let a gear roll along their arcs until nothing holds it. Such a train has no
    equilibrium under its load, and its displacements are meaningless long before that load is
    reached.
    """
    for share in LIGHTER:
        torque = tuple(share * t for t in train.input_torque)
        external = {g: share * t for g, t in train.external.items()}
        lighter = replace(train, input_torque=torque, external=external)
        try:
            with limited(SECONDS):
                found = reference(lighter, index)
        except (NoReference, ArithmeticError, TooLong):
            continue
        return is_far(lighter, index, found)
    return False


def neglected(train: Train, index: int, exact: Reference) -> float:
    """Return the largest approach that linear geometry misses at loaded flanks, in deflections.

    The deflection is the largest compression, gap taken up, or error. Face gears are left out.
    """
    lengths = np.linalg.norm(situation_of(train, index).offset[0], axis=1).tolist()
    positions = train.flank_positions(index)
    for mesh, drive, force in _pressed(train, exact):
        at = positions[mesh.flank_name(drive)]
        lengths += [mesh.law(at).compression(force), abs(mesh.gap(at, drive))]
    missed = max((string.missed for string in _strings(train, index, exact)), default=0.0)
    return missed / (max(lengths, default=0.0) or math.inf)


def turned(train: Train, index: int, exact: Reference) -> float:
    """Return the largest angle by which the line of action of a loaded flank turns [rad].

    Errors count like displacements. Face gears are left out.
    """
    return max((abs(string.turned) for string in _strings(train, index, exact)), default=0.0)


def _pressed(train: Train, exact: Reference) -> Iterator[tuple[Mesh, bool, float]]:
    """Yield the flanks with a force: mesh, whether it is the drive flank, force [N]."""
    for mesh in train.meshes.values():
        for drive in mesh.flanks:
            force = exact.force[mesh.flank_name(drive)]
            if force > 0.0:
                yield mesh, drive, force


def _strings(train: Train, index: int, exact: Reference) -> Iterator[_String]:
    """Yield the strings between the base circles of loaded flanks."""
    here, still = situation_of(train, index), np.zeros(2)
    moved = {
        name: here.offset_of(name) + exact.displacement.get(name, still) @ gear.frame
        for name, gear in train.gears.items()
    }
    # A planet's displacement counts from its carrier, which moves all planets of a set alike.
    moved |= {n: moved[n] + moved[g.carrier] for n, g in train.gears.items() if g.carrier}
    for mesh, drive, _ in _pressed(train, exact):
        first, second = train.gears[mesh.driver], train.gears[mesh.driven]
        if "face" not in (first.kind, second.kind):
            normal, way = mesh.direction(drive)[2], first.centre - second.centre
            shift = moved[mesh.driver] - moved[mesh.driven]
            yield _String.of(way, shift, normal, np.cross(first.axis, normal))


@dataclass(frozen=True)
class _String:
    """Change of the string between two base circles when their centres shift.

    The string lies along the line of action and has length L and direction χ; the derivative of the
    approach is the direction of the line. So the approach grows by ΔL − R Δχ, where R is the
    distance of the centres perpendicular to the line, which does not change.

    Attributes
    ----------
    turned : float
        Δχ [rad].
    missed : float
        Difference [m] between the approach of the involutes and the linear one.
    """

    turned: float
    missed: float

    @classmethod
    def of(cls, way: Vector, shift: Vector, along: Vector, across: Vector) -> _String:
        """Return the change for a vector between the centres, its shift and the line of action."""
        length, offset = float(way @ along), float(way @ across)
        there = length + float(shift @ along), offset + float(shift @ across)
        squared = there[0] ** 2 + there[1] ** 2 - offset**2
        if squared <= 0.0:
            return cls(math.inf, math.inf)
        reached = math.copysign(math.sqrt(squared), length)
        angle = math.atan2(there[1], there[0]) - math.atan2(offset, reached)
        missed = abs(reached - length - offset * angle - float(shift @ along))
        return cls(math.remainder(angle, 2.0 * math.pi), missed)
