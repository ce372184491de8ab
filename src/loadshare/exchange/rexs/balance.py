"""Further torques on a REXS unit, and whether the one that its output gives balances them."""

from __future__ import annotations

from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.exchange.imported import Data
from loadshare.exchange.rexs.flow import Flow
from loadshare.exchange.rexs.quantities import torque_of
from loadshare.train.gear import Gear
from loadshare.train.geometry import geometry_of

ALIKE = 1e-2
"""How far a given torque may be from what balances all others and need no word, as a part of the
larger one: files give few digits, and losses [-]."""


def balanced(data: Data, flow: Flow, assumed: list[str], left_out: list[str]) -> Data:
    """Return a case with the torques on neither input nor output.

    Parameters
    ----------
    data : Data
        The case without them.
    flow : Flow
    assumed, left_out : list of str
        Take what is to be said of the torques.
    """
    if not flow.others and not flow.output:
        return data

    def loaded(torques: dict[str, float]) -> Data:
        if not torques:
            return data
        external = {name: torque_of(torque) for name, torque in torques.items()}
        return {**data, "operating": {**data["operating"], "external": external}}

    try:
        # Senses of rotation do not depend on the signs.
        gears = geometry_of(Case(loaded(flow.others))).gears
    except CaseError:
        left_out += [f"{name}: a torque that the case cannot have as it is" for name in flow.others]
        return data
    power = flow.torque
    external: dict[str, float] = {}
    for name, torque in flow.others.items():
        external[name] = along = torque * (gears[name].running or gears[name].sense)
        power += along * abs(gears[name].ratio)
        assumed.append(f"{name}: a further torque of {along:.6g} N·m in its sense of rotation")
    if flow.output:
        assumed += _contradiction(flow, gears[flow.last], power)
    return loaded(external)


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
