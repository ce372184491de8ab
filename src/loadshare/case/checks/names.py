"""Checks that what a case names exists, and that its groups are complete."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator

from loadshare.case.content import ABOUT, ENDS, FLOATS
from loadshare.case.draft import Draft
from loadshare.case.gears import Polar
from loadshare.case.keys import Path, dotted, ends_of, look_up, unmatched, walk
from loadshare.case.measured import COEFFICIENTS
from loadshare.case.words import choices, did_you_mean
from loadshare.errors import Problem


def check_gear_names(draft: Draft) -> Iterator[Problem]:
    """Yield every mention of a gear that does not exist."""
    gears, carriers = draft.names("gears"), carriers_in(draft)
    for path, name in _gears_named(draft):
        if gears and name not in gears and not _of_unmade(draft, name):
            of_planet = path[0] == "gears" and path[-1] == "carrier"
            known, allowed = (
                (carriers, allowed_carriers(carriers)) if of_planet else (gears, choices(gears))
            )
            copies = _copies(name, gears)
            hint = did_you_mean(name, known)
            if name and copies:
                hint = _unequal(draft, path, gears) or f"Give one: {', '.join(copies)}."
            yield draft.problem(path, f'"{name}" is not a gear', allowed, hint)


def _of_unmade(draft: Draft, name: str) -> bool:
    """Return whether a name is that of a copy that was not made, because of another problem."""
    gears = draft.names("gears")
    unmade = [g for g in gears if look_up(draft.data, ("gears", g, "copies")) is not None]
    return any(_copies(gear, [name]) for gear in unmade)


def _copies(name: str, gears: list[str]) -> list[str]:
    return [g for g in gears if g.startswith(name) and g[len(name) :].isdecimal()]


def _unequal(draft: Draft, path: Path, gears: list[str]) -> str:
    """Say that a mesh or shaft joins gears with different numbers of copies."""
    name = str(path[1])
    of = {"meshes": draft.meshes.get(name), "shafts": draft.shafts.get(name)}.get(str(path[0]))
    ends = of.ends if of is not None else ()
    counts = {end: len(_copies(end, gears)) for end in ends if end and end not in gears}
    if len(set(counts.values()) - {0}) < 2:
        return ""
    (one, first), (other, second) = counts.items()
    return f"{one} has {first} copies, {other} has {second}, but copies are joined in pairs."


def carriers_in(draft: Draft) -> list[str]:
    """Return the names of all carriers, the invalid ones as well."""
    return [
        name
        for name in draft.names("gears")
        if look_up(draft.data, ("gears", name, "type")) == "carrier"
    ]


def allowed_carriers(carriers: list[str]) -> str:
    """Say what a planet may name as its carrier."""
    return choices(carriers) if carriers else 'a gear of type = "carrier"'


def check_mesh_names(draft: Draft) -> Iterator[Problem]:
    """Yield every mention of a mesh that does not exist."""
    meshes = draft.names("meshes")
    for path, name in _meshes_named(draft):
        ends = ends_of(name, ()) or ()
        if meshes and name not in meshes and not any(_of_unmade(draft, end) for end in ends):
            hint = did_you_mean(name, meshes)
            yield draft.problem(path, f'"{name}" is not a mesh', choices(meshes), hint)


def check_about_circles(draft: Draft) -> Iterator[Problem]:
    """Yield centres whose chain of poles leads back to themselves."""
    about = {
        name: gear.centre.about
        for name, gear in draft.gears.items()
        if isinstance(gear.centre, Polar) and gear.centre.about is not None
    }
    reported: set[str] = set()
    for name in about:
        chain = [name]
        while (pole := about.get(chain[-1])) is not None and pole not in chain:
            chain.append(pole)
        if pole == name and name not in reported:
            reported.update(chain)
            circle = " → ".join((*chain, name))
            yield draft.problem(("gears", name, "centre", "about"), f"is circular: {circle}")


def check_pairs(draft: Draft) -> Iterator[Problem]:
    """Yield meshes and shafts of a gear with itself, and pairs that mesh twice."""
    seen: dict[frozenset[str], str] = {}
    for name, mesh in draft.meshes.items():
        pair = frozenset(mesh.ends)
        if mesh.driver and len(pair) == 1:
            yield draft.problem(("meshes", name), "a gear cannot mesh with itself")
        elif pair in seen:
            message = f'joins the same gears as "{seen[pair]}"'
            yield draft.problem(("meshes", name), message, hint="Drop one of the two.")
        elif mesh.driver:
            seen[pair] = name
    for name, shaft in draft.shafts.items():
        if shaft.ends[0] and shaft.ends[0] == shaft.ends[1]:
            yield draft.problem(("shafts", name), "a shaft cannot join a gear to itself")


def _gears_named(draft: Draft) -> Iterator[tuple[Path, str]]:
    yield from _texts(draft, "gears", "centre", "about")
    yield from _texts(draft, "gears", "carrier")
    gears = draft.names("gears")
    for section, keys in ENDS.items():
        valid = getattr(draft, section)
        for name in draft.names(section):
            # A name that gives no two gears was reported already.
            ends = () if name in valid else ends_of(name, gears) or ()
            for number, key in enumerate(keys):
                path: Path = (section, name, key)
                given = look_up(draft.data, path) is not None
                if name in valid:
                    named = getattr(valid[name], key)
                    for gear in (named,) if isinstance(named, str) else named:
                        if gear or given:
                            yield path if given else path[:-1], gear
                elif given:
                    yield from _texts_at(draft, path)
                else:
                    by_name = ends if len(keys) == 1 else ends[number : number + 1]
                    yield from ((path[:-1], gear) for gear in by_name)
    for section in (*FLOATS, "errors"):
        # A blank name was reported already.
        yield from (((section, name), name) for name in draft.names(section) if name.strip())
    yield from _texts(draft, "rings", "neighbours")
    yield from _texts_at(draft, ("operating", "input"))
    yield from _texts_at(draft, ("operating", "output"))
    for name in draft.operating.external if draft.operating is not None else ():
        yield ("operating", "external", name), name
    for name in draft.operating.forces if draft.operating is not None else ():
        yield ("operating", "forces", name), name
    yield from _texts_at(draft, ("march", "gear"))


def _meshes_named(draft: Draft) -> Iterator[tuple[Path, str]]:
    for keys in (
        ("rings", "float", "upward"),
        ("rings", "float", "downward"),
        ("stages", "meshes"),
    ):
        yield from _texts(draft, *keys)


def _texts(draft: Draft, section: str, *keys: str) -> Iterator[tuple[Path, str]]:
    """Yield the texts at a key of every element, also of one with other problems."""
    for name in draft.names(section):
        yield from _texts_at(draft, (section, name, *keys))


def _texts_at(draft: Draft, path: Path) -> Iterator[tuple[Path, str]]:
    """Yield a text, or the texts of a list, with their places; nothing for what is neither."""
    value = look_up(draft.data, path)
    if isinstance(value, str):
        yield path, value
    elif isinstance(value, list):
        yield from (((*path, k), v) for k, v in enumerate(value) if isinstance(v, str))


def check_stage_groups(draft: Draft) -> Iterator[Problem]:
    """Yield meshes that a stage names twice or in series, and groups that do not partition it."""
    for name, stage in draft.stages.items():
        path = ("stages", name)
        yield from _in_series(draft, path, stage.meshes)
        twice = [mesh for mesh, count in Counter(stage.meshes).items() if count > 1]
        if twice:
            yield draft.problem((*path, "meshes"), f"names {', '.join(twice)} more than once")
        if stage.groups is None:
            continue
        grouped = Counter(mesh for group in stage.groups for mesh in group)
        for mesh, count in grouped.items():
            if mesh not in stage.meshes:
                yield draft.problem((*path, "groups"), f'"{mesh}" is not among the stage\'s meshes')
            elif count > 1:
                yield draft.problem((*path, "groups"), f'"{mesh}" is in {count} groups')
        left = [mesh for mesh in dict.fromkeys(stage.meshes) if mesh not in grouped]
        if left:
            yield draft.problem((*path, "groups"), f"{', '.join(left)} is in no group")


def _in_series(draft: Draft, path: Path, meshes: Iterable[str]) -> Iterator[Problem]:
    """Yield a gear that meshes of a stage name on both sides: their torques are not comparable."""
    ends = {name: draft.meshes[name].ends for name in meshes if name in draft.meshes}
    first = {pair[0]: name for name, pair in ends.items()}
    second = {pair[1]: name for name, pair in ends.items()}
    for gear in sorted(g for g in first.keys() & second.keys() if first[g] != second[g]):
        message = f"has gear {gear} first in {first[gear]} and second in {second[gear]}"
        hint = "A stage has one mesh of every branch, each named with the corresponding gear first."
        yield draft.problem((*path, "meshes"), message, hint=hint)
        return


SYSTEM = "system"


def check_measured_names(draft: Draft) -> Iterator[Problem]:
    """Yield measured figures of meshes or stages that do not exist or are in no stage."""
    shared = [m for stage in draft.stages.values() for m in stage.meshes]
    for name, measurement in draft.measured.items():
        for quantity in ("torque", *COEFFICIENTS):
            known = draft.names("meshes") if quantity == "torque" else shared
            what = "a mesh" if quantity == "torque" else "a mesh of a stage"
            if quantity.endswith("omega"):
                known, what = [*draft.names("stages"), SYSTEM], "a stage"
            for key in getattr(measurement, quantity) or ():
                if known and key not in known:
                    path = ("measured", name, quantity, key)
                    hint = did_you_mean(key, known)
                    yield draft.problem(path, f'"{key}" is not {what}', choices(known), hint)


def check_measured_positions(draft: Draft) -> Iterator[Problem]:
    """Yield measurements at positions that the case does not have."""
    if draft.operating is None or (draft.march is None and draft.operating.cycle == "common"):
        # The number of positions follows from the speeds.
        return
    count = draft.operating.positions if draft.march is None else draft.march.steps
    for name, measurement in draft.measured.items():
        if measurement.position is not None and measurement.position > count:
            path = ("measured", name, "position")
            yield draft.problem(
                path, f"the case has positions 1 to {count}", f"1 to {count}, or left out"
            )


def check_assumed_patterns(draft: Draft) -> Iterator[Problem]:
    """Yield patterns of `assumed` that match no key of the case."""
    known = tuple(path for path in walk(draft.data) if path[0] not in ABOUT)
    for number, is_path in unmatched(draft.assumed, known):
        path = ("assumed", number)
        if not is_path:
            allowed = 'a text such as "gears.*.base_radius"'
            yield draft.problem(path, "is not a key path", allowed)
        else:
            hint = did_you_mean(draft.assumed[number], [dotted(key) for key in known])
            yield draft.problem(path, "matches no key of the case", hint=hint)
