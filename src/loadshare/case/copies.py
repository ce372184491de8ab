"""Expansion of branches written once: a gear's `copies`, and all elements that name the gear.

A gear p with three copies is short for p1, p2 and p3, a mesh s-p for s-p1, s-p2 and s-p3, and the
bearing, ring, spline and errors of p for those of each copy. What is written for a single copy,
such as errors.p2, overrides what is written for all, even in another form: a stiffness overrides a
law.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator, Mapping, Sized
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from typing import Any

from loadshare.case.content import ENDS, FLOATS, Sections
from loadshare.case.element import elements_in, without_alternatives
from loadshare.case.gears import COPIES
from loadshare.case.keys import Path, dotted, ends_of, merge, parse
from loadshare.case.origin import Origin
from loadshare.case.quantity import ANGLE, Quantity
from loadshare.errors import CaseError, Problem

Data = dict[str, Any]
SAME = 1e-9
"""Largest angle between two copies that is put down to rounding [rad]."""


@dataclass(frozen=True, slots=True)
class _Pattern:
    """Angles [rad] by which the copies of each gear are turned."""

    turns: Mapping[str, tuple[float, ...]]

    def count(self, *names: str) -> int | None:
        """Return how many copies the named gears have; None if none of them has, or they differ."""
        counts = {len(self.turns[name]) for name in names if name in self.turns}
        return counts.pop() if len(counts) == 1 else None

    def of(self, name: str, k: int) -> str:
        """Return the name of copy k of a gear, from 1; a gear without copies keeps its name."""
        return f"{name}{k}" if name in self.turns else name


def with_copies(data: Data, origin: Origin) -> tuple[Data, Origin]:
    """Return a case's plain data with all copies written out, and the origin of their keys.

    An invalid `copies` is left as it is and reported when the gear is read.

    Raises
    ------
    CaseError
        If a copy would have the name of another gear, or the place of another copy.
    """
    gears = data.get("gears")
    turns = dict(_turns(gears)) if isinstance(gears, Mapping) else {}
    if not turns:
        return data, origin
    if wrong := [*_taken(data, origin, turns), *_together(data, origin, turns)]:
        raise CaseError(wrong)
    pattern, names = _Pattern(turns), list(data["gears"])
    made = {**data, "gears": {}}
    moved: list[tuple[Path, Path]] = []

    def spread(section: str, ends: Callable[[str, Any], tuple[str, ...]]) -> dict[str, list[str]]:
        """Write out a section; return the new names of each element that has copies."""
        before = data.get(section)
        if not isinstance(before, Mapping):
            return {}
        after: Data = {}
        became: dict[str, list[str]] = {}
        for name, element in before.items():
            count = pattern.count(*ends(name, element))
            if count is None:
                _merge_element(after, section, name, element)
                continue
            became[name] = []
            for k in range(1, count + 1):
                known = ends(name, element)
                new = _renamed(name, known, pattern, k)
                single = _copied(section, element, pattern, known, k)
                _merge_element(after, section, new, single, under=True)
                became[name].append(new)
                moved.append(((section, name), (section, new)))
        made[section] = after
        return became

    became = {s: spread(s, lambda name, _: (name,)) for s in ("gears", *FLOATS, "errors")}
    for section, keys in ENDS.items():
        became[section] = spread(section, partial(_ends, keys=keys, gears=names))
    _rename_in_stages(made, became["meshes"])
    if isinstance(made.get("assumed"), list):
        made["assumed"] = [p for given in made["assumed"] for p in _patterns(given, became)]
    files = dict(origin.files)
    for old, new in moved:
        inside = {k: f for k, f in origin.files.items() if k[: len(old)] == old}
        files |= {
            new + k[len(old) :]: f for k, f in inside.items() if new + k[len(old) :] not in files
        }
    return made, replace(origin, files=files)


def _turns(gears: Mapping[str, Any]) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Yield the gears whose copies can be written out, with the angles of the copies [rad]."""
    for name, gear in gears.items():
        given = gear.get("copies") if isinstance(gear, Mapping) else None
        centre = gear.get("centre") if given is not None else None
        if not isinstance(centre, Mapping) or _angle(centre.get("angle")) is None:
            continue
        if isinstance(given, int) and not isinstance(given, bool) and given in COPIES:
            yield name, tuple(2.0 * math.pi * k / given for k in range(given))
        elif isinstance(given, list) and len(given) in COPIES:
            angles = [_angle(angle) for angle in given]
            if None not in angles:
                yield name, tuple(angle for angle in angles if angle is not None)


def _taken(data: Data, origin: Origin, turns: Mapping[str, Sized]) -> Iterator[Problem]:
    """Yield a problem for each gear of its own that has the name of another gear's copy."""
    for name, copies in turns.items():
        for k in range(1, len(copies) + 1):
            own = data["gears"].get(f"{name}{k}")
            if not isinstance(own, Mapping):
                continue
            centre = own.get("centre")
            placed = isinstance(centre, list) or (
                isinstance(centre, Mapping) and {"angle"} < centre.keys() - {"height"}
            )
            if "copies" in own or (placed and {"teeth", "base_radius"} & own.keys()):
                message = f"is a separate gear with the name of copy {k} of {dotted((name,))}"
                hint = "Rename one of them; to change a copy, give only the keys that differ."
                yield origin.problem(data, ("gears", f"{name}{k}"), message, "", hint)


