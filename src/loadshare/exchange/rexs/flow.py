"""Where the torque enters a REXS unit and leaves it, and whether it is balanced there."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.exchange.imported import Data
from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.model import Component, may_turn
from loadshare.exchange.rexs.quantities import torque_of
from loadshare.exchange.rexs.routes import Applied, applied_loads
from loadshare.train.gear import Gear
from loadshare.train.geometry import geometry_of

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
    output : float
        Torque that the file gives on the output, about its axis [N·m]; 0 where it gives none.
    others : dict of str to float
        Torques on other bodies, about their axes [N·m].
    left_out : list of str
        Loads without a torque that are on neither.
    speed : float
        Of the input about its axis [rad/s]; 0 where the file gives none.
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
    # What takes power is the input only where nothing else can be.
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
        assumed.append(f"{first}: the torques of {len(added)} loads on its shaft, added")
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
    """Power that a load puts in [W]; 0 where the speed of its shaft is not given."""
    speed = applied.shaft.number("rotational_speed") or applied.end.number("rotational_speed")
    return _torque(applied.load) * (speed or 0.0)


def _as_output(applied: Applied) -> tuple[int, float]:
    """How unlikely a load is the output's.

    One of which all is open is, a mere force is not; of several torques, what takes most power.
    """
    load = applied.load
    if _torque(load):
        return 1, _power(applied)
    forces = (load.number(f"force_{axis}_direction") for axis in "uvw")
    return (2 if any(forces) and not load.holds("transmits_torque") else 0), 0.0


def _are_one(of: Gearing, one: Applied, other: Applied) -> bool:
    """Whether two loads are on one shaft, or on one carrier."""
    carrier = of.carrier_shafts.get(one.end.id)
    return one.end is other.end or (
        carrier is not None and of.carrier_shafts.get(other.end.id) is carrier
    )


RPM = 30.0 / math.pi
"""Revolutions per minute of one radian per second."""
ALIKE = 1e-2
"""How far a given torque may be from what balances all others and need no word, as a part of the
larger one: files give few digits, and losses [-]."""


def balanced(of: Gearing, data: Data, flow: Flow, assumed: list[str], left_out: list[str]) -> Data:
    """Return a case with the torques on neither input nor output.

    Parameters
    ----------
    of : Gearing
    data : Data
        The case without them.
    flow : Flow
    assumed, left_out : list of str
        Take what is to be said of torques and speeds.
    """
    speeds = _speeds(of, flow)
    unknown = f"{flow.first}: no speed is given, it runs in the sense of its torque"
    if not flow.others and not flow.output and not speeds:
        assumed += [] if flow.speed else [unknown]
        return data
    try:
        # Senses of rotation do not depend on the signs.
        geometry = geometry_of(Case(_loaded(data, flow.others)))
    except CaseError:
        assumed += [] if flow.speed else [unknown]
        left_out += [f"{name}: a torque that the case cannot have as it is" for name in flow.others]
        return data
    gears = geometry.gears
    if not flow.speed:
        turning = _turning(flow, speeds, gears) if geometry.determined else None
        assumed.append(turning[1] if turning else unknown)
        if turning and turning[0] < 0.0:
            data, flow = _reversed(data, flow)
            gears = geometry_of(Case(_loaded(data, flow.others))).gears
        flow = replace(flow, speed=turning[0] if turning else 0.0)
    if geometry.determined:
        assumed += _other_speeds(flow, speeds, gears)
    power = flow.torque
    external: dict[str, float] = {}
    for name, torque in flow.others.items():
        external[name] = along = torque * (gears[name].running or gears[name].sense)
        power += along * abs(gears[name].ratio)
        assumed.append(f"{name}: a further torque of {along:.6g} N·m in its sense of rotation")
    if flow.output:
        assumed += _contradiction(flow, gears[flow.last], power)
    return _loaded(data, external)


def _loaded(data: Data, torques: Mapping[str, float]) -> Data:
    """A case with further torques [N·m]."""
    if not torques:
        return data
    external = {name: torque_of(torque) for name, torque in torques.items()}
    return {**data, "operating": {**data["operating"], "external": external}}


def _turning(
    flow: Flow, speeds: dict[tuple[str, str], float], gears: Mapping[str, Gear]
) -> tuple[float, str] | None:
    """Speed of the input in the sense in which the case has it [rad/s], and from where it is.

    It follows from that of the first other shaft; None where none is given.
    """
    for (shaft, name), given in speeds.items():
        if rate := gears[name].ratio * gears[name].sense:
            speed = given / rate
            sense = gears[flow.first].sense * speed
            running = "counter-clockwise" if sense > 0.0 else "clockwise"
            return speed, (
                f"{flow.first}: no speed is given; by that of {shaft} it runs {running} at "
                f"{abs(speed) * RPM:.6g} rpm"
            )
    return None


def _reversed(data: Data, flow: Flow) -> tuple[Data, Flow]:
    """Return a case, and its input, that run the other way under the same torque."""
    back = "clockwise" if flow.running == "counter-clockwise" else "counter-clockwise"
    operating = data["operating"] | {"running": back, "torque": torque_of(-flow.torque)}
    return {**data, "operating": operating}, replace(flow, running=back, torque=-flow.torque)


def _speeds(of: Gearing, flow: Flow) -> dict[tuple[str, str], float]:
    """Speeds about the axes of bodies [rad/s] beside the input's, by shaft and body.

    Not of planets, of which files may give the speed on their pins.
    """
    planets = {of.names[planet] for planet in of.carrier_of}
    found: dict[tuple[str, str], float] = {}
    for shaft in of.model.of_type("shaft"):
        speed, bodies = shaft.number("rotational_speed"), of.on_shaft(shaft)
        name = bodies[0][1] if bodies else flow.first
        if speed and name != flow.first and name not in planets:
            found[shaft.title(), name] = of.sense(shaft, name) * speed
    return found


def _other_speeds(
    flow: Flow, speeds: dict[tuple[str, str], float], gears: Mapping[str, Gear]
) -> list[str]:
    """Say which shafts are given another speed than follows from the input's and the teeth."""
    found: list[str] = []
    if not flow.speed:
        return found
    for (shaft, name), given in speeds.items():
        expected = gears[name].ratio * gears[name].sense * abs(flow.speed)
        if expected and abs(given - expected) > ALIKE * max(abs(given), abs(expected)):
            rpm = [f"{speed * RPM:.6g}" for speed in (given, expected)]
            found.append(
                f"{name}: {shaft} is given a speed of {rpm[0]} rpm; with that of the input, the "
                f"teeth make it {rpm[1]} rpm, which counts"
            )
    return found


def _contradiction(flow: Flow, last: Gear, power: float) -> list[str]:
    """Say if the output gives another torque than what balances a power, over the input's speed."""
    if not last.ratio:
        return []
    needed, given = -power / abs(last.ratio), flow.output * last.running
    if abs(given - needed) <= ALIKE * max(abs(given), abs(needed)):
        return []
    return [
        f"{flow.last}: the load on the output gives {given:.6g} N·m in its sense of rotation, the "
        f"others leave {needed:.6g} N·m, which counts"
    ]
