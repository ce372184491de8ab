"""Consistency of the torques and speeds of a REXS unit, and the case with its further torques."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.exchange.imported import Data
from loadshare.exchange.rexs.flow import Flow
from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.quantities import torque_of
from loadshare.train.gear import Gear
from loadshare.train.geometry import geometry_of

RPM = 30.0 / math.pi
"""Revolutions per minute of one radian per second."""
ALIKE = 1e-2
"""Difference up to which a given torque or speed agrees with the others and is not reported,
relative to the larger value: files give few digits, and losses [-]."""


def balanced(of: Gearing, data: Data, flow: Flow, assumed: list[str], left_out: list[str]) -> Data:
    """Return a case with the torques added that act on neither input nor output.

    Parameters
    ----------
    of : Gearing
    data : Data
        The case without them.
    flow : Flow
    assumed, left_out : list of str
        Receive the remarks on torques and speeds.
    """
    speeds = _speeds(of, flow)
    unknown = f"{flow.first}: no speed is given; it is assumed to run in the sense of its torque"
    if not flow.others and not flow.output and not speeds:
        assumed += [] if flow.speed else [unknown]
        return data
    try:
        # Senses of rotation do not depend on the signs of torques.
        geometry = geometry_of(Case(_loaded(data, flow.others)))
    except CaseError:
        assumed += [] if flow.speed else [unknown]
        left_out += [f"{name}: a torque that the case cannot represent" for name in flow.others]
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
        assumed.append(f"{name}: an additional torque of {along:.6g} N·m in its sense of rotation")
    if flow.output:
        assumed += _contradiction(flow, gears[flow.last], power)
    return _loaded(data, external)


def _loaded(data: Data, torques: Mapping[str, float]) -> Data:
    """Return a case with further torques [N·m]."""
    if not torques:
        return data
    external = {name: torque_of(torque) for name, torque in torques.items()}
    return {**data, "operating": {**data["operating"], "external": external}}


def _turning(
    flow: Flow, speeds: dict[tuple[str, str], float], gears: Mapping[str, Gear]
) -> tuple[float, str] | None:
    """Return the input's speed [rad/s], positive in the case's running sense, and a remark on it.

    It follows from the speed of the first other shaft that gives one; None if there is none.
    """
    for (shaft, name), given in speeds.items():
        if rate := gears[name].ratio * gears[name].sense:
            speed = given / rate
            sense = gears[flow.first].sense * speed
            running = "counter-clockwise" if sense > 0.0 else "clockwise"
            return speed, (
                f"{flow.first}: no speed is given; from that of {shaft}, it runs {running} at "
                f"{abs(speed) * RPM:.6g} rpm"
            )
    return None


def _reversed(data: Data, flow: Flow) -> tuple[Data, Flow]:
    """Return a case and its flow, running the other way under the same torque."""
    back = "clockwise" if flow.running == "counter-clockwise" else "counter-clockwise"
    operating = data["operating"] | {"running": back, "torque": torque_of(-flow.torque)}
    return {**data, "operating": operating}, replace(flow, running=back, torque=-flow.torque)


def _speeds(of: Gearing, flow: Flow) -> dict[tuple[str, str], float]:
    """Return the given speeds about the axes of bodies [rad/s], by shaft and body.

    The input is left out, and so are planets, whose speed files may give relative to the pin.
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
    """Say which shafts have a speed other than follows from the input's speed and the teeth."""
    found: list[str] = []
    if not flow.speed:
        return found
    for (shaft, name), given in speeds.items():
        expected = gears[name].ratio * gears[name].sense * abs(flow.speed)
        if expected and abs(given - expected) > ALIKE * max(abs(given), abs(expected)):
            rpm = [f"{speed * RPM:.6g}" for speed in (given, expected)]
            found.append(
                f"{name}: {shaft} is given a speed of {rpm[0]} rpm; from that of the input, the "
                f"teeth give {rpm[1]} rpm, which is used"
            )
    return found


def _contradiction(flow: Flow, last: Gear, power: float) -> list[str]:
    """Say if the output's torque does not balance a power, given per input speed [N·m]."""
    if not last.ratio:
        return []
    needed, given = -power / abs(last.ratio), flow.output * last.running
    if abs(given - needed) <= ALIKE * max(abs(given), abs(needed)):
        return []
    return [
        f"{flow.last}: the load on the output gives {given:.6g} N·m in its sense of rotation; the "
        f"others leave {needed:.6g} N·m, which is used"
    ]
