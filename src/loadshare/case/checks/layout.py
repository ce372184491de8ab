"""Checks on the positions of gears: what must be given, and the room that teeth need."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

from loadshare.case.checks.fit import ANGLE_TOLERANCE, OVERLAP, mm, parallel, toothed_pairs
from loadshare.case.draft import Draft
from loadshare.case.gears import Polar, Tooth, shortened
from loadshare.case.line_of_action import centre_distance, common_width
from loadshare.case.place import Vector, along_z, axis_of, dot, minus, on_axis
from loadshare.case.quantity import LENGTH
from loadshare.errors import Problem
from loadshare.involute import base_distance, normal_backlash, root_clearance, tip_limit, tips_pass

APART = 0.1
"""Largest distance between axes that a shaft joins, relative to the smaller base radius [-]."""
WRITTEN = 1e-2
"""Largest excess of tips that is put down to rounding in the file, in modules [-]."""


def check_distances(draft: Draft) -> Iterator[Problem]:
    """Yield gears whose distance from a pole is neither given nor follows from teeth."""
    if not draft.sound("gears", "meshes"):
        return
    centres = draft.centres()
    for name, gear in draft.gears.items():
        centre = gear.centre
        if not isinstance(centre, Polar) or centre.distance is not None or name in centres:
            continue
        if centre.about is None or centre.about in centres:
            pole = centres[centre.about] if centre.about is not None else (0.0, 0.0, 0.0)
            path = ("gears", name, "centre", "distance")
            hint = _what_is_missing(draft, name, centre.about, pole, centres)
            yield draft.problem(path, "is missing", LENGTH.allowed, hint)


def _what_is_missing(
    draft: Draft, name: str, about: str | None, pole: Vector, centres: Mapping[str, Vector]
) -> str:
    """Say which keys would let a distance follow from teeth."""
    partners = {end for mesh in draft.meshes.values() if name in mesh.ends for end in mesh.ends}
    there = sorted(
        partner
        for partner in partners & draft.gears.keys() - {name}
        if partner == about
        or (
            partner in centres
            and not draft.gears[partner].is_carrier
            and on_axis(pole, centres[partner], draft.gears[partner].acting_radius)
        )
    )
    if not there:
        with_whom = f"with {about} or " if about is not None else ""
        origin = "" if about is not None else " (the origin, unless about names a gear)"
        return (
            f"It follows only if the gear meshes {with_whom}with a gear on the axis of its pole"
            f"{origin}."
        )
    bare = [n for n in (name, *there) if draft.gears[n].tooth is None]
    if bare:
        return f"It follows from the teeth: give teeth and module of {' and '.join(bare)}."
    if not all(along_z(draft.gears[n]) for n in (name, *there)):
        return "It follows from the teeth only if the axes are along z."
    return f"The teeth of {name} and {there[0]} cannot mesh without backlash at any distance."


def check_tips(draft: Draft) -> Iterator[Problem]:
    """Yield meshing gears whose tips find no room in each other's teeth."""
    for name, ends, teeth, distance in toothed_pairs(draft):
        overlap = OVERLAP * teeth[0].module
        if base_distance(*teeth) >= distance or normal_backlash(*teeth, distance) < -overlap:
            continue  # reported already
        for (one, two), (gear, other) in (
            (ends, teeth),
            (ends[::-1], teeth[::-1]),
        ):
            room = _room(gear, other, distance)
            if other.kind * (other.tip - room) > WRITTEN * other.module:
                yield _too_high(draft, name, one, two, other, room)
        if teeth[0].kind * teeth[1].kind < 0:
            pinion, ring = sorted(teeth, key=lambda tooth: tooth.internal)
            if not tips_pass(pinion, ring, distance):
                fits = _passing(pinion, ring, distance)
                outer = ends[teeth.index(ring)]
                what = (
                    f"the tips of {' and '.join(ends)} interfere beside the line of action, with "
                    f"a tooth difference of {ring.teeth - pinion.teeth}"
                )
                allowed = f"a tip radius of gear {outer} of at least {mm(fits)}"
                hint = f"It is {mm(ring.tip)}; {_lowered(draft, outer, ring, fits)}"
                yield draft.problem(("meshes", name), what, allowed, hint)


def _room(gear: Tooth, other: Tooth, distance: float) -> float:
    """Return the other gear's limiting tip radius [m]: the largest if external, else the least."""
    touches = other.tip + other.kind * root_clearance(gear, other, distance)
    if gear.internal:
        return touches
    begins = tip_limit(gear, other, distance)
    return max(touches, begins) if other.internal else min(touches, begins)


def _too_high(draft: Draft, mesh: str, one: str, two: str, other: Tooth, room: float) -> Problem:
    """Say how far the tip of a gear is too high for another, and what would fit."""
    side = "at least" if other.internal else "at most"
    what = f"the tip of gear {two}, at a radius of {mm(other.tip)}, has no room in gear {one}"
    hint = _lowered(draft, two, other, room)
    return draft.problem(("meshes", mesh), what, f"a tip radius of {side} {mm(room)}", hint)


def _lowered(draft: Draft, gear: str, tooth: Tooth, tip: float) -> str:
    """Say which alteration brings the tip of a gear to a radius [m]."""
    lower = tooth.addendum_to(tip) - (draft.gears[gear].addendum or 1.0)
    return f"gears.{gear}.tip_alteration = {shortened(lower * tooth.module)} would do."


