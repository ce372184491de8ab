"""Invented gear units in REXS form, as XML and as JSON."""

from __future__ import annotations

import base64
import json
import math
import struct
from collections.abc import Iterable, Mapping
from typing import Any
from xml.etree import ElementTree

Component = tuple[int, str, str, dict[str, Any]]
Relation = tuple[str, dict[str, int]]
MM, DEG, NONE = "mm", "deg", "none"


def xml(
    components: Iterable[Component],
    relations: Iterable[Relation],
    version: str = "1.1",
    cases: Iterable[Iterable[Component]] = (),
    coded: bool = False,
) -> bytes:
    """Return a unit as XML; attributes are (value, unit)."""
    root = ElementTree.Element("model", version=version, applicationId="test")
    under = ElementTree.SubElement(root, "relations")
    for number, (kind, roles) in enumerate(relations):
        relation = ElementTree.SubElement(under, "relation", id=str(number), type=kind)
        for role, id_ in roles.items():
            ElementTree.SubElement(relation, "ref", id=str(id_), role=role, hint="")
    _add(ElementTree.SubElement(root, "components"), components, coded)
    if cases:
        spectrum = ElementTree.SubElement(root, "load_spectrum", id="1")
        for number, case in enumerate(cases):
            _add(ElementTree.SubElement(spectrum, "load_case", id=str(number)), case, coded)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)


def _add(under: ElementTree.Element, components: Iterable[Component], coded: bool) -> None:
    for id_, kind, name, attributes in components:
        part = ElementTree.SubElement(under, "component", id=str(id_), type=kind, name=name)
        for key, (value, unit) in attributes.items():
            attribute = ElementTree.SubElement(part, "attribute", id=key, unit=unit)
            if isinstance(value, list) and coded:
                array = ElementTree.SubElement(attribute, "array", code="float64")
                array.text = _coded(value)
            elif isinstance(value, list):
                array = ElementTree.SubElement(attribute, "array")
                for one in value:
                    ElementTree.SubElement(array, "c").text = repr(one)
            else:
                text = str(value).lower() if isinstance(value, bool) else str(value)
                attribute.text = text


def _coded(values: list[float]) -> str:
    return base64.b64encode(struct.pack(f"<{len(values)}d", *values)).decode()


def rexsj(components: Iterable[Component], relations: Iterable[Relation], version: str) -> bytes:
    """Return a unit as JSON."""

    def attribute(key: str, value: Any, unit: str) -> dict[str, Any]:
        kinds = {bool: "boolean", str: "string", int: "integer", float: "floating_point"}
        kind = "floating_point_array" if isinstance(value, list) else kinds[type(value)]
        return {"id": key, "unit": unit, kind: value}

    model: Mapping[str, Any] = {
        "version": version,
        "relations": [
            {
                "id": number,
                "type": kind,
                "refs": [{"id": id_, "role": role, "hint": ""} for role, id_ in roles.items()],
            }
            for number, (kind, roles) in enumerate(relations)
        ],
        "components": [
            {
                "id": id_,
                "type": kind,
                "name": name,
                "attributes": [attribute(k, v, u) for k, (v, u) in attributes.items()],
            }
            for id_, kind, name, attributes in components
        ],
    }
    return json.dumps({"model": model}).encode()


def at(x: float, y: float, z: float) -> dict[str, Any]:
    """Return attributes of a place with its axis along x."""
    return {
        "support_vector": ([x, y, z], MM),
        "u_axis_vector": ([1.0, 0.0, 0.0], MM),
        "w_axis_vector": ([0.0, 0.0, 1.0], MM),
        "reference_component_for_position": (1, NONE),
    }


def teeth(count: int, module: float, **more: Any) -> dict[str, Any]:
    """Return attributes of a gear."""
    return {
        "number_of_teeth": (count, NONE),
        "normal_module": (module, MM),
        "helix_angle_reference_diameter": (0.0, DEG),
        "face_width": (50.0, MM),
        "u_coordinate_on_shaft": (0.0, MM),
        **more,
    }


