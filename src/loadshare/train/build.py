"""Turn a case into a train in SI units.

A number may also be an array of S values, one per sample (see `samples`); the code here handles
both.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from loadshare import case as spec
from loadshare.array_types import Array
from loadshare.case.keys import Path
from loadshare.case.uneven import is_uneven
from loadshare.contact.law import Law, PowerLaw, TableLaw
from loadshare.errors import CaseError, Problem
from loadshare.train.elements import Shaft, Spline
from loadshare.train.gear import Gear, Vector, cross
from loadshare.train.geometry import Geometry, Pair, geometry_of
from loadshare.train.mesh import Mesh
from loadshare.train.offset import Offset, polar, vector_of
from loadshare.train.operation import forces_of, operation_of, stages_of
from loadshare.train.rim import with_harmonics
from loadshare.train.ring import Bearing, DrumRing, Ring, RoundRing, transverse
from loadshare.train.thermal import fitted, flank_growth, grows
from loadshare.train.train import Train

Element = TypeVar("Element")

CHAINS = "chains that begin with a mesh of the limited gear, one on either side of it"
"""What a float that is derived from backlashes needs, in the words of an error message."""
JUMP = -2.0
"""Twice the angle of a support's stiffest direction up to which the opposite direction is taken
[rad]."""


def build_train(case: spec.Case) -> Train:
    """Turn a case into a train.

    Parameters
    ----------
    case : spec.Case

    Returns
    -------
    Train

    Raises
    ------
    CaseError
        If gears turn against each other or the train would lock, or a ring's float cannot be
        derived; all problems are listed.
    """
    case = with_laws(case)
    return train_of(case, geometry_of(case))


def with_laws(case: spec.Case) -> spec.Case:
    """Return the case, with its mesh laws computed where it asks for that."""
    if any(mesh.law_is_computed for mesh in case.meshes.values()):
        from loadshare.tooth import resolve

        return resolve(case)
    return case


def train_of(
    case: spec.Case,
    geometry: Geometry,
    base: tuple[spec.Case, Train] | None = None,
    changed: Collection[Path] | None = None,
) -> Train:
    """Turn a case whose geometry is settled into a train.

    Parameters
    ----------
    case : spec.Case
    geometry : Geometry
    base : (spec.Case, Train), optional
        Another case and its train. Elements that are the same in both cases are taken from it.
    changed : collection of Path, optional
        Section and name of the elements that differ; by default, of all that are not the same
        object in both cases.

    Raises
    ------
    CaseError
        If a ring's float cannot be derived.
    """

    def elements(
        section: str, convert: Callable[[str, Any], Element], known: str = ""
    ) -> dict[str, Element]:
        """Return the elements of a section; those that the base does not have are built."""
        now = getattr(case, section)
        if base is None:
            return {name: convert(name, item) for name, item in now.items()}
        there = getattr(base[1], known or section)
        kept = _kept(section, now, getattr(base[0], section), changed)
        return {n: there[n] if n in kept else convert(n, item) for n, item in now.items()}

    problems: list[Problem] = []

    def ring_of(name: str, ring: spec.Ring) -> Ring | None:
        try:
            return _ring(name, ring, gears, meshes)
        except ValueError as error:
            problems.append(case.problem(("rings", name, "float"), str(error), CHAINS))
            return None

    supported = elements("gears", lambda name, _: _supported(case, geometry.gears, name))
    # In the order of the walk from the input gear.
    gears = with_harmonics(case, {name: supported[name] for name in geometry.gears})
    by_layout, warm = case.operating.phases == "layout", grows(case)

    def mesh_of(name: str, mesh: spec.Mesh) -> Mesh:
        pair = geometry.pairs[name]
        made = _mesh(name, mesh, pair, by_layout)
        return made.closer(flank_growth(case, pair)) if warm else made

    def bearing_of(name: str, bearing: spec.Bearing) -> Bearing:
        offset = _side_by_side(bearing.offset) @ gears[name].plane
        made = Bearing(name, bearing.clearance.si, offset, *bearing.wall)
        return fitted(case, made, gears[name]) if warm else made

    meshes = elements("meshes", mesh_of)
    rings = elements("rings", ring_of)
    if problems:
        raise CaseError(problems)
    return Train(
        name=case.name,
        gears=gears,
        meshes=meshes,
        shafts=elements("shafts", _shaft),
        splines=elements("splines", _spline),
        rings={name: ring for name, ring in rings.items() if ring is not None},
        bearings=elements("bearings", bearing_of),
        offsets=elements("errors", lambda name, e: _offset(e, gears[name], gears), "offsets"),
        stages=stages_of(case),
        **operation_of(case, gears),
        forces=forces_of(case),
        period=geometry.period,
        uneven=is_uneven(case),
    )


def _kept(section: str, now: Any, before: Any, changed: Collection[Path] | None) -> set[str]:
    """Return the names of a section's elements that need not be built again (see `train_of`)."""
    if section == "rings":
        # Floats that are derived from backlashes change with the meshes.
        now = {n: r for n, r in now.items() if not isinstance(r.float_, spec.Backlashes)}
    if changed is None:
        return {name for name, item in now.items() if item is before[name]}
    return {name for name in now if (section, name) not in changed}


