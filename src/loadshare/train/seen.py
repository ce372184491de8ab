"""Speeds of gears as seen from the carrier whose planets they mesh with."""

from __future__ import annotations

from collections.abc import Mapping

from loadshare.train.gear import Gear

STILL = 1e-9
"""Speed relative to a carrier, over the speed of the carrier, that counts as round-off [-]."""


def seen_from(gears: Mapping[str, Gear], driver: str, driven: str) -> str | None:
    """Return the carrier whose planets are in a mesh, if any."""
    return gears[driver].carrier or gears[driven].carrier


def along(gear: Gear, carrier: Gear) -> float:
    """Return ±1: the speed along a gear's sense of a body on a carrier, over the carrier's."""
    return gear.sense * carrier.sense * (1.0 if gear.axis @ carrier.axis > 0.0 else -1.0)


def speed_on(gear: Gear, carrier: Gear, speeds: tuple[float, float]) -> float:
    """Return the speed of a gear as seen from a carrier, along the gear's sense.

    Parameters
    ----------
    gear, carrier : Gear
    speeds : (float, float)
        Their speeds, along their senses.
    """
    carried = along(gear, carrier) * speeds[1]
    apart = speeds[0] - carried
    # A gear that turns with its carrier as one piece does not turn relative to it.
    return apart if abs(apart) > STILL * abs(carried) else 0.0


def speed_in_mesh(gears: Mapping[str, Gear], gear: str, partner: str) -> float:
    """Return the speed at which a gear's teeth pass through a mesh, over that of the input.

    A sun or ring may mesh with planets of two carriers, and with gears outside its set.
    """
    one, carrier = gears[gear], seen_from(gears, gear, partner)
    if carrier is None:
        return one.ratio
    return speed_on(one, gears[carrier], (one.ratio, gears[carrier].ratio))