def planetary(planets: int = 3) -> tuple[list[Component], list[Relation]]:
    """Return a set with a held ring: sun 17, planets 22, ring 61, module 4; carrier as output."""
    arm = 78.0
    components: list[Component] = [
        (1, "gear_unit", "unit", at(0.0, 0.0, 0.0)),
        (2, "gear_casing", "casing", {}),
        (3, "planet_carrier", "carrier", {}),
        (4, "shaft", "carrier shaft", at(125.0, 0.0, 0.0)),
        (9, "planetary_stage", "set", {}),
        (34, "shaft", "sun shaft", at(125.0, 0.0, 0.0) | {"rotational_speed": (1500.0, "1 / min")}),
        (62, "shaft", "ring shaft", at(125.0, 0.0, 0.0)),
        (53, "cylindrical_gear", "sun", teeth(17, 4.0) | at(125.0, 0.0, 0.0)),
        (58, "ring_gear", "ring", teeth(61, 4.0) | at(125.0, 0.0, 0.0)),
        (65, "switchable_coupling", "brake", {"is_engaged": (True, NONE)}),
        (
            38,
            "external_load",
            "load",
            {"torque_around_u_axis": (1591.549, "N m"), "defines_torque": (True, NONE)},
        ),
        (61, "external_load", "out", {"defines_torque": (False, NONE)}),
        (90, "lubricant", "oil", {}),
    ]
    relations: list[Relation] = [
        ("assembly", {"assembly": 9, "part": 3}),
        ("assembly", {"assembly": 3, "part": 4}),
        ("assembly", {"assembly": 34, "part": 53}),
        ("assembly", {"assembly": 62, "part": 58}),
        ("assembly", {"assembly": 34, "part": 38}),
        ("assembly", {"assembly": 4, "part": 61}),
        ("side", {"assembly": 65, "inner_part": 62, "outer_part": 2}),
        ("central_shaft", {"planetary_stage": 9, "shaft": 34}),
    ]
    for k in range(planets):
        turn = 2.0 * math.pi * k / planets
        place = at(125.0, arm * math.sin(turn), arm * math.cos(turn))
        shaft, gear, pin, bearing = 229 + k, 247 + k, 235 + k, 300 + k
        components += [
            (shaft, "shaft", f"planet shaft {k}", place),
            (gear, "cylindrical_gear", f"planet {k}", teeth(22, 4.0) | place),
            (pin, "shaft", f"pin {k}", place),
            (
                bearing,
                "concept_bearing",
                f"planet bearing {k}",
                {
                    "radial_stiffness": (1e9, "N / m"),
                    "misalignment_in_v_direction": (15.0 if k == 1 else 0.0, "mum"),
                },
            ),
            (211 + k, "cylindrical_stage", "", {}),
            (220 + k, "cylindrical_stage", "", {}),
        ]
        relations += [
            ("planet_shaft", {"planetary_stage": 9, "shaft": shaft}),
            ("planet_pin", {"planetary_stage": 9, "shaft": pin}),
            ("assembly", {"assembly": 3, "part": pin}),
            ("assembly", {"assembly": shaft, "part": gear}),
            ("side", {"assembly": bearing, "inner_part": pin, "outer_part": shaft}),
            ("stage", {"stage": 211 + k, "gear_1": 53, "gear_2": gear}),
            ("stage", {"stage": 220 + k, "gear_1": gear, "gear_2": 58}),
        ]
    return components, relations


def two_stages() -> tuple[list[Component], list[Relation]]:
    """Return two stages on three shafts; the middle one has two gears and two bearings."""
    components: list[Component] = [
        (1, "gear_unit", "unit", at(0.0, 0.0, 0.0)),
        (2, "gear_casing", "casing", {}),
        (10, "shaft", "in", at(0.0, 0.0, 0.0)),
        (11, "shaft", "middle", at(0.0, 60.0, 0.0)),
        (12, "shaft", "out", at(0.0, 140.0, 0.0)),
        (20, "cylindrical_gear", "1", teeth(20, 2.0) | at(25.0, 0.0, 0.0)),
        (21, "cylindrical_gear", "2", teeth(40, 2.0) | at(25.0, 60.0, 0.0)),
        (
            22,
            "cylindrical_gear",
            "3",
            teeth(20, 2.0, u_coordinate_on_shaft=(100.0, MM)) | at(125.0, 60.0, 0.0),
        ),
        (23, "cylindrical_gear", "4", teeth(60, 2.0) | at(125.0, 140.0, 0.0)),
        (30, "external_load", "in", {"torque_around_u_axis": (-100.0, "N m")}),
        (31, "external_load", "out", {}),
        (40, "cylindrical_stage", "", {}),
        (
            41,
            "cylindrical_stage",
            "",
            {
                "mesh_stiffness_for_load_distribution_along_face_width": (20.0, "N / (mm mum)"),
                "common_face_width": (50.0, MM),
            },
        ),
        (
            50,
            "shaft_section",
            "",
            {
                "u_coordinate_on_shaft": (0.0, MM),
                "length": (200.0, MM),
                "outer_diameter_begin": (40.0, MM),
                "outer_diameter_end": (40.0, MM),
                "inner_diameter_begin": (20.0, MM),
                "inner_diameter_end": (20.0, MM),
            },
        ),
    ]
    relations: list[Relation] = [
        ("assembly", {"assembly": 10, "part": 20}),
        ("assembly", {"assembly": 11, "part": 21}),
        ("assembly", {"assembly": 11, "part": 22}),
        ("assembly", {"assembly": 12, "part": 23}),
        ("assembly", {"assembly": 10, "part": 30}),
        ("assembly", {"assembly": 12, "part": 31}),
        ("assembly", {"assembly": 11, "part": 50}),
        ("stage", {"stage": 40, "gear_1": 20, "gear_2": 21}),
        ("stage", {"stage": 41, "gear_1": 22, "gear_2": 23}),
    ]
    for id_, shaft, along, stiffness, clearance in (
        (60, 10, 25.0, 2e23, 0.0),
        (61, 11, 0.0, 1e8, 0.0),
        (62, 11, 200.0, 3e8, 0.0),
        (63, 12, 25.0, 5e8, 40.0),
    ):
        components.append(
            (
                id_,
                "concept_bearing",
                "",
                {
                    "radial_stiffness": (stiffness, "N / m"),
                    "radial_clearance": (clearance, "mum"),
                    "u_coordinate_on_shaft_inner_side": (along, MM),
                },
            )
        )
        relations.append(("side", {"assembly": id_, "inner_part": shaft, "outer_part": 2}))
    return components, relations


