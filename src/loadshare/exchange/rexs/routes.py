"""Routes of torque through couplings and shafts without gears."""

from __future__ import annotations

from typing import NamedTuple

from loadshare.exchange.rexs.gearing import Gearing, Joint
from loadshare.exchange.rexs.model import COUPLINGS, Component, transmits

Route = tuple[Joint, ...]
"""Couplings one after the other, each seen from the shaft from which it is reached."""


class Applied(NamedTuple):
    """A load, the shaft on which it is, and the body that takes it.

    `route` leads from the shaft to that of the body, if the shaft itself has no body.
    """

    load: Component
    shaft: Component
    body: str
    route: Route = ()

    @property
    def end(self) -> Component:
        """The shaft of the body."""
        return self.route[-1].other if self.route else self.shaft


def routes_from(of: Gearing, shaft: Component) -> list[Route]:
    """Return the routes from a shaft to the next ones with gears or carriers, and to the casing.

    No route leads through a shaft at which three couplings meet: there is no single stiffness for
    the torque between pairs of these.
    """
    found: list[Route] = []
    open_: list[Route] = [(joint,) for joint in _couplings(of, shaft)]
    while open_:
        route = open_.pop(0)
        end = route[-1].other
        if of.on_shaft(end) or end.id in of.casing:
            found.append(route)
        elif end.type == "shaft" and end is not shaft and len(onward := _couplings(of, end)) == 2:
            passed = {joint.part.id for joint in route}
            open_ += [(*route, joint) for joint in onward if joint.part.id not in passed]
    return found


def opposite(side: str) -> str:
    """Return the other side of a bearing or coupling."""
    return "outer" if side == "inner" else "inner"


def nearest_to(of: Gearing, route: Route) -> tuple[str, float]:
    """Return the body nearest to the end of a route, and how far ahead of it that is [m]."""
    last = route[-1]
    return of.nearest(last.other, last.part, opposite(last.side))


def applied_loads(of: Gearing) -> list[Applied]:
    """Return the loads that reach a gear or carrier."""
    found = []
    for shaft, load in of.model.parts:
        if shaft.type != "shaft" or load.type != "external_load":
            continue
        if of.on_shaft(shaft):
            found.append(Applied(load, shaft, of.nearest(shaft, load)[0]))
            continue
        ways = [route for route in routes_from(of, shaft) if of.on_shaft(route[-1].other)]
        if ways:
            found.append(Applied(load, shaft, nearest_to(of, ways[0])[0], ways[0]))
    return found


def _couplings(of: Gearing, shaft: Component) -> list[Joint]:
    """Return the couplings of a shaft that transmit torque."""
    return [
        joint
        for joint in of.joints.get(shaft.id, [])
        if joint.part.type in COUPLINGS and transmits(joint.part)
    ]
