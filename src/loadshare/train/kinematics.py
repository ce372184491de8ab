"""Running senses and speed ratios, found by walking from the input gear over meshes and shafts.

Planets and the gears that mesh with them are walked as seen from their carrier; the walk starts
again at gears that no mesh or shaft reaches. In planetary trains all senses found are then reversed
where the true speeds require it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from loadshare.case.power_flow import nearest_first, on_one_shaft
from loadshare.train.gear import Gear
from loadshare.train.mesh import MeshGeometryError, contact_of
from loadshare.train.planetary import members

RATIO_TOLERANCE = 1e-3
"""Largest relative difference between two paths' speed ratios that rounding of radii explains."""


@dataclass(frozen=True, slots=True)
class Conflict:
    """A mesh or shaft that contradicts the rest of the train."""

    key: str
    message: str


@dataclass(frozen=True, slots=True, eq=False)
class Kinematics:
    """Gears with their senses and ratios, and the contradictions found.

    Attributes
    ----------
    gears : mapping of str to Gear
    determined : bool
        Whether all speeds follow from that of the input.
    conflicts : tuple of Conflict
    """

    gears: Mapping[str, Gear]
    determined: bool = True
    conflicts: tuple[Conflict, ...] = ()


def settle(
    gears: Mapping[str, Gear],
    meshes: Mapping[str, tuple[str, str]],
    shafts: Mapping[str, tuple[str, str]],
    first: str,
) -> Kinematics:
    """Give every gear its running sense and speed ratio.

    Parameters
    ----------
    gears : mapping
        Gears whose senses and ratios are not settled, except those of `first`.
    meshes, shafts : mapping of str to (str, str)
        Driver and driven gear; the two ends.
    first : str
        The input gear.
    """
    carriers = {name: gear.carrier for name, gear in gears.items()}
    way = nearest_first(carriers, (*meshes.values(), *shafts.values()), first)
    starts = sorted(way, key=lambda name: carriers[name] is not None)
    planetary = any(gear.kind == "carrier" or gear.held for gear in gears.values())
    settled = {first: gears[first]}
    conflicts: list[Conflict] = []

    def mesh_partner(name: str, here: str) -> Iterator[Gear]:
        """Settle the partner of `here` over a mesh, walking along or against the power flow."""
        driver, driven = meshes[name]
        try:
            if here == driver:
                # The contact does not depend on the sense of the driven gear.
                forward = contact_of(settled[here], gears[driven])
                sense, other = forward.driven_sense, driven
            else:
                trial = replace(gears[driver], sense=1)
                forward = contact_of(trial, gears[driven])
                sense, other = settled[here].sense * forward.driven_sense, driver
        except MeshGeometryError as error:
            conflicts.append(Conflict(f'meshes."{name}"', str(error)))
            return
        ratio = settled[here].ratio * settled[here].base_radius / gears[other].base_radius
        yield replace(gears[other], sense=sense, ratio=ratio, relative=ratio)

    def shaft_partner(name: str, here: str) -> Iterator[Gear]:
        """Settle the gear at the other end of a shaft; opposed axes reverse the sense."""
        a, b = shafts[name]
        other = gears[b if here == a else a]
        sense, ratio = _sense_of(other, settled[here]), settled[here].ratio
        yield replace(other, sense=sense, ratio=ratio, relative=ratio)

    links = [(n, e, f'meshes."{n}"', mesh_partner) for n, e in meshes.items()]
    links += [(n, e, f'shafts."{n}"', shaft_partner) for n, e in shafts.items()]
    walked: set[str] = set()
    queue = deque([first])
    while queue or (planetary and len(settled) < len(gears)):
        if not queue:
            # A gear that turns with a carrier as one piece keeps this sense, that of the input.
            start = next(name for name in starts if name not in settled)
            settled[start] = replace(gears[start], sense=_sense_of(gears[start], gears[first]))
            queue.append(start)
        here = queue.popleft()
        for name, ends, key, partner in links:
            if here not in ends or key in walked:
                continue
            walked.add(key)
            for found in partner(name, here):
                known = settled.get(found.name)
                if known is None:
                    settled[found.name] = found
                    queue.append(found.name)
                elif not planetary:
                    conflicts += _compare(key, known, found)
    if planetary and not conflicts:
        try:
            turning = _as_shafts_turn(settled, shafts)
            turned, determined = members(turning, meshes, shafts, first)
            return Kinematics({name: turned[name] for name in way}, determined)
        except ValueError as error:
            conflicts.append(Conflict("operating.input", str(error)))
    in_order = {name: settled[name] for name in way if name in settled}
    return Kinematics(in_order, conflicts=tuple(conflicts))


def _sense_of(gear: Gear, other: Gear) -> int:
    """Return the sense of a gear that turns with another one; opposed axes reverse it."""
    return -other.sense if gear.axis @ other.axis < -1e-9 else other.sense


def _as_shafts_turn(
    gears: Mapping[str, Gear], shafts: Mapping[str, tuple[str, str]]
) -> dict[str, Gear]:
    """Return the gears with one sense for all that share a shaft, reversed on opposed axes.

    In a loop over several sets the walk may come back with the opposite sense. Rotations may be
    counted in either sense: meshes keep account of it (see `Mesh.senses`), so that shafts need
    not.
    """
    found = dict(gears)
    for first, *others in on_one_shaft(gears, shafts.values()):
        for other in others:
            found[other] = replace(gears[other], sense=_sense_of(gears[other], gears[first]))
    return found


def _compare(key: str, known: Gear, found: Gear) -> Iterator[Conflict]:
    if known.sense != found.sense:
        yield Conflict(
            key,
            f"would turn gear {known.name} against the sense in which another path turns it: "
            "the train would lock",
        )
    if abs(known.ratio - found.ratio) > RATIO_TOLERANCE * known.ratio:
        yield Conflict(
            key,
            f"would turn gear {known.name} at {found.ratio:.6g} of the input speed, another path "
            f"at {known.ratio:.6g}: the train would lock",
        )