def _supported(case: spec.Case, gears: Mapping[str, Gear], name: str) -> Gear:
    """Return a gear with its support, which for a matrix or a pin is in principal directions."""
    gear = gears[name]
    given = case.gears[gear.name].support or ("free" if case.floats(gear.name) else "rigid")
    if isinstance(given, str):
        return replace(gear, support=np.zeros(2) if given == "free" else None)
    if isinstance(given, spec.PinSupport):
        outwards = gear.frame @ (gear.centre - gears[str(gear.carrier)].centre)
        stiffness = _side_by_side((given.radial, given.tangential))
        return _seen_along(gear, math.atan2(outwards[1], outwards[0]), stiffness)
    rows = given if isinstance(given, tuple) else (given, given)
    if alike := [k for k in rows if isinstance(k, spec.Quantity)]:
        return replace(gear, support=_side_by_side(alike))
    matrix = np.array([[k.si for k in row] for row in rows if isinstance(row, tuple)])
    stiffness, _ = np.linalg.eigh(0.5 * (matrix + matrix.T))
    twice = math.atan2(matrix[0, 1] + matrix[1, 0], matrix[0, 0] - matrix[1, 1])
    # As the entries change, the directions must jump somewhere: not where an off-diagonal entry is
    # zero or the diagonal entries are equal.
    angle = 0.5 * (twice if twice > JUMP else twice + 2.0 * math.pi)
    return _seen_along(gear, angle, stiffness[::-1])


def _seen_along(gear: Gear, angle: float, support: Array) -> Gear:
    """Return a gear with its frame turned by an angle, and its stiffnesses along the new frame."""
    ways = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return replace(gear, support=support, frame=ways @ gear.frame)


def _side_by_side(numbers: Sequence[spec.Quantity]) -> Array:
    """Return numbers in SI units as one array, (…, numbers)."""
    return np.stack(np.broadcast_arrays(*(number.si for number in numbers)), axis=-1)


def _each(value: spec.Quantity | tuple[spec.Quantity, ...] | None) -> tuple[spec.Quantity, ...]:
    if value is None:
        return ()
    return value if isinstance(value, tuple) else (value,)


def _mesh(name: str, mesh: spec.Mesh, pair: Pair, by_layout: bool) -> Mesh:
    # The approach is that in the transverse plane, where j = j_wt cos α_wt = j_bn / cos β_b.
    if mesh.normal_backlash is not None:
        backlash = mesh.normal_backlash.si / math.cos(pair.line.helix_angle)
    elif isinstance(mesh.backlash, spec.Quantity):
        backlash = mesh.backlash.si * math.cos(pair.line.pressure_angle)
    else:
        backlash = pair.backlash
    radii = pair.driver.base_radius, pair.driven.base_radius
    r = radii[1] if pair.named_backwards else radii[0]
    law = mesh.power_law
    # A gap of the law belongs to the teeth, thus to both flanks; any other is the drive flank's.
    of_teeth = (0.0,) if law is None else tuple(r * a.si for a in _each(law.a))
    phase, coast_phase = pair.phases if by_layout else (0.0, 0.0)
    if mesh.phase is not None:
        phase, coast_phase = mesh.phase, (mesh.phase + coast_phase - phase) % 1.0
    return Mesh(
        name=name,
        driver=pair.driver.name,
        driven=pair.driven.name,
        radii=radii,
        drive_normal=pair.normals[0],
        coast_normal=pair.normals[1],
        laws=_laws(mesh, r),
        gaps=of_teeth if mesh.gap is None else tuple(r * g.si for g in _each(mesh.gap)),
        backlash=backlash,
        named_backwards=pair.named_backwards,
        flank_uncertain=pair.flank_uncertain,
        phase=phase,
        senses=pair.senses,
        coast_phase=coast_phase,
        coast_gaps=of_teeth,
        averaged=law is not None and law.sampling == "means",
    )


