"""Where the torque enters a REXS unit and where it leaves it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.kinds import may_turn
from loadshare.exchange.rexs.model import Component
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
        On the input, in its running sense [N·m].
    running : str
        Sense about the axis of the input.
    left_out : list of str
        Loads that are on neither.
    """

    first: str
    last: str
    torque: float
    running: str
    left_out: list[str]


def flow_of(of: Gearing, assumed: list[str], lacks: Lacks) -> Flow | None:
    """Return input and output of a unit; None where `lacks` reports what is missing."""
    loads = [applied for applied in applied_loads(of) if may_turn(applied.load)]
    driving = [applied for applied in loads if _torque(applied.load)]
    driving.sort(key=lambda applied: not applied.load.holds("defines_torque"))
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
        assumed.append(f"{first}: the torques of {len(added)} loads on its shaft, added")
    beside = [
        f"{each.load.title()}: it is neither on the input nor on the output"
        for each in others[1:]
        if not _are_one(of, each, others[0])
    ]
    turning = [
        of.sense(shaft, first) * speed
        for shaft in (given.shaft, given.end)
        if (speed := shaft.number("rotational_speed"))
    ]
    ahead = [*turning, torque][0] > 0.0
    running = "counter-clockwise" if ahead else "clockwise"
    return Flow(first, others[0].body, torque if ahead else -torque, running, beside)


def _torque(load: Component) -> float:
    return load.number("torque_around_u_axis") or 0.0


def _as_output(applied: Applied) -> int:
    """How unlikely a load is the output's: one of which all is open is, a mere force is not."""
    load = applied.load
    if _torque(load):
        return 1
    forces = (load.number(f"force_{axis}_direction") for axis in "uvw")
    return 2 if any(forces) and not load.holds("transmits_torque") else 0


def _are_one(of: Gearing, one: Applied, other: Applied) -> bool:
    """Whether two loads are on one shaft, or on one carrier."""
    carrier = of.carrier_shafts.get(one.end.id)
    return one.end is other.end or (
        carrier is not None and of.carrier_shafts.get(other.end.id) is carrier
    )
