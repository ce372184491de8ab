r"""Bending of the thin rims of internal gears, in harmonics.

A rim that bends without stretching moves at the angle ψ outwards by :math:`a \cos n\psi +
b \sin n\psi` and tangentially by :math:`(-a \sin n\psi + b \cos n\psi)/n`. The component along
the line of action enters the approach of its meshes, and its energy is
:math:`\tfrac12 k_n (a^2 + b^2)`. A harmonic is written as a body of the train that does not turn,
on a support of stiffness k_n.

Source: formulation, section 12; Timoshenko, Strength of Materials II, for the thin ring.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from loadshare import case as spec
from loadshare.train.gear import Gear, Vector, cross


def with_harmonics(case: spec.Case, gears: Mapping[str, Gear]) -> dict[str, Gear]:
    """Return the gears, with the harmonics of their rims added as bodies.

    Parameters
    ----------
    case : spec.Case
    gears : mapping of str to Gear
    """
    found = dict(gears)
    for name, gear in case.gears.items():
        for n, stiffness in enumerate(gear.rim_stiffnesses, start=2):
            found[f"{name}: harmonic {n}"] = replace(
                gears[name],
                name=f"{name}: harmonic {n}",
                kind="harmonic",
                frame=gears[name].plane,
                teeth=None,
                support=np.full(2, stiffness),
                held=True,
                rim_of=name,
                harmonic=n,
            )
    return found


def bent(
    ring: str, partner: Gear, push: Vector, gears: Mapping[str, Gear]
) -> Iterator[tuple[str, Vector]]:
    """Yield the harmonics of a ring's rim, and the component of a mesh's push on each.

    Parameters
    ----------
    ring : str
    partner : Gear
        Gear in whose direction the mesh lies.
    push : ndarray, shape (3,)
        Along the line of action.
    gears : mapping of str to Gear
    """
    for name, gear in gears.items():
        if gear.rim_of != ring:
            continue
        x, y = gear.frame @ (partner.centre - gear.centre)
        outwards = (x * gear.frame[0] + y * gear.frame[1]) / math.hypot(x, y)
        out, round_it = push @ outwards, push @ cross(gear.axis, outwards)
        at, n = gear.harmonic * math.atan2(y, x), gear.harmonic
        amplitudes = (
            out * math.cos(at) - round_it * math.sin(at) / n,
            out * math.sin(at) + round_it * math.cos(at) / n,
        )
        yield name, np.asarray(amplitudes @ gear.frame)
