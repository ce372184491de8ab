"""How far an element is from leaving the state that it has in an active set."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.contact.radial import RadialLaw
from loadshare.scene.scene import Array
from loadshare.study.branch.active import Place, corner
from loadshare.study.branch.elements import Hold, Touch
from loadshare.study.branch.units import Units

LOOSE = 1e-9
"""Approach per move that nothing resists, from which on a contact's approach is undetermined."""


class Gauge(NamedTuple):
    """A distance to the end of a state: positive as long as the state holds.

    Attributes
    ----------
    element : str
    value : float
        In deflections (an approach, a radius) or loads (a force).
    to : Place or None
        Where a radial element goes when it turns negative; None flips a contact.
    gradient : ndarray, shape (n,) or None
        Of an open contact's gauge with respect to the coordinates; for undetermined ones.
    """

    element: str
    value: float
    to: Place | None
    gradient: Array | None = None


def contact_gauges(touch: Touch, is_closed: bool, loose: Array, units: Units) -> list[Gauge]:
    """Gauge of a contact; none for an open one whose approach is undetermined.

    Parameters
    ----------
    touch : Touch
    is_closed : bool
    loose : ndarray, shape (n, d)
        Directions of the coordinates that nothing resists.
    units : Units
    """
    name = touch.row.name
    if touch.unknown is not None:
        return [Gauge(name, touch.force / units.force, None)]
    if is_closed:
        return [Gauge(name, touch.approach / units.length, None)]
    if not touch.vector.any() or np.abs(touch.vector @ loose).max(initial=0.0) > LOOSE:
        return []
    return [Gauge(name, -touch.approach / units.length, None, touch.vector)]


def radial_gauges(hold: Hold, units: Units) -> list[Gauge]:
    """Gauges of a radial element: towards the piece or step before, and the one after."""
    law, k, name = hold.law, hold.piece, hold.radial.name
    found = []
    if hold.unknown is not None:
        low, high = law.step(k)
        size = float(np.linalg.norm(hold.force))
        if hold.radius > 0.0 and hold.unknown.stop - hold.unknown.start == 1:
            size = float(hold.force @ hold.offset) / hold.radius
        if k > 0:
            back = Place(law.pieces[k - 1].name)
            found.append(Gauge(name, (size - low) / units.force, back))
        if k < len(law.pieces):
            onward = Place(law.pieces[k].name)
            found.append(Gauge(name, (high - size) / units.force, onward))
        return found
    begin, end = law.start(k), law.start(k + 1)
    if k > 0:
        to = corner(law, k) if _jumps(law, k) else Place(law.pieces[k - 1].name)
        found.append(Gauge(name, (hold.radius - begin) / units.length, to))
    if np.isfinite(end):
        last = k + 1 == len(law.pieces)
        to = corner(law, k + 1) if last or _jumps(law, k + 1) else Place(law.pieces[k + 1].name)
        found.append(Gauge(name, (end - hold.radius) / units.length, to))
    return found


def _jumps(law: RadialLaw, k: int) -> bool:
    low, high = law.step(k)
    return high > low
