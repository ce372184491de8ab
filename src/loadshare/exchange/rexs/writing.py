"""Attributes written into a copy of a REXS file, XML or JSON."""

from __future__ import annotations

import json
from typing import Any
from xml.etree import ElementTree

from loadshare.exchange.rexs.reading import tables

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