def changed(
    parts: tuple[list[Component], list[Relation]], **attributes: Mapping[str, Any]
) -> tuple[list[Component], list[Relation]]:
    """Return a unit in which some components, ``_12`` for 12, have other attributes.

    None removes an attribute.
    """
    components, relations = parts
    made = []
    for id_, kind, name, known in components:
        both = {**known, **attributes.get(f"_{id_}", {})}
        made.append((id_, kind, name, {k: v for k, v in both.items() if v is not None}))
    return made, relations


def bearing(stiffness: float, along: float | None = None, **more: Any) -> dict[str, Any]:
    """Return attributes of a bearing: its stiffness [N/m], its place along both shafts [mm]."""
    places = {} if along is None else along_both(along)
    return {"radial_stiffness": (stiffness, "N / m"), **places, **more}


def along_both(along: float) -> dict[str, Any]:
    """Return attributes of a bearing or coupling at a place along both its shafts [mm]."""
    return {f"u_coordinate_on_shaft_{side}_side": (along, MM) for side in ("inner", "outer")}


def joint(id_: int, inner: int, outer: int) -> Relation:
    """Return a bearing or coupling between two components."""
    return ("side", {"assembly": id_, "inner_part": inner, "outer_part": outer})


def section(length: float, diameter: float) -> dict[str, Any]:
    """Return attributes of a solid section from the start of a shaft [mm]."""
    return {
        "u_coordinate_on_shaft": (0.0, MM),
        "length": (length, MM),
        **{f"outer_diameter_{end}": (diameter, MM) for end in ("begin", "end")},
        **{f"inner_diameter_{end}": (0.0, MM) for end in ("begin", "end")},
    }


def two_pinions() -> tuple[list[Component], list[Relation]]:
    """Return a shaft with two pinions, 150 mm apart, driven by a flange coupling near one of them.

    Gear 20 drives gear 21; coupling 70 joins the shaft of 21 to that of the pinions 24 and 25. They
    drive the gears 26 and 27 of one shaft that does not twist.
    """
    components: list[Component] = [
        (1, "gear_unit", "", at(0.0, 0.0, 0.0)),
        (2, "gear_casing", "", {}),
        (10, "shaft", "in", at(0.0, 0.0, 0.0)),
        (11, "shaft", "first wheel", at(0.0, 60.0, 0.0)),
        (14, "shaft", "pinions", at(-250.0, 60.0, 0.0)),
        (15, "shaft", "out", at(-250.0, 140.0, 0.0)),
        (20, "cylindrical_gear", "", teeth(20, 2.0) | at(25.0, 0.0, 0.0)),
        (21, "cylindrical_gear", "", teeth(40, 2.0) | at(25.0, 60.0, 0.0)),
        (24, "cylindrical_gear", "far", teeth(20, 2.0) | at(-225.0, 60.0, 0.0)),
        (25, "cylindrical_gear", "near", teeth(20, 2.0) | at(-75.0, 60.0, 0.0)),
        (26, "cylindrical_gear", "", teeth(60, 2.0) | at(-225.0, 140.0, 0.0)),
        (27, "cylindrical_gear", "", teeth(60, 2.0) | at(-75.0, 140.0, 0.0)),
        (30, "external_load", "", {"torque_around_u_axis": (100.0, "N m")}),
        (31, "external_load", "", {}),
        *((k, "cylindrical_stage", "", {}) for k in (40, 41, 42)),
        (50, "shaft_section", "", section(250.0, 30.0)),
        (
            70,
            "coupling",
            "flange",
            {
                "rotational_stiffness": (1e9, "N mm / rad"),
                "u_coordinate_on_shaft_inner_side": (0.0, MM),
                "u_coordinate_on_shaft_outer_side": (250.0, MM),
            },
        ),
    ]
    placed = ((10, 20), (11, 21), (14, 24), (14, 25), (15, 26), (15, 27), (10, 30), (15, 31))
    relations: list[Relation] = [
        ("assembly", {"assembly": whole, "part": part}) for whole, part in (*placed, (14, 50))
    ]
    for stage, one, other in ((40, 20, 21), (41, 24, 26), (42, 25, 27)):
        relations.append(("stage", {"stage": stage, "gear_1": one, "gear_2": other}))
    relations.append(joint(70, 11, 14))
    return components, relations
