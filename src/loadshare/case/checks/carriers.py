"""Checks that planets fit their carriers, and that nothing held by the housing has to turn."""

from __future__ import annotations

import math
from collections.abc import Iterator

from loadshare.case.checks.fit import ANGLE_TOLERANCE, parallel
from loadshare.case.checks.names import allowed_carriers, carriers_in
from loadshare.case.draft import Draft
from loadshare.case.gears import Gear
from loadshare.case.keys import Path
from loadshare.case.line_of_action import centre_distance
from loadshare.case.place import Vector, minus
from loadshare.case.power_flow import backwards, reach, rides_on
from loadshare.case.words import choices
from loadshare.errors import Problem

SAME = 1e-9
"""Difference of clockings that counts as round-off, relative to their sum."""


def check_carriers(draft: Draft) -> Iterator[Problem]:
    """Yield gears named as carriers that are none, and planets that cannot ride on theirs."""
    centres = draft.centres()
    for name, gear in draft.gears.items():
        # A gear may be named "", which is reported elsewhere; only None means no carrier.
        carrier = None if gear.carrier is None else draft.gears.get(gear.carrier)
        if carrier is None:
            continue
        path: Path = ("gears", name, "carrier")
        if not carrier.is_carrier:
            what = f'"{gear.carrier}" is not a carrier'
            yield draft.problem(path, what, allowed_carriers(carriers_in(draft)))
        elif not parallel(gear, carrier):
            yield draft.problem(path, "its axis is not parallel to that of the planet")
        elif name in centres and gear.carrier in centres:
            apart = minus(centres[name], centres[gear.carrier])
            if centre_distance(carrier, apart) <= ANGLE_TOLERANCE * gear.acting_radius:
                yield draft.problem(path, "the planet is on the carrier's axis")


def check_planet_shafts(draft: Draft) -> Iterator[Problem]:
    """Yield shafts that join a planet to a gear that does not ride on the same carrier."""
    for name, shaft in draft.shafts.items():
        riding = {end: draft.gears[end].carrier for end in shaft.ends if end in draft.gears}
        carriers = [draft.gears.get(carrier) for carrier in riding.values() if carrier]
        known = all(carrier is not None and carrier.is_carrier for carrier in carriers)
        if known and len(set(riding.values())) > 1:
            planet = next(end for end, carrier in riding.items() if carrier)
            what = f"planet {planet} rides on {riding[planet]}, the other end does not"
            hint = "Both ends of a planet's shaft must ride on the same carrier."
            yield draft.problem(("shafts", name), what, hint=hint)


def check_planet_meshes(draft: Draft) -> Iterator[Problem]:
    """Yield meshes of carriers, and partners that a revolving planet cannot mesh with."""
    centres = draft.centres()
    for name, mesh in draft.meshes.items():
        ends = [draft.gears.get(mesh.driver), draft.gears.get(mesh.driven)]
        path: Path = ("meshes", name)
        for end, gear in zip(mesh.ends, ends, strict=True):
            if gear is not None and gear.is_carrier:
                yield draft.problem(path, f"{end} is a carrier and has no teeth")
        carrier = rides_on(draft.gears, *mesh.ends)
        holder = None if carrier is None else draft.gears.get(carrier)
        if carrier is None or holder is None or not holder.is_carrier:
            continue
        for end, gear in zip(mesh.ends, ends, strict=True):
            if gear is None or gear.is_carrier or gear.carrier == carrier:
                continue
            if gear.carrier is not None:
                what = f"a planet of carrier {carrier} cannot mesh with one of {gear.carrier}"
                yield draft.problem(path, what)
            elif not {end, carrier} <= centres.keys():
                continue
            elif not _coaxial(holder, gear, minus(centres[end], centres[carrier])):
                what = f"gear {end} is not on the axis of carrier {carrier}"
                hint = "A planet meshes with gears that ride on its carrier or turn about its axis."
                yield draft.problem(path, what, hint=hint)


def check_names_of_planet_meshes(draft: Draft) -> Iterator[Problem]:
    """Yield meshes with backlash that name their planet first where others name it last.

    Backlash is behind the flank with which the gear named first drives. If meshes of one central
    gear named their planets in both orders, some would begin in contact and some with all their
    backlash.
    """
    named: dict[tuple[str, str], dict[bool, str]] = {}
    for name, mesh in draft.meshes.items():
        carrier = rides_on(draft.gears, *mesh.ends)
        riding = [end in draft.gears and draft.gears[end].carrier == carrier for end in mesh.ends]
        if carrier is None or riding[0] == riding[1] or not mesh.has_backlash:
            continue
        planet_first = riding[0]
        central = mesh.driven if planet_first else mesh.driver
        known = named.setdefault((central, carrier), {})
        known.setdefault(planet_first, name)
        if len(known) == 2 and known[planet_first] == name:
            other = known[not planet_first]
            what = f"names its planet {'first' if planet_first else 'last'}, but {other} does not"
            hint = (
                "Backlash is behind the flank with which the gear named first drives: name all "
                f"meshes of {central} with planets of {carrier} in the same order."
            )
            yield draft.problem(("meshes", name), what, hint=hint)


