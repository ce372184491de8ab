"""Which parts of a REXS model cannot be used, and which are not used."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from loadshare.errors import Problem
from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.holding import CLEARANCES, STIFF, radial
from loadshare.exchange.rexs.model import (
    BEARINGS,
    COUPLINGS,
    GEARS,
    READ,
    Component,
    Unread,
    transmits,
)
from loadshare.exchange.rexs.routes import applied_loads

ON_AXIS = 1e-6
"""How far from an axis what sits on it may be unreported [m]."""
OVERLOOKED = ("normal_backlash", "runout", "angular_misalignment")
"""Words in the names of attributes that matter to load sharing but are not imported."""


def unread_values(path: Path, of: Gearing) -> list[Problem]:
    """Return a problem for every needed value that could not be read; equal ones are merged."""
    found: dict[tuple[str, str, str], list[tuple[Component, Unread]]] = {}
    for component in of.model.components.values():
        if component.type in READ:
            for name, value in component.attributes.items():
                if isinstance(value, Unread):
                    alike = name, value.message, value.allowed
                    found.setdefault(alike, []).append((component, value))
    problems = []
    for (name, message, allowed), both in found.items():
        component, value = both[0]
        more = f" ({len(both) - 1} more like it)" if len(both) > 1 else ""
        where = f"{component.type} {component.id}, {name}"
        problems.append(Problem(str(path), where, value.given, f"{message}{more}", allowed))
    return problems


def unplaced(of: Gearing) -> list[str]:
    """Return remarks on couplings and loads put at the start of their shaft for lack of a place."""
    parts = [
        (coupling, shaft, side, other.id not in of.casing)
        for coupling, inner, outer in of.coupled
        for shaft, side, other in ((inner, "inner", outer), (outer, "outer", inner))
    ]
    parts += [(each.load, each.shaft, "", False) for each in applied_loads(of)]
    return [
        f"{part.title()}: at the start of {shaft.title()}, as no place along it is given"
        for part, shaft, side, twists in parts
        if of.places.along(part, shaft, side) is None
        and (bodies := len(of.on_shaft(shaft)))
        and (bodies > 1 or (twists and of.sections(shaft)))
    ]


def beside_axes(of: Gearing) -> list[str]:
    """Return the bearings that are, or join shafts that are, beside the axis of one of these."""
    found = []
    for part, *both in of.joined(*BEARINGS):
        shafts = [side for side in both if side.type == "shaft"]
        off = max((of.places.off_axis(e, s) for s in shafts for e in (part, *shafts)), default=0.0)
        if off > ON_AXIS:
            found.append(
                f"{part.title()}: it and its shafts are assumed to be on one axis, though they are "
                f"{1e3 * off:.6g} mm apart"
            )
    return found


def contradictions(path: Path, of: Gearing) -> list[Problem]:
    """Return problems: fractions of teeth, negative modules."""
    problems = []
    for gear in of.gears:
        where = f"{gear.type} {gear.id}"
        teeth = gear.number("number_of_teeth")
        if teeth is not None and abs(teeth - round(teeth)) > 1e-6:
            where = f"{where}, number_of_teeth"
            problems.append(Problem(str(path), where, f"{teeth:g}", "is not a whole number"))
        module = gear.number("normal_module")
        if module is not None and module < 0.0:
            where, given = f"{gear.type} {gear.id}, normal_module", f"{1e3 * module:g} mm"
            hint = "An internal gear has a negative number of teeth, or is a ring_gear."
            why = "is negative"
            problems.append(Problem(str(path), where, given, why, "a module above 0", hint))
    return problems


def shared(path: Path, of: Gearing) -> list[Problem]:
    """Return a problem for every part that relations assign to several others, not to one."""
    owners: dict[tuple[str, str, str, str], dict[str, None]] = {}
    for part, (verb, kind), owner in _assigned(of):
        owners.setdefault((part.type, part.id, verb, kind), {})[owner] = None
    return [
        Problem(
            str(path),
            f"{type_} {id_}",
            "",
            f"{verb} {len(found)} {kind}s: {', '.join(sorted(found))}",
            f"one {kind}",
        )
        for (type_, id_, verb, kind), found in owners.items()
        if len(found) > 1
    ]


def _assigned(of: Gearing) -> Iterator[tuple[Component, tuple[str, str], str]]:
    """Yield parts that may belong to one other only, in which sense, and to what."""
    on_shaft, on_carrier = ("is on", "shaft"), ("is part of", "planet carrier")
    for whole, part in of.model.parts:
        if whole.type == "shaft" and part.type in (*GEARS, "external_load"):
            yield part, on_shaft, whole.id
        elif whole.type == "planet_carrier" and part.type == "shaft":
            yield part, on_carrier, whole.id
        elif whole.type == "planetary_stage" and part.type == "planet_carrier":
            yield whole, ("has", "planet carrier"), part.id
    for relation in ("planet_shaft", "planet_pin", "planet_carrier_shaft"):
        for stage, shaft in of.model.related(relation, "planetary_stage", "shaft"):
            if stage.id in of.carriers_of_stages:
                yield shaft, on_carrier, of.carriers_of_stages[stage.id].id
    for origin, material in of.model.related("reference", "origin", "referenced"):
        if material.type == "material" and origin.type in (*GEARS, "shaft", "shaft_section"):
            yield origin, ("has", "material"), material.id
    for part, inner, outer in of.joined(*BEARINGS, *COUPLINGS):
        yield part, ("has", "connection"), f"{inner.id} and {outer.id}"


def circular_places(path: Path, of: Gearing) -> list[Problem]:
    """Return a problem for every component whose position refers to others in a circle."""
    problems = []
    for body in placed(of):
        ids = [part.id for part in of.places.chain(body)]
        if ids[-1] in ids[:-1]:
            where = f"{body.type} {body.id}, reference_component_for_position"
            why = f"leads in a circle: {', '.join(ids)}"
            problems.append(
                Problem(str(path), where, ids[1], why, "references that end at the unit")
            )
    return problems


def unknown_references(of: Gearing) -> list[str]:
    """Return remarks on positions relative to components that the file does not have."""
    known = of.model.components
    found = Counter(
        id_ for body in placed(of) if (id_ := of.places.reference_id(body)) and id_ not in known
    )
    return [
        f"places of {count} components count from the unit: the file has no component {id_!r}, to "
        "which they refer"
        for id_, count in found.items()
    ]


def placed(of: Gearing) -> list[Component]:
    """Return the components whose places matter."""
    return of.model.of_type(*GEARS, *BEARINGS, *COUPLINGS, "planet_carrier", "shaft")


def unclear_couplings(path: Path, of: Gearing) -> list[Problem]:
    """Return a problem for every coupling that does not say if the unit's gear engages it."""
    problems = []
    for coupling in of.model.of_type(*COUPLINGS):
        given = coupling.attributes.get("is_engaged")
        if isinstance(given, tuple) and len(given) != 1 and not 0 < of.shift <= len(given):
            where = f"{coupling.type} {coupling.id}, is_engaged"
            why = f"is for {len(given)} gears, but gear_shift_index of the gear unit is {of.shift}"
            problems.append(Problem(str(path), where, "", why))
    return problems