def _laws(mesh: spec.Mesh, r: float) -> tuple[Law, ...]:
    """Turn angle laws at the gear named first into laws on the line of action: δ = rΔφ, T = rF."""
    law = mesh.power_law
    if law is not None:
        b, c = _each(law.b), _each(law.c)
        count = max(len(b), len(c))
        return tuple(
            PowerLaw(b[k % len(b)].si * r**2, c[k % len(c)].si * r ** (5.0 / 3.0))
            for k in range(count)
        )
    if mesh.table is not None:
        forces = (0.0, *(t.si / r for t in mesh.table.torque))
        return tuple(
            TableLaw(forces, (0.0, *(r * d.si for d in curve))) for curve in mesh.table.curves
        )
    return tuple(PowerLaw(r**2 / k.si) for k in _each(mesh.stiffness))


def _shaft(name: str, shaft: spec.Shaft) -> Shaft:
    return Shaft(name, *shaft.ends, shaft.torsional_stiffness, shaft.clocking.si)


def _spline(gear: str, spline: spec.Spline) -> Spline:
    per_torque = 0.0
    if spline.friction is not None and spline.radius is not None:
        per_torque = spline.friction / spline.radius.si
    return Spline(
        gear,
        spline.bending_stiffness.si,
        spline.stick_limit.si if spline.stick_limit is not None else None,
        spline.clearance.si,
        spline.fixed_bound,
        per_torque,
    )


def _ring(name: str, ring: spec.Ring, gears: Mapping[str, Gear], meshes: dict[str, Mesh]) -> Ring:
    gear = gears[name]
    stiffness = math.inf if isinstance(ring.stiffness, str) else ring.stiffness.si
    if ring.radius is not None:
        offset = _side_by_side(ring.offset) @ gear.plane
        return RoundRing(name, ring.radius.si, offset, stiffness)
    first, second = (gears[n] for n in ring.neighbours or ())
    along = transverse(second.centre - first.centre, gear.axis)
    across = cross(gear.axis, along / np.linalg.norm(along))
    clearance = _each(ring.clearance)
    if isinstance(ring.float_, spec.Backlashes):
        ways = ring.float_.upward, ring.float_.downward
        up, down = (_float_range(gear, across, meshes, w) for w in (ways, ways[::-1]))
    elif isinstance(ring.float_, spec.Range):
        up, down = ring.float_.up.si, ring.float_.down.si
    else:
        up = down = ring.float_.si  # type: ignore[union-attr]
    return DrumRing(
        name,
        (first.name, second.name),
        across,
        (clearance[0].si, clearance[-1].si),
        up,
        down,
        stiffness,
        ring.measured == "nominal",
    )


def _float_range(
    gear: Gear, across: Vector, meshes: Mapping[str, Mesh], chains: tuple[tuple[str, ...], ...]
) -> float:
    """Return the float that takes up the backlashes of a chain of meshes (formulation, section 6).

    The gear rests on the first mesh of the second chain and rolls on it until the backlash of the
    whole first chain is closed: y with n_closing·ŷ y + r φ = Σ j_n and n_resting·ŷ y + r φ = 0.
    """
    slopes = []
    for first, *_ in chains:
        mesh = meshes[first]
        if gear.name not in (mesh.driver, mesh.driven):
            raise ValueError(f"mesh {mesh.name} is not a mesh of gear {gear.name}")
        side = 1.0 if mesh.driver == gear.name else -1.0
        slopes.append(side * float(mesh.drive_normal @ across))
    total = sum(meshes[m].backlash for m in chains[0])
    turn = abs(slopes[0] - slopes[1])
    if turn < 1e-9:
        raise ValueError(
            f"a float of gear {gear.name} across its neighbours does not take up the backlash "
            f"of mesh {chains[0][0]}"
        )
    return total / turn


def _pin(pin: spec.Pin, planet: Gear, carrier: Gear) -> Vector:
    arm = transverse(planet.centre - carrier.centre, carrier.axis)
    distance = float(np.linalg.norm(arm))
    outward, round_it = arm / distance, cross(carrier.axis, arm / distance)
    aside = pin.tangential.si + distance * pin.angular.si
    outwards = np.multiply.outer(pin.radial.si, outward)
    return np.asarray(outwards + np.multiply.outer(aside, round_it))


def _offset(errors: spec.Errors, gear: Gear, gears: Mapping[str, Gear]) -> Offset:
    installation = np.zeros(3)
    if isinstance(errors.installation, spec.Offset):
        amount, direction = errors.installation.amount.si, errors.installation.direction.si
        installation = polar(amount, direction) @ gear.plane
    elif errors.installation is not None:
        installation = vector_of(errors.installation)
    if errors.pin is not None and gear.carrier is not None:
        installation = installation + _pin(errors.pin, gear, gears[gear.carrier])
    given = errors.eccentricity
    if given is None:
        return Offset(installation, np.zeros(2))
    return Offset(installation, polar(given.amount.si, given.direction.si + given.phase.si))
