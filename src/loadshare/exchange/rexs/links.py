"""What joins bodies around their axes: shafts that twist, and couplings."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from loadshare.exchange.rexs.beam import NEAR
from loadshare.exchange.rexs.gearing import Gearing, transmits
from loadshare.exchange.rexs.model import Component
from loadshare.exchange.rexs.shafts import torsion_between

RIGID = 1e15
"""Torsional stiffness from which on a link counts as rigid [N·m/rad]."""


@dataclass(frozen=True)
class Links:
    """What joins bodies around their axes.

    Attributes
    ----------
    shafts : dict
        Shafts of a case.
    held : list of str
        Names of the bodies that a coupling, or their place in the casing, holds.
    used : set of str
        Ids of the couplings that are in these.
    """

    shafts: dict[str, dict[str, Any]] = field(default_factory=dict)
    held: list[str] = field(default_factory=list)
    used: set[str] = field(default_factory=set)


def links_of(of: Gearing, assumed: list[str]) -> Links:
    """Return what joins the bodies of a unit around their axes."""
    links = Links()
    for shaft in of.model.of_type("shaft"):
        _add_neighbours(links, of, shaft, assumed)
    for coupling, inner, outer in of.coupled:
        if not transmits(coupling):
            continue
        if of.on_shaft(inner) and of.on_shaft(outer):
            _add_coupling(links, of, (coupling, inner, outer), assumed)
        for shaft, fixed, side in ((inner, outer, "inner"), (outer, inner, "outer")):
            if fixed.id in of.casing and of.on_shaft(shaft):
                name, _ = of.nearest(shaft, coupling, side)
                links.held.append(name)
                links.used.add(coupling.id)
                if coupling.number("rotational_stiffness"):
                    assumed.append(f"{name}: its coupling to the casing is rigid")
    for whole, part in of.model.related("assembly", "assembly", "part"):
        if whole.id in of.casing and part in of.gears:
            links.held.append(of.names[part.id])
    return links


def _add_neighbours(links: Links, of: Gearing, shaft: Component, assumed: list[str]) -> None:
    """Add the torsion between neighbours on a shaft."""
    bodies = of.on_shaft(shaft)
    for (u, one), (v, other) in pairwise(bodies):
        yields = _twist(of, shaft, (u, v), f"shaft {one}-{other}", assumed)
        yields += sum(_seat(of, shaft, name, assumed) for name in (one, other))
        links.shafts[f"{one}-{other}"] = {"stiffness": _stiffness(yields)}
    if shaft.id in of.carrier_shafts and (coupling := of.joint(shaft)[1]) is not None:
        links.used.add(coupling.id)


def _add_coupling(
    links: Links, of: Gearing, joined: tuple[Component, Component, Component], assumed: list[str]
) -> None:
    """Add a coupling between the bodies nearest to it on two shafts."""
    coupling, inner, outer = joined
    one, to_one = of.nearest(inner, coupling, "inner")
    other, to_other = of.nearest(outer, coupling, "outer")
    if one == other or {f"{one}-{other}", f"{other}-{one}"} & set(links.shafts):
        return
    yields = _compliance(coupling, assumed)
    for shaft, name, way in ((inner, one, to_one), (outer, other, to_other)):
        yields += _way(of, shaft, (name, way), coupling, assumed)
        yields += _seat(of, shaft, name, assumed)
    links.shafts[f"{one}-{other}"] = {"stiffness": _stiffness(yields)}
    links.used.add(coupling.id)


def _seat(of: Gearing, shaft: Component, name: str, assumed: list[str]) -> float:
    """How far the coupling twists by which a body sits on a shaft, if it is its carrier."""
    carrier = of.carrier_shafts.get(shaft.id)
    if carrier is None or of.names[carrier.id] != name:
        return 0.0
    coupling = of.joint(shaft)[1]
    return 0.0 if coupling is None else _compliance(coupling, assumed)


def _way(
    of: Gearing,
    shaft: Component,
    nearest: tuple[str, float],
    coupling: Component,
    assumed: list[str],
) -> float:
    """What a shaft twists from its body nearest to a coupling to the coupling [rad/(N·m)].

    Between two bodies it is nothing, as there the coupling counts as at the nearest.
    """
    name, way = nearest
    bodies = of.on_shaft(shaft)
    place = next(place for place, body in bodies if body == name)
    if abs(way) < NEAR:
        return 0.0
    if bodies[0][0] <= place + way <= bodies[-1][0]:
        assumed.append(f"{coupling.title()}: at {name}, though between two bodies of its shaft")
        return 0.0
    start, stop = sorted((place, place + way))
    return _twist(of, shaft, (start, stop), f"shaft {name} to {coupling.title()}", assumed)


def _twist(
    of: Gearing, shaft: Component, between: tuple[float, float], what: str, assumed: list[str]
) -> float:
    """What a shaft twists between two places along it [rad/(N·m)]."""
    stiffness = torsion_between(of, shaft, *between)
    if stiffness is None:
        assumed.append(f"{what}: rigid, its sections do not tell")
        return 0.0
    return 1.0 / stiffness


def _compliance(coupling: Component, assumed: list[str]) -> float:
    """How far a coupling twists [rad/(N·m)]; not at all if its stiffness is not given."""
    stiffness = coupling.number("rotational_stiffness")
    if stiffness is None and coupling.type != "rigid_connection":
        assumed.append(f"{coupling.title()}: no torsional stiffness is given, it is rigid")
    return 1.0 / stiffness if stiffness else 0.0


def _stiffness(yields: float) -> str:
    return f"{1.0 / yields:.12g} N*m/rad" if yields * RIGID > 1.0 else "rigid"