def check_held(draft: Draft) -> Iterator[Problem]:
    """Yield held gears that would have to turn, or that rigid shafts hold a second time."""
    held = {name for name, gear in draft.gears.items() if gear.held}
    operating, march = draft.operating, draft.march
    turning = {operating.input: "the input", operating.output: "the output"} if operating else {}
    if march is not None:
        turning.setdefault(march.gear, "the gear whose revolutions are counted")
    for name in sorted(held & turning.keys()):
        at_output = operating is not None and name == operating.output
        hint = "The driven machine takes its torque." if at_output else ""
        what = f"is {turning[name]}, which turns"
        yield draft.problem(("gears", name, "held"), what, "false, or left out", hint)
    if operating is None:
        return
    fixed = held | {operating.output}
    for name in sorted(held):
        others = _on_rigid_shafts(draft, name) & fixed - {name}
        if others:
            what = f"rigid shafts join it to {choices(sorted(others))}, which is held as well"
            yield draft.problem(("gears", name, "held"), what, hint="Hold only one of them.")


def check_twisted_shafts(draft: Draft) -> Iterator[Problem]:
    """Yield elastic shafts whose ends cannot turn relative to each other."""
    if draft.operating is None:
        return
    fixed = {name for name, gear in draft.gears.items() if gear.held} | {draft.operating.output}
    for name, shaft in draft.shafts.items():
        if shaft.stiffness == "rigid" or not draft.gears.keys() >= set(shaft.ends):
            continue
        first, second = (_on_rigid_shafts(draft, end) for end in shaft.ends)
        joined, still = first == second, (sorted(first & fixed), sorted(second & fixed))
        if joined or all(still):
            what = "cannot twist: " + (
                f"rigid shafts join {shaft.ends[0]} and {shaft.ends[1]} as well"
                if joined
                else f"neither {still[0][0]} nor {still[1][0]} turns"
            )
            hint = "Leave the shaft out, or let one end turn without the other."
            yield draft.problem(("shafts", name), what, hint=hint)


def check_clockings(draft: Draft) -> Iterator[Problem]:
    """Yield rigid shafts whose clocking contradicts other rigid shafts between their ends."""
    rigid = {name: s for name, s in draft.shafts.items() if s.stiffness == "rigid"}
    lags: dict[str, float] = {}
    size = SAME * math.fsum(abs(shaft.clocking.si) for shaft in rigid.values())
    while rigid:
        ahead = next((n for n, s in rigid.items() if not lags.keys().isdisjoint(s.ends)), None)
        if ahead is None:
            lags[next(iter(rigid.values())).ends[0]] = 0.0
            continue
        shaft = rigid.pop(ahead)
        first, second = shaft.ends
        lag = shaft.clocking.si
        if first in lags and second in lags:
            other = lags[second] - lags[first]
            if abs(other - lag) > size:
                what = f"is not {other:.6g} rad, which other rigid shafts between its ends give"
                hint = "Make the clockings agree, or give one of these shafts a stiffness."
                yield draft.problem(("shafts", ahead, "clocking"), what, hint=hint)
        elif first in lags:
            lags[second] = lags[first] + lag
        else:
            lags[first] = lags[second] - lag


def check_planet_errors(draft: Draft) -> Iterator[Problem]:
    """Yield pin errors of gears that are no planets, and drums that involve planets."""
    for name, errors in draft.errors.items():
        gear = draft.gears.get(name)
        if errors.pin is not None and gear is not None and gear.carrier is None:
            hint = f"Give gears.{name}.carrier, or give the error as installation."
            yield draft.problem(("errors", name, "pin"), "is for planets only", hint=hint)
    for name, ring in draft.rings.items():
        for other in (name, *(ring.neighbours or ())):
            if ring.neighbours and rides_on(draft.gears, other):
                what = f"gear {other} rides on a carrier, but only circles can limit planets"
                yield draft.problem(("rings", name), what, hint="Give a radius.")


def _on_rigid_shafts(draft: Draft, start: str) -> set[str]:
    rigid = [shaft.ends for shaft in draft.shafts.values() if shaft.stiffness == "rigid"]
    return reach([start], [*rigid, *backwards(rigid)])


def _coaxial(carrier: Gear, gear: Gear, offset: Vector) -> bool:
    near = centre_distance(carrier, offset) <= ANGLE_TOLERANCE * gear.acting_radius
    return near and parallel(carrier, gear)