def _together(
    data: Data, origin: Origin, turns: Mapping[str, tuple[float, ...]]
) -> Iterator[Problem]:
    """Yield a problem for each gear with two copies in one place, unless one has its own centre.

    Gears that give their teeth are left to the check of all neighbours, which knows their widths.
    """
    for name, copies in turns.items():
        if "module" in data["gears"][name]:
            continue
        single = [data["gears"].get(f"{name}{k}") for k in range(1, len(copies) + 1)]
        moved = [isinstance(own, Mapping) and "centre" in own for own in single]
        places = [number for number, own in enumerate(moved) if not own]
        for one, two in combinations(places, 2):
            if abs(math.remainder(copies[two] - copies[one], math.tau)) < SAME:
                message = f"copies {one + 1} and {two + 1} are in the same place"
                allowed = "angles that differ by more than whole turns"
                yield origin.problem(data, ("gears", name, "copies"), message, allowed, "")
                break


def _angle(given: object) -> float | None:
    try:
        read = ANGLE.read(given)
    except ValueError:
        return None
    return read.si if isinstance(read, Quantity) else None


def _ends(name: str, element: Any, keys: tuple[str, ...], gears: list[str]) -> tuple[str, ...]:
    """Return the two gears of a mesh or shaft, as far as they are known."""
    given = [element.get(key) for key in keys] if isinstance(element, Mapping) else [None]
    if len(keys) == 1 and isinstance(given[0], list):
        given = given[0]
    by_name = ends_of(name, gears) or (None, None)
    ends = [t if t is not None else n for t, n in zip([*given, None][:2], by_name, strict=True)]
    return tuple(end for end in ends if isinstance(end, str))


def _renamed(name: str, ends: tuple[str, ...], pattern: _Pattern, k: int) -> str:
    """Return the name of copy k of an element."""
    if ends == (name,) or "-".join(ends) == name:
        return "-".join(pattern.of(end, k) for end in ends)
    return f"{name}{k}"


def _copied(section: str, element: Any, pattern: _Pattern, ends: tuple[str, ...], k: int) -> Any:
    """Return copy k of an element."""
    made = copy.deepcopy(element)
    if not isinstance(made, dict):
        return made
    for key in ENDS.get(section, ()):
        given = made.get(key)
        if isinstance(given, str):
            made[key] = pattern.of(given, k)
        elif isinstance(given, list):
            made[key] = [pattern.of(e, k) if isinstance(e, str) else e for e in given]
    if section == "gears":
        del made["copies"]
        centre = made["centre"]
        turned = math.degrees((_angle(centre["angle"]) or 0.0) + pattern.turns[ends[0]][k - 1])
        centre["angle"] = f"{round(turned, 12):.15g} deg"
        if isinstance(centre.get("about"), str):
            centre["about"] = pattern.of(centre["about"], k)
    return made


def _merge_element(
    table: Data, section: str, name: str, element: Any, *, under: bool = False
) -> None:
    """Add an element to a table, merged with one of its name; if `under`, existing keys win."""
    there = table.get(name)
    if isinstance(there, dict) and isinstance(element, Mapping):
        low, high = (element, there) if under else (there, element)
        model = next(elements_in(Sections.model_fields[section].annotation))
        table[name] = copy.deepcopy(without_alternatives(model, low, high))
        merge(table[name], high)
    elif name not in table or not under:
        table[name] = element


def _rename_in_stages(data: Data, meshes: Mapping[str, list[str]]) -> None:
    """Replace each mesh that a stage names by its copies, in place."""

    def named(given: Any) -> Any:
        if not isinstance(given, list):
            return given
        found: list[Any] = []
        for item in given:
            if isinstance(item, list):
                found.append(named(item))
            else:
                found += meshes.get(item, [item]) if isinstance(item, str) else [item]
        return found

    stages = data.get("stages")
    if isinstance(stages, Mapping):
        data["stages"] = {
            name: {
                **stage,
                **{key: named(stage[key]) for key in ("meshes", "groups") if key in stage},
            }
            if isinstance(stage, Mapping)
            else stage
            for name, stage in stages.items()
        }


def _patterns(given: Any, became: Mapping[str, Mapping[str, list[str]]]) -> list[Any]:
    """Return a pattern of `assumed`, written out for every copy of the element it names."""
    try:
        path = parse(given) if isinstance(given, str) else ()
    except ValueError:
        return [given]
    copies = became.get(str(path[0]), {}).get(str(path[1])) if len(path) > 1 else None
    if not copies:
        return [given]
    # The angles of the copies are what is left of their number.
    rest = ("centre", "angle") if path[0] == "gears" and path[2:] == ("copies",) else path[2:]
    return [dotted((path[0], name, *rest)) for name in copies]