def _passing(pinion: Tooth, ring: Tooth, distance: float) -> float:
    """Return the least tip radius of an internal gear that its pinion's tips pass [m]."""
    low, high = ring.tip, distance + pinion.tip
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        passes = tips_pass(pinion, replace(ring, addendum=ring.addendum_to(middle)), distance)
        low, high = (low, middle) if passes else (middle, high)
    return high


def check_shafts(draft: Draft) -> Iterator[Problem]:
    """Yield shafts between parallel axes that are far apart: most likely a wrong name.

    Gears that do not give their teeth are skipped: their centres may be merely schematic.
    """
    centres = draft.centres()
    for name, shaft in draft.shafts.items():
        if not centres.keys() & draft.gears.keys() >= set(shaft.ends):
            continue
        one, two = (draft.gears[end] for end in shaft.ends)
        if one.carrier != two.carrier:
            continue  # reported already
        radii = [gear.acting_radius for gear in (one, two) if gear.tooth is not None]
        if not parallel(one, two) or len(radii) + one.is_carrier + two.is_carrier < 2:
            continue
        apart = centre_distance(one, minus(*(centres[end] for end in reversed(shaft.ends))))
        if radii and apart > APART * min(radii):
            hint = "A shaft joins gears on the same axis."
            yield draft.problem(("shafts", name), f"is between axes {mm(apart)} apart", hint=hint)


@dataclass(frozen=True, slots=True)
class _Clash:
    """Two gears whose tip circles overlap, by how much, and how far apart they are [m]."""

    one: str
    two: str
    over: float
    apart: float

    @property
    def pair(self) -> frozenset[str]:
        return frozenset((self.one, self.two))


def check_neighbours(draft: Draft) -> Iterator[Problem]:
    """Yield gears that mesh with the same gear and overlap each other."""
    centres = draft.centres()
    meshing = {frozenset(mesh.ends) for mesh in draft.meshes.values()}
    shafts = {frozenset(shaft.ends) for shaft in draft.shafts.values()}
    reported: set[frozenset[str]] = set()
    for middle in sorted(draft.gears.keys() & centres.keys()):
        others = set().union(*(pair for pair in meshing if middle in pair)) - {middle}
        clashes = [
            clash
            for one, two in combinations(sorted(others & centres.keys()), 2)
            if (clash := _clash(draft, one, two, centres)) is not None
            and clash.pair not in meshing
            and (clash.apart or clash.pair not in shafts)
        ]
        if clashes and not any(clash.pair in reported for clash in clashes):
            yield _in_the_way(draft, middle, max(clashes, key=lambda c: c.over), centres)
        reported |= {clash.pair for clash in clashes}


def _clash(draft: Draft, one: str, two: str, centres: Mapping[str, Vector]) -> _Clash | None:
    """Return how two gears overlap, or None; where places along the axis differ, by face width."""
    here, there = draft.gears[one], draft.gears[two]
    if here.tooth is None or there.tooth is None or "internal" in (here.type, there.type):
        return None
    axis = axis_of(here)
    if abs(dot(axis, axis_of(there))) < 1.0 - ANGLE_TOLERANCE:
        return None
    offset = minus(centres[two], centres[one])
    along = abs(dot(offset, axis))
    if along > ANGLE_TOLERANCE * here.tooth.radius and not common_width(here, there, along):
        return None
    apart = centre_distance(here, offset)
    over = here.tooth.tip + there.tooth.tip - apart
    if over <= WRITTEN * here.tooth.module:
        return None
    return _Clash(one, two, over, apart if apart > ANGLE_TOLERANCE * here.tooth.radius else 0.0)


def _in_the_way(draft: Draft, middle: str, clash: _Clash, centres: Mapping[str, Vector]) -> Problem:
    """Say how two gears overlap, and how many would fit."""
    path = ("gears", clash.two, "centre")
    aside = "give them different places along the axis if they are side by side"
    tips = [t.tip for n in (clash.one, clash.two) if (t := draft.gears[n].tooth) is not None]
    if not clash.apart:
        what = f"is the same as that of gear {clash.one}, and both mesh with {middle}"
        hint = f"Join them by a shaft if they are one body, or {aside}."
        if not math.isclose(*tips, rel_tol=ANGLE_TOLERANCE):
            outer = clash.one if tips[0] > tips[1] else clash.two
            hint += f' If gear {outer} is a ring around the other, it needs type = "internal".'
        return draft.problem(path, what, hint=hint)
    what = f"is too close to gear {clash.one}: their tip circles overlap by {mm(clash.over)}"
    radii = [
        centre_distance(draft.gears[n], minus(centres[middle], centres[n]))
        for n in (clash.one, clash.two)
    ]
    hint = f"Or {aside}."
    if math.isclose(*radii, rel_tol=ANGLE_TOLERANCE) and math.isclose(
        *tips, rel_tol=ANGLE_TOLERANCE
    ):
        room = int(math.pi / math.asin(min(tips[0] / radii[0], 1.0)))
        hint = f"At most {room} such gears fit evenly spaced about {middle}. {hint}"
    return draft.problem(path, what, f"centres more than {mm(sum(tips))} apart", hint)
