"""What was found, written back into a copy of the REXS file from which the case was imported."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from loadshare.array_types import Array
from loadshare.exchange.imported import reading, refuse
from loadshare.exchange.rexs.archive import repacked, unpacked
from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.holding import borne_by
from loadshare.exchange.rexs.model import Component
from loadshare.exchange.rexs.reading import is_json, read_model, tables
from loadshare.input import read_file
from loadshare.results import Result
from loadshare.results.share import load_factors
from loadshare.settings import ALLOWED

FACTOR = "mesh_load_factor_iso_6336_2019"
STIFFNESS = "meshing_stiffness_characteristic"
ON_SIDE = "force_acting_on_{side}_component_{axis}"
FORCE = "custom_loadshare_normal_force"
ERROR = "custom_loadshare_transmission_error"
PUSHED = "custom_loadshare_force_on_bearings"
MOVED = "custom_loadshare_displacement"


def export_rexs(result: Result, unit: str | Path) -> str:
    """Return a REXS file with what was found, all else as it was.

    It is in the components, or, if the file has load cases, in the first of these, of which the
    loads are. Of every cylindrical stage the mesh load factor K_γ, the largest force of its mesh
    over the mean of its stage in the case, if it is in one; the stiffness over the positions, force
    over compression along the line of action; normal force and transmission error over the
    positions. If several meshes share one stage, it has the largest K_γ alone. Of every bearing of
    a shaft, and every seat of a pin, the force on both its sides, of every gear and carrier
    displacement and force on what holds it, each at the position at which it is largest. What has
    no name in REXS has one that begins with ``custom_loadshare``.

    Parameters
    ----------
    result : Result
        Of a case with the gears that `import_rexs` names.
    unit : str or pathlib.Path
        The REXS file, XML, JSON or an archive of either; it is read only. Of an archive, the text
        of the file inside is returned.

    Raises
    ------
    CaseError
        If the file cannot be read, or has no mesh of the case.
    """
    unit = Path(unit)
    found = _found(result, Gearing(read_model(unit)))
    if not found:
        refuse(unit, "has no mesh of this case: gears must be named as the import names them")
    content = unpacked(unit, read_file(unit, ALLOWED.other_bytes))
    if is_json(content):
        return into_json(json.loads(content.decode("utf-8-sig")), found)
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    try:
        root = ElementTree.fromstring(content, parser)
    except ElementTree.ParseError as error:
        # Prefixes without a namespace are read, as the import asks for none, but cannot be written.
        refuse(unit, f"is not valid XML: {error}")
    return into_xml(root, found)


def in_form_of(unit: str | Path, text: str) -> bytes:
    """Return a REXS text as the unit holds its own: packed, if it is an archive, with all else.

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


def _found(result: Result, gearing: Gearing) -> Values:
    """Attributes by id of the component: values and units; none without a mesh of the case."""
    made = _of_meshes(result, gearing)
    if made:
        made |= _of_bodies(result, gearing) | _of_bearings(result, gearing)
    return made


def _of_meshes(result: Result, gearing: Gearing) -> Values:
    """Return what is written for stages; of one with several meshes the largest factor alone."""
    made: Values = {}
    positions, meshes = result.positions, result.positions[0].train.meshes
    several = Counter(stage.id for stage, *_ in gearing.stages)
    factors: dict[str, list[float]] = {}
    for stage, one, other in gearing.stages:
        ends = gearing.names[one.id], gearing.names[other.id]
        name = next((n for n in map("-".join, (ends, ends[::-1])) if n in meshes), None)
        if name is None:
            continue
        factors.setdefault(stage.id, []).extend(_load_factors(result, name))
        made[stage.id] = {}
        if several[stage.id] == 1:
            made[stage.id] = {
                STIFFNESS: (_stiffness(result, name), "N / mm"),
                FORCE: ([p.loads.meshes[name] for p in positions], "N"),
                ERROR: ([1e6 * p.elastic.mesh_transmission_error[name] for p in positions], "mum"),
            }
    for id_, known in factors.items():
        if known:
            made[id_][FACTOR] = (max(known), "none")
    return made


def _load_factors(result: Result, mesh: str) -> Iterator[float]:
    """K_γ of a mesh at the positions where its stage carries."""
    train = result.positions[0].train
    for stage in (s for s in train.stages if mesh in s.meshes):
        for p in result.positions:
            if p.share.get(mesh) is not None:
                yield load_factors(train, p.torque, stage)[mesh]


def _bodies(result: Result, gearing: Gearing) -> Iterator[tuple[Component, str]]:
    """Gears and carriers of the file that the case has, with their names."""
    for body in (*gearing.gears, *gearing.carriers):
        if gearing.names[body.id] in result.frames:
            yield body, gearing.names[body.id]


def _pushed(result: Result, name: str) -> Array:
    """Force of a body on what holds it at every position, (positions, 3) [N]."""
    forces = np.array([p.loads.bearings[name] for p in result.positions])
    return np.asarray(forces @ np.array(result.frames[name]))


def _largest(vectors: Array) -> Array:
    """The longest of some vectors."""
    return np.asarray(vectors[np.argmax((vectors**2).sum(axis=1))])


def _of_bodies(result: Result, gearing: Gearing) -> Values:
    """What is written for gears and carriers: x, y, z."""
    made: Values = {}
    for body, name in _bodies(result, gearing):
        moved = np.array([p.claim.displacement[name] for p in result.positions])
        made[body.id] = {
            MOVED: ((1e6 * _largest(moved)).tolist(), "mum"),
            PUSHED: (_largest(_pushed(result, name)).tolist(), "N"),
        }
    return made


def _of_bearings(result: Result, gearing: Gearing) -> Values:
    """Forces on both sides of every bearing, in its own directions v and w.

    Each takes its part of what the bodies on its shaft push, as the import has taken them.
    """
    pushed: dict[str, Array] = {}
    across: dict[str, Array] = {}
    for body, name in _bodies(result, gearing):
        for link, part in borne_by(gearing, body):
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
    """Force over compression of a mesh at every position [N/mm]; 0 where it carries nothing.

    Where a mesh jams, that of the flank which carries more.
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
Values = dict[str, dict[str, Value]]
"""Values and units by attribute, by id of the component."""
ABOUT = ("id", "type", "name")
"""What a load case repeats of a component."""


def into_xml(root: ElementTree.Element, found: Values) -> str:
    """Return an XML file with attributes of components set: of the first load case, if any."""
    whole = list(root.iterfind("components/component"))
    case = root.find("load_spectrum/load_case")
    changed = whole if case is None else _all_in_case(case, whole, found)
    for component in changed:
        for key, (value, unit) in found.get(component.get("id", ""), {}).items():
            for old in [a for a in component.iterfind("attribute") if a.get("id") == key]:
                component.remove(old)
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
    """Components of a load case, with those added for which something was found."""
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
        for key, (value, unit) in new.items():
            kind = "floating_point_array" if isinstance(value, list) else "floating_point"
            kept.append({"id": key, "unit": unit, kind: value})
        component["attributes"] = kept
    return json.dumps(root, indent=1, ensure_ascii=False) + "\n"