def unused(of: Gearing, used: set[str]) -> list[str]:
    """Return remarks on stages, bearings, couplings and loads that are not in the case.

    Parameters
    ----------
    of : Gearing
    used : set of str
        Ids of the bearings and couplings that hold or join something in the case.
    """
    found = [
        f"stage {stage.id}: {one.title()} or {other.title()} turns freely, as its coupling is open"
        for stage, one, other in of.loose
    ]
    found += [
        f"stage {stage.id}: {one.title()} and {other.title()} already mesh in stage {first.id}"
        for (stage, one, other), (first, *_) in of.repeated
    ]
    joined = {stage.id for stage, *_ in (*of.stages, *of.loose, *(two for two, _ in of.repeated))}
    found += [
        f"{stage.title()}: it does not join two cylindrical gears"
        for stage in of.model.of_type("cylindrical_stage")
        if stage.id not in joined
    ]
    loads = applied_loads(of)
    used = used | {joint.part.id for each in loads for joint in each.route}
    sides = {part.id: both for part, *both in of.joined(*BEARINGS, *COUPLINGS)}
    for part in of.model.of_type(*BEARINGS, *COUPLINGS):
        if part.id not in used:
            found.append(f"{part.title()}: {_why_unused(of, part, sides.get(part.id, []))}")
        elif part.number("maximum_normal_backlash") or (
            part.type in COUPLINGS and part.number(*CLEARANCES)
        ):
            found.append(f"{part.title()}: its backlash")
    for coupling, *both in of.coupled:
        if coupling.id in used and _ties_across(of, coupling, both):
            found.append(f"{coupling.title()}: its stiffness across the axis")
    found += _overlooked(of)
    on_shafts = {each.load.id for each in loads}
    for load in of.model.of_type("external_load"):
        if load.id not in on_shafts:
            found.append(f"{load.title()}: it is on no shaft with gears")
        if load.number("force_v_direction") or load.number("force_w_direction"):
            found.append(f"{load.title()}: its force across the axis")
    return found


def _overlooked(of: Gearing) -> list[str]:
    """Return attributes that matter to load sharing but are not imported, with their numbers."""
    kinds = Counter(
        (name, component.type)
        for component in of.model.of_type(*GEARS, *BEARINGS, "cylindrical_stage")
        for name, value in component.attributes.items()
        if any(word in name for word in OVERLOOKED) and value not in (0.0, "", ())
    )
    return [f"{name} of {count} {kind}" for (name, kind), count in sorted(kinds.items())]


def _ties_across(of: Gearing, coupling: Component, sides: list[Component]) -> bool:
    """Return whether a coupling also holds two shafts across the axis, or a carrier elastically."""
    if all(of.on_shaft(side) for side in sides):
        return radial(coupling) > 0.0
    carrier = any(side.id in of.carrier_shafts for side in sides)
    plate = any(side.type == "side_plate" for side in sides)
    return carrier and plate and 0.0 < radial(coupling) < STIFF


def _why_unused(of: Gearing, part: Component, sides: list[Component]) -> str:
    """Return why a bearing or coupling is not in the case."""
    if not sides:
        return "it joins nothing"
    if not any(side.type == "shaft" for side in sides):
        return "none of its sides is a shaft"
    if part.type in COUPLINGS and not of.is_engaged(part):
        return "it is open"
    if part.type in COUPLINGS and not transmits(part):
        return "its torsional stiffness is zero, so it transmits no torque"
    if part.type in BEARINGS and radial(part) <= 0.0:
        return "it takes no load across the axis"
    if all(of.on_shaft(side) for side in sides):
        return "it lies between two shafts that turn"
    return "it neither holds nor joins gears or carriers"
