"""Positions of gears: centres and axes as vectors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeAlias

from loadshare.case.gears import Gear, Polar
from loadshare.case.meshes import Mesh
from loadshare.involute import distance_without_backlash

Vector: TypeAlias = tuple[float, float, float]
Placed: TypeAlias = Mapping[str, Vector]
"""Centres that are known, by gear."""
Near: TypeAlias = Mapping[str, Gear]
"""Gears that mesh with a given one, by name."""

COAXIAL = 1e-6
"""Largest distance between centres on one axis, relative to a size of the gear or mesh [-]."""

_AXES: dict[str, Vector] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def axis_of(gear: Gear) -> Vector:
    """Return the direction of a gear's axis, of length 1 [-].

    Parameters
    ----------
    gear : Gear
        The gear.

    Returns
    -------
    tuple of float
        The direction.
    """
    if isinstance(gear.axis, str):
        return _AXES[gear.axis]
    x, y, z = gear.axis
    length = math.hypot(x, y, z)
    return (x / length, y / length, z / length)


def centres_of(gears: Mapping[str, Gear], meshes: Mapping[str, Mesh]) -> dict[str, Vector]:
    """Return the centres of gears [m].

    A distance that is left out is the one at which the teeth mesh without backlash: with the pole
    itself, else with gears on the pole's axis. Of these, external pairs count first, and the
    largest distance that they need, as a smaller one has no room for the teeth; else the smallest
    of internal pairs.

    Parameters
    ----------
    gears : mapping of str to Gear
        The gears, by name.
    meshes : mapping of str to Mesh
        The meshes, from which distances follow.

    Returns
    -------
    dict of str to tuple of float
        The centres, by name. Left out are gears whose pole does not exist or depends on themselves,
        and those whose distance is neither given nor follows.
    """
    placed: dict[str, Vector] = {}
    partners: dict[str, dict[str, Gear]] = {name: {} for name in gears}
    for mesh in meshes.values():
        if set(mesh.ends) <= gears.keys():
            partners[mesh.driver][mesh.driven] = gears[mesh.driven]
            partners[mesh.driven][mesh.driver] = gears[mesh.driver]
    ready: dict[str, Vector] = {}
    while True:
        placed |= ready
        waiting = {n: g for n, g in gears.items() if n not in placed and _has_pole(g, placed)}
        # Given centres are placed first: what lies on an axis is known only then.
        for way in (_given, _from_pole, _from_axis):
            ready = {
                name: centre
                for name, gear in waiting.items()
                if (centre := way(gear, partners[name], placed)) is not None
            }
            if ready:
                break
        else:
            return {name: placed[name] for name in gears if name in placed}


def dot(a: Vector, b: Vector) -> float:
    """Return the inner product of two vectors."""
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def minus(a: Vector, b: Vector) -> Vector:
    """Return the difference of two vectors."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def on_axis(pole: Vector, centre: Vector, size: float) -> bool:
    """Tell whether a centre is on the axis of a pole along z, for a gear or mesh of a size [m]."""
    return math.hypot(centre[0] - pole[0], centre[1] - pole[1]) <= COAXIAL * size


def along_z(gear: Gear) -> bool:
    """Tell whether a gear's axis is along z, so that its teeth lie in the x-y plane."""
    return abs(axis_of(gear)[2]) == 1.0


def _has_pole(gear: Gear, placed: Placed) -> bool:
    centre = gear.centre
    return not isinstance(centre, Polar) or centre.about is None or centre.about in placed


def _given(gear: Gear, _partners: Near, placed: Placed) -> Vector | None:
    """Return the centre of a gear if it is given."""
    centre = gear.centre
    if not isinstance(centre, Polar):
        x, y, z = (*(part.si for part in centre), 0.0)[:3]
        return (x, y, z)
    return None if centre.distance is None else _polar(centre, centre.distance.si, placed)


def _from_pole(gear: Gear, partners: Near, placed: Placed) -> Vector | None:
    """Return the centre of a gear that meshes with its pole."""
    centre = gear.centre
    if not isinstance(centre, Polar) or centre.about is None or centre.about not in partners:
        return None
    distance = _apart(gear, partners[centre.about])
    return None if distance is None else _polar(centre, distance, placed)


def _from_axis(gear: Gear, partners: Near, placed: Placed) -> Vector | None:
    """Return the centre of a gear that meshes with others on its pole's axis."""
    centre = gear.centre
    if not isinstance(centre, Polar) or centre.about in partners:
        return None
    pole = _pole(centre, placed)
    external: list[float] = []
    internal: list[float] = []
    for partner, other in partners.items():
        distance = _apart(gear, other)
        if distance is None or partner not in placed:
            continue
        if on_axis(pole, placed[partner], distance):
            outer = "internal" in (gear.type, other.type)
            (internal if outer else external).append(distance)
    if not external and not internal:
        return None
    return _polar(centre, max(external) if external else min(internal), placed)


def _apart(one: Gear, two: Gear) -> float | None:
    """Return the distance at which two gears mesh without backlash [m], if their teeth give it."""
    if one.tooth is None or two.tooth is None or not (along_z(one) and along_z(two)):
        return None
    try:
        return distance_without_backlash(one.tooth, two.tooth)
    except ValueError:
        return None


def _pole(centre: Polar, placed: Placed) -> Vector:
    return placed[centre.about] if centre.about is not None else (0.0, 0.0, 0.0)


def _polar(centre: Polar, distance: float, placed: Placed) -> Vector:
    x, y, z = _pole(centre, placed)
    angle = centre.angle.si
    across, up = distance * math.cos(angle), distance * math.sin(angle)
    return (x + across, y + up, z + centre.height.si)
