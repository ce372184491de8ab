"""Where gears stand: centres and axes as vectors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeAlias

from loadshare.case.gears import Gear, Polar

Vector: TypeAlias = tuple[float, float, float]

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


def centres_of(gears: Mapping[str, Gear]) -> dict[str, Vector]:
    """Return the centres of gears [m].

    Parameters
    ----------
    gears : mapping of str to Gear
        The gears, by name.

    Returns
    -------
    dict of str to tuple of float
        The centres, by name; without those given from a gear that is not there or from themselves.
    """
    placed: dict[str, Vector] = {}
    waiting = dict(gears)
    while waiting:
        ready = {
            name: centre
            for name, gear in waiting.items()
            if (centre := _centre(gear, placed)) is not None
        }
        if not ready:
            break
        placed |= ready
        waiting = {name: gear for name, gear in waiting.items() if name not in ready}
    return {name: placed[name] for name in gears if name in placed}


def dot(a: Vector, b: Vector) -> float:
    """Return the inner product of two vectors."""
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def minus(a: Vector, b: Vector) -> Vector:
    """Return the difference of two vectors."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _centre(gear: Gear, placed: Mapping[str, Vector]) -> Vector | None:
    centre = gear.centre
    if not isinstance(centre, Polar):
        x, y, z = (*(part.si for part in centre), 0.0)[:3]
        return (x, y, z)
    if centre.about is not None and centre.about not in placed:
        return None
    x, y, z = placed[centre.about] if centre.about is not None else (0.0, 0.0, 0.0)
    distance, angle = centre.distance.si, centre.angle.si
    return (
        x + distance * math.cos(angle),
        y + distance * math.sin(angle),
        z + centre.height.si,
    )
