"""Export of a result into a copy of the REXS file from which its case was imported."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from loadshare.array_types import Array
from loadshare.errors import CaseError, Problem
from loadshare.exchange.imported import reading, refuse
from loadshare.exchange.rexs.archive import repacked, unpacked
from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.holding import force_parts
from loadshare.exchange.rexs.model import Component
from loadshare.exchange.rexs.reading import is_json, parsed, read_model, tables
from loadshare.input import read_file
from loadshare.results import Result
from loadshare.results.share import load_factors
from loadshare.settings import ALLOWED
from loadshare.train.offset import turned_about

FACTOR = "mesh_load_factor_iso_6336_2019"
STIFFNESS = "meshing_stiffness_characteristic"
ON_SIDE = "force_acting_on_{side}_component_{axis}"
FORCE = "custom_loadshare_normal_force"
ERROR = "custom_loadshare_transmission_error"
PUSHED = "custom_loadshare_force_on_bearings"
MOVED = "custom_loadshare_displacement"


def export_rexs(result: Result, unit: str | Path) -> str:
    """Return a REXS file with the results added and everything else unchanged.

    They are written to the components or, if the file has load cases, to the first of these, from
    which the loads are. A cylindrical stage gets the mesh load factor K_γ (the largest force of its
    mesh over the mean of its stage in the case; none if it is in no stage) and, over the positions,
    stiffness (force over compression along the line of action), normal force and transmission
    error. If several meshes share one stage, it gets only the largest K_γ. Bearings of shafts and
    seats of pins get the force on both sides, gears and carriers their displacement and their force
    on what holds them, each at the position where it is largest: for planets as seen from their
    carrier, in its directions at the first position, for others as seen from the housing. Names of
    quantities that REXS does not have begin with ``custom_loadshare``.

    Parameters
    ----------
    result : Result
        Result of a case with the names of gears that `import_rexs` gives.
    unit : str or pathlib.Path
        The REXS file, XML, JSON or an archive of either; it is not changed. For an archive, the
        text of the file inside is returned.

    Raises
    ------
    CaseError
        If the file cannot be read, or has gears or meshes that the case lacks.
    """
    unit = Path(unit)
    gearing = Gearing(read_model(unit))
    _check_all_there(unit, gearing, result)
    found = _of_meshes(result, gearing)
    found |= _of_bodies(result, gearing) | _of_bearings(result, gearing)
    content = unpacked(unit, read_file(unit, ALLOWED.other_bytes))
    if is_json(content):
        return into_json(json.loads(content.decode("utf-8-sig")), found)
    return into_xml(parsed(content, comments=True), found)


def in_form_of(unit: str | Path, text: str) -> bytes:
    """Return a REXS text in the form of its unit: if that is an archive, packed with all else.

    Parameters
    ----------
    unit : str or pathlib.Path
        The REXS file of which `text` is a copy.
    text : str
        As `export_rexs` returns it.

    Raises
    ------
    CaseError
        If the unit cannot be read.
    """
    unit = Path(unit)
    with reading(unit):
        return repacked(unit, read_file(unit, ALLOWED.other_bytes), text)


def _check_all_there(unit: Path, gearing: Gearing, result: Result) -> None:
    """Refuse a case that lacks gears or meshes of the file: bearing forces would be too small."""
    names, meshes, what = gearing.names, _by_gears(result), "gears must be named as the import"
    pairs = [(names[one.id], names[other.id]) for _, one, other in gearing.stages]
    if not any(frozenset(pair) in meshes for pair in pairs):
        refuse(unit, f"has no mesh of this case: {what} names them")
    lost = [name for name in names.values() if name not in result.frames]
    lost = lost or ["-".join(pair) for pair in pairs if frozenset(pair) not in meshes]
    if lost:
        why = f"is not in the case: {what} named them"
        raise CaseError([Problem(str(unit), name, "", why) for name in lost])


def _by_gears(result: Result) -> dict[frozenset[str], str]:
    """Return the names of meshes by their gears."""
    meshes = result.positions[0].train.meshes
    return {frozenset((mesh.driver, mesh.driven)): name for name, mesh in meshes.items()}


def _of_meshes(result: Result, gearing: Gearing) -> Values:
    """Return the values of stages; for one with several meshes the largest factor alone."""
    made: Values = {}
    positions, meshes = result.positions, _by_gears(result)
    several = Counter(stage.id for stage, *_ in gearing.stages)
    factors: dict[str, list[float]] = {}
    for stage, one, other in gearing.stages:
        name = meshes[frozenset((gearing.names[one.id], gearing.names[other.id]))]
        factors.setdefault(stage.id, []).extend(_load_factors(result, name))
        made[stage.id] = {}
        if several[stage.id] == 1:
            made[stage.id] = {
                STIFFNESS: (_stiffness(result, name), "N / mm"),
                FORCE: ([p.loads.meshes[name] for p in positions], "N"),
                ERROR: ([1e6 * p.elastic.mesh_transmission_error[name] for p in positions], "mum"),
            }
    for id_, known in factors.items():
        # An earlier factor, which belongs to other forces, is removed.
        made[id_][FACTOR] = (max(known), "none") if known else None
    return made


def _load_factors(result: Result, mesh: str) -> Iterator[float]:
    """Yield K_γ of a mesh at the positions where its stage carries load."""
    train = result.positions[0].train
    for stage in (s for s in train.stages if mesh in s.meshes):
        for p in result.positions:
            if p.share.get(mesh) is not None:
                yield load_factors(train, p.torque, stage)[mesh]


def _bodies(gearing: Gearing) -> Iterator[tuple[Component, str]]:
    """Yield the gears and carriers of the file, with their names."""
    for body in (*gearing.gears, *gearing.carriers):
        yield body, gearing.names[body.id]


def _pushed(result: Result, name: str) -> Array:
    """Return the force of a body on what holds it at every position, (positions, 3) [N]."""
    forces = np.array([p.loads.bearings[name] for p in result.positions])
    return _in_housing(result, name, forces @ np.array(result.frames[name]))


def _in_housing(result: Result, name: str, seen: Array) -> Array:
    """Return a body's vectors at every position as seen from the housing, or a planet's carrier."""
    train = result.positions[0].train
    gear = train.gears[name]
    turned = [train.frame_angle(name, train.rotations(p.position)) for p in result.positions]
    return seen if gear.carrier or not any(turned) else turned_about(gear, seen, np.array(turned))


def _largest(vectors: Array) -> Array:
    """Return the longest of some vectors."""
    return np.asarray(vectors[np.argmax((vectors**2).sum(axis=1))])


def _of_bodies(result: Result, gearing: Gearing) -> Values:
    """Return the values of gears and carriers: x, y, z."""
    made: Values = {}
    for body, name in _bodies(gearing):
        found = np.array([p.claim.displacement[name] for p in result.positions])
        moved = _in_housing(result, name, found)
        made[body.id] = {
            MOVED: ((1e6 * _largest(moved)).tolist(), "mum"),
            PUSHED: (_largest(_pushed(result, name)).tolist(), "N"),
        }
    return made


def _of_bearings(result: Result, gearing: Gearing) -> Values:
    """Return the forces on both sides of every bearing, in its own directions v and w.

    Each takes its part of the forces of the bodies on its shaft, as in the import.
    """
    pushed: dict[str, Array] = {}
    across: dict[str, Array] = {}
    for body, name in _bodies(gearing):
        for link, part in force_parts(gearing, body):
            along = part if link.side == "inner" else -part
            known = pushed.get(link.part.id, np.zeros(3))
            pushed[link.part.id] = known + along * _pushed(result, name)
            across[link.part.id] = np.stack(gearing.places.across(link.part, link.shaft))
    made: Values = {}
    for id_, forces in pushed.items():
        outwards = across[id_] @ _largest(forces)
        made[id_] = {
            ON_SIDE.format(side=side, axis=axis): (float(sign * force), "N")
            for side, sign in (("inner", -1.0), ("outer", 1.0))
            for axis, force in zip("vw", outwards, strict=True)
        }
    return made


def _stiffness(result: Result, name: str) -> list[float]:
    """Return force over compression of a mesh at every position [N/mm]; 0 where it is unloaded.

    Where a mesh jams, it is that of the flank with the larger force.
    """
    values = []
    for position in result.positions:
        mesh, pressed = position.train.meshes[name], position.equilibrium.flank_force
        flank = max(map(mesh.flank_name, mesh.flanks), key=lambda one: pressed[one])
        law = mesh.law(position.train.flank_positions(position.position)[flank])
        force = pressed[flank]
        yielded = law.compression(force)
        values.append(1e-3 * force / yielded if yielded > 0.0 else 0.0)
    return values


Value = tuple[float | list[float], str]
Values = dict[str, dict[str, Value | None]]
"""Values and units by attribute, by id of the component; None for an attribute to be removed."""
ABOUT = ("id", "type", "name")
"""Keys of a component that a load case repeats."""


def into_xml(root: ElementTree.Element, found: Values) -> str:
    """Return an XML file with attributes of components set: of the first load case, if any."""
    whole = list(root.iterfind("components/component"))
    case = root.find("load_spectrum/load_case")
    changed = whole if case is None else _all_in_case(case, whole, found)
    for component in changed:
        for key, new in found.get(component.get("id", ""), {}).items():
            for old in [a for a in component.iterfind("attribute") if a.get("id") == key]:
                component.remove(old)
            if new is None:
                continue
            value, unit = new
            attribute = ElementTree.SubElement(component, "attribute", id=key, unit=unit)
            if isinstance(value, list):
                array = ElementTree.SubElement(attribute, "array")
                for one in value:
                    ElementTree.SubElement(array, "c").text = repr(one)
            else:
                attribute.text = repr(value)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, "unicode") + "\n"


def _all_in_case(
    case: ElementTree.Element, whole: list[ElementTree.Element], found: Values
) -> list[ElementTree.Element]:
    """Return the components of a load case, adding those for which there are results."""
    inside = list(case.iter("component"))
    known = {component.get("id", "") for component in inside}
    for component in whole:
        if component.get("id", "") in found.keys() - known:
            about = {key: component.get(key, "") for key in ABOUT}
            inside.append(ElementTree.SubElement(case, "component", about))
    return inside


def into_json(root: dict[str, Any], found: Values) -> str:
    """Return a JSON file with attributes of components set: of the first load case, if any."""
    changed = tables(root["model"]["components"])
    spectrum = root["model"].get("load_spectrum")
    cases = tables(spectrum.get("load_cases")) if isinstance(spectrum, dict) else []
    if cases:
        inside = tables(cases[0].get("components"))
        known = {str(component.get("id", "")) for component in inside}
        inside += [
            {key: component[key] for key in ABOUT if key in component}
            for component in changed
            if str(component.get("id", "")) in found.keys() - known
        ]
        cases[0]["components"] = changed = inside
    for component in changed:
        new = found.get(str(component.get("id", "")), {})
        kept = [a for a in tables(component.get("attributes")) if str(a.get("id")) not in new]
        for key, (value, unit) in ((key, one) for key, one in new.items() if one is not None):
            kind = "floating_point_array" if isinstance(value, list) else "floating_point"
            kept.append({"id": key, "unit": unit, kind: value})
        component["attributes"] = kept
    return json.dumps(root, indent=1, ensure_ascii=False) + "\n"
