"""Torsional links between bodies: shafts that twist, and couplings."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from loadshare.exchange.rexs.gearing import Gearing, Joint
from loadshare.exchange.rexs.holding import NEAR
from loadshare.exchange.rexs.model import Component
from loadshare.exchange.rexs.routes import Route, nearest_to, opposite, routes_from
from loadshare.exchange.rexs.shafts import twist_between

RIGID = 1e15
"""Torsional stiffness from which a link counts as rigid [N·m/rad]."""


@dataclass(frozen=True)
class Links:
    """Torsional links between bodies, and to the casing.

    Attributes
    ----------
    shafts : dict
        Shafts of a case.
    held : list of str
        Names of the bodies that a coupling, or their place in the casing, holds.
    used : set of str
        Ids of the couplings that these contain.
    """

    shafts: dict[str, dict[str, Any]] = field(default_factory=dict)
    held: list[str] = field(default_factory=list)
    used: set[str] = field(default_factory=set)


def links_of(of: Gearing, assumed: list[str]) -> Links:
    """Return the torsional links between the bodies of a unit."""
    links = Links()
    for shaft in of.model.of_type("shaft"):
        _add_neighbours(links, of, shaft, assumed)
    for route in _routes(of):
        if route[-1].other.id in of.casing:
            name, _ = of.nearest(route[0].shaft, route[0].part, route[0].side)
            links.held.append(name)
            links.used.update(joint.part.id for joint in route)
            if any(joint.part.number("rotational_stiffness") for joint in route):
                assumed.append(f"{name}: its coupling to the casing is rigid")
        else:
            _add_route(links, of, route, assumed)
    for whole, part in of.model.parts:
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


def _routes(of: Gearing) -> list[Route]:
    """Return the routes between bodies through couplings, and to the casing, each once."""
    found: dict[frozenset[str], Route] = {}
    for coupling, *both in of.coupled:
        for shaft in both:
            for route in routes_from(of, shaft) if of.on_shaft(shaft) else ():
                if route[0].part is coupling:
                    found.setdefault(frozenset(joint.part.id for joint in route), route)
    return list(found.values())


def _add_route(links: Links, of: Gearing, route: Route, assumed: list[str]) -> None:
    """Add the torsion between the bodies at both ends of a route through couplings."""
    first, last = route[0], route[-1]
    one, to_one = of.nearest(first.shaft, first.part, first.side)
    other, to_other = nearest_to(of, route)
    if one == other or {f"{one}-{other}", f"{other}-{one}"} & set(links.shafts):
        return
    yields = sum(_compliance(joint.part, assumed) for joint in route)
    yields += sum(_between(of, *pair, assumed) for pair in pairwise(route))
    for shaft, name, way, part in (
        (first.shaft, one, to_one, first.part),
        (last.other, other, to_other, last.part),
    ):
        yields += _way(of, shaft, (name, way), part, assumed)
        yields += _seat(of, shaft, name, assumed)
    links.shafts[f"{one}-{other}"] = {"stiffness": _stiffness(yields)}
    links.used.update(joint.part.id for joint in route)


def _between(of: Gearing, one: Joint, other: Joint, assumed: list[str]) -> float:
    """Return the compliance of a shaft without gears between two couplings [rad/(N·m)]."""
    shaft = other.shaft
    places = (
        of.places.along(one.part, shaft, opposite(one.side)),
        of.places.along(other.part, shaft, other.side),
    )
    start, stop = sorted(place or 0.0 for place in places)
    if None in places or stop - start < NEAR:
        why = (
            "no places along it are given" if None in places else "both couplings are at one place"
        )
        assumed.append(f"{shaft.title()}: rigid between its couplings, as {why}")
        return 0.0
    return _twist(of, shaft, (start, stop), f"{shaft.title()} between its couplings", assumed)


def _seat(of: Gearing, shaft: Component, name: str, assumed: list[str]) -> float:
    """Return the compliance of the coupling between a carrier and its shaft; 0 for other bodies."""
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
    """Return the compliance of a shaft from a coupling to the body nearest to it [rad/(N·m)].

    It is 0 if the coupling is between two bodies: it then counts as being at the nearest one.
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
    """Return the compliance of a shaft between two places along it [rad/(N·m)]."""
    twist = twist_between(of, shaft, *between)
    if twist.assumed:
        assumed.append(f"{what}: {twist.assumed}")
    return twist.compliance


def _compliance(coupling: Component, assumed: list[str]) -> float:
    """Return the compliance of a coupling [rad/(N·m)]; 0 if its stiffness is not given."""
    stiffness = coupling.number("rotational_stiffness")
    if stiffness is None and coupling.type != "rigid_connection":
        assumed.append(f"{coupling.title()}: no torsional stiffness is given; it is rigid")
    return 1.0 / stiffness if stiffness else 0.0


def _stiffness(yields: float) -> str:
    return f"{1.0 / yields:.12g} N*m/rad" if yields * RIGID > 1.0 else "rigid"
