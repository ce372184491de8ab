"""Input and output of a REXS unit: where the torque enters, and where it leaves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.model import Component, may_turn
from loadshare.exchange.rexs.routes import Applied, applied_loads

Lacks = Callable[[Component | str, str], None]
"""Reports what a component, or the unit, lacks."""


@dataclass(frozen=True)
class Flow:
    """Input and output of a unit.

    Attributes
    ----------
    first, last : str
        Names of the input and of the output.
    torque : float
        Torque on the input, in its running sense [N·m].
    running : str
        Sense about the axis of the input.
    output : float
        Torque that the file gives on the output, about its axis [N·m]; 0 where it gives none.
    others : dict of str to float
        Torques on other bodies, about their axes [N·m].
    left_out : list of str
        Remarks on loads without a torque that are on neither input nor output.
    speed : float
        Speed of the input about its axis [rad/s]; 0 where the file gives none.
    """

    first: str
    last: str
    torque: float
    running: str
    output: float
    others: dict[str, float]
    left_out: list[str]
    speed: float


def flow_of(of: Gearing, assumed: list[str], lacks: Lacks) -> Flow | None:
    """Return input and output of a unit; None where `lacks` reports what is missing."""
    loads = [applied for applied in applied_loads(of) if may_turn(applied.load)]
    driving = [applied for applied in loads if _torque(applied.load)]
    # A load that takes power is the input only if no other can be.
    driving.sort(key=lambda each: (not each.load.holds("defines_torque"), -np.sign(_power(each))))
    if not driving:
        lacks("", "has no external_load with a torque_around_u_axis on a shaft with gears")
        return None
    given = driving[0]
    first = given.body
    same = [applied for applied in loads if _are_one(of, applied, given)]
    others = sorted((applied for applied in loads if applied not in same), key=_as_output)
    if not others:
        reached = {applied.load.id for applied in loads}
        beside = [e.title() for e in of.model.of_type("external_load") if e.id not in reached]
        more = f"; {', '.join(beside)}: transmits no torque to a gear" if beside else ""
        lacks("", f"has no second shaft with an external_load: the output is not known{more}")
        return None
    torque = sum(of.sense(each.shaft, first) * _torque(each.load) for each in same)
    if not torque:
        lacks(given.load, "is balanced by other loads of its shaft: no torque is left")
        return None
    added = [each for each in same if _torque(each.load)]
    if len(added) > 1:
        assumed.append(f"{first}: the sum of the torques of {len(added)} loads on its shaft")
    output, beside, further = 0.0, [], dict[str, float]()
    for each in others:
        amount = of.sense(each.shaft, each.body) * _torque(each.load)
        if _are_one(of, each, others[0]):
            output += of.sense(each.shaft, others[0].body) * _torque(each.load)
        elif amount:
            further[each.body] = further.get(each.body, 0.0) + amount
        else:
            beside.append(f"{each.load.title()}: it is neither on the input nor on the output")
    turning = [
        of.sense(shaft, first) * speed
        for shaft in (given.shaft, given.end)
        if (speed := shaft.number("rotational_speed"))
    ]
    ahead = [*turning, torque][0] > 0.0
    running = "counter-clockwise" if ahead else "clockwise"
    driven = torque if ahead else -torque
    speed = [*turning, 0.0][0]
    return Flow(first, others[0].body, driven, running, output, further, beside, speed)


def _torque(load: Component) -> float:
    return load.number("torque_around_u_axis") or 0.0


def _power(applied: Applied) -> float:
    """Return the power that a load puts in [W]; 0 where the speed of its shaft is not given."""
    speed = applied.shaft.number("rotational_speed") or applied.end.number("rotational_speed")
    return _torque(applied.load) * (speed or 0.0)


def _as_output(applied: Applied) -> tuple[int, float]:
    """Return a sort key of loads, lowest for the one most likely to be at the output.

    Loads without a torque come first, except mere forces, which come last; torques come in between,
    starting with the one that takes most power.
    """
    load = applied.load
    if _torque(load):
        return 1, _power(applied)
    forces = (load.number(f"force_{axis}_direction") for axis in "uvw")
    return (2 if any(forces) and not load.holds("transmits_torque") else 0), 0.0


def _are_one(of: Gearing, one: Applied, other: Applied) -> bool:
    """Return whether two loads are on one shaft, or on one carrier."""
    carrier = of.carrier_shafts.get(one.end.id)
    return one.end is other.end or (
        carrier is not None and of.carrier_shafts.get(other.end.id) is carrier
    )
