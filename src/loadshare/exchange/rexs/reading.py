"""REXS files: XML, JSON, or an archive with one of them, read into a model."""

from __future__ import annotations

import base64
import binascii
import json
import re
import struct
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn
from xml.etree import ElementTree
from xml.parsers import expat

from loadshare.exchange.imported import reading, refuse
from loadshare.exchange.rexs.archive import unpacked
from loadshare.exchange.rexs.model import Component, Model, Relation, Unread, Value
from loadshare.exchange.rexs.quantities import FLAGS, QUANTITIES, in_si
from loadshare.input import read_file
from loadshare.settings import ALLOWED

VALUES = (
    *("boolean", "date_time", "enum", "file_reference", "floating_point", "integer"),
    *("reference_component", "string"),
)
"""How keys begin under which JSON holds the value of an attribute."""
CODES = {"float64": "d", "float32": "f"}
"""Formats of arrays as bytes, by the code in the file."""

OTHERS = {
    ".toml": "is a case already; `loadshare run` solves it",
    ".nc": "is a result, which contains its case: there is nothing to import",
    ".csv": "is one table; give the folder that contains all tables of a case",
    **dict.fromkeys((".xlsm", ".xls", ".xlsb", ".ods"), "is a workbook; save it as .xlsx"),
}
"""Messages for files that are not gear units, by their endings."""

FIRST_NAMES = {
    "side_1": "inner_part",
    "side_2": "outer_part",
    "u_coordinate_on_shaft_side_1": "u_coordinate_on_shaft_inner_side",
    "u_coordinate_on_shaft_side_2": "u_coordinate_on_shaft_outer_side",
}
"""Roles and attributes of couplings in version 1.0, and their later names."""

VERSIONS = re.compile(r"(1(\.[0-7])?|2(\.0)?)(\.0)?")
"""Known versions of REXS."""


def read_model(path: Path) -> Model:
    """Read a REXS file: XML, JSON, or either in a zip archive.

    Raises
    ------
    CaseError
        If it cannot be read or is not REXS.
    """
    with reading(path):
        content = read_file(path, ALLOWED.other_bytes)
        if path.suffix.lower() in OTHERS:
            refuse(path, OTHERS[path.suffix.lower()])
        content = unpacked(path, content)
    try:
        model = _model_of(_from_json(content) if is_json(content) else _from_xml(content))
    except _NoRexs as error:
        refuse(path, str(error))
    except RecursionError:
        refuse(path, "is nested too deeply")
    if not model.components:
        refuse(path, "is not REXS: it has no components")
    return model


def is_json(content: bytes) -> bool:
    """Tell whether a REXS file is JSON, not XML."""
    return content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{"


class _NoRexs(Exception):  # noqa: N818 -- reported as a problem, never raised to a user
    """Why a text is no REXS."""


def _from_xml(content: bytes) -> Mapping[str, Any]:
    """Return the model of an XML file as a JSON file holds it."""
    root = parsed(content)
    if root.tag != "model":
        raise _NoRexs(f"is not REXS: its first element is {root.tag}, not model")
    relations = root.iterfind("relations/relation")
    cases = root.iterfind("load_spectrum/load_case")
    changed = [{"components": list(map(_as_json, case.iter("component")))} for case in cases]
    return {
        **root.attrib,
        "relations": [r.attrib | {"refs": [of.attrib for of in r.iter("ref")]} for r in relations],
        "components": list(map(_as_json, root.iterfind("components/component"))),
        "load_spectrum": {"load_cases": changed},
    }


def parsed(content: bytes, comments: bool = False) -> ElementTree.Element:
    """Parse XML; refuse a document type, whose entities could expand a small file to a huge one.

    Names keep their prefixes, whatever their namespaces. Comments are kept on request.
    """
    builder = ElementTree.TreeBuilder(insert_comments=comments)
    parser = expat.ParserCreate()

    def refuse(*_: Any) -> NoReturn:
        raise _NoRexs("declares a document type, which no REXS file does")

    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > ALLOWED.depth:
            raise _NoRexs("is nested too deeply")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = builder.data
    if comments:
        parser.CommentHandler = builder.comment
    try:
        parser.Parse(content, True)
        return builder.close()
    except (expat.ExpatError, AssertionError, ValueError, LookupError) as error:
        raise _NoRexs(f"is not valid XML: {error}") from None


def _as_json(element: ElementTree.Element) -> dict[str, Any]:
    """Return a component of an XML file as a JSON file holds it."""
    attributes = []
    for attribute in element.iterfind("attribute"):
        array = attribute.find("array")
        value: Any
        if array is None:
            value = _scalar((attribute.text or "").strip())
        elif array.get("code"):
            value = {"value": array.text or "", "code": array.get("code")}
        else:
            value = [(c.text or "").strip() for c in array.iterfind("c")]
        about = {key: attribute.get(key, "") for key in ("id", "unit")}
        attributes.append(about | {"value": value})
    return {**element.attrib, "attributes": attributes}


def _relation(given: Mapping[str, Any]) -> Relation:
    """Return a relation; couplings of version 1.0 are named as in later versions."""
    kind = str(given.get("type", ""))
    roles = {str(ref.get("role", "")): str(ref.get("id", "")) for ref in tables(given.get("refs"))}
    if kind == "coupling" and "side_1" in roles:
        return Relation("side", {FIRST_NAMES.get(role, role): id_ for role, id_ in roles.items()})
    return Relation(kind, roles)


def _put(attributes: dict[str, Value], name: str, value: Value, unit: str) -> None:
    name = FIRST_NAMES.get(name, name)
    read = in_si(name, value, unit)
    if read is None:
        return
    if name in attributes and name in (*QUANTITIES, *FLAGS) and attributes[name] != read:
        read = Unread("", "is given several times, with different values", "one value")
    attributes[name] = read


def _scalar(text: str) -> Value:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    try:
        return float(text)
    except ValueError:
        return text


def _numbers(texts: list[Any]) -> Value:
    words = [str(text).lower() for text in texts]
    if words and all(word in ("true", "false") for word in words):
        return tuple(word == "true" for word in words)
    try:
        return tuple(float(text) for text in texts)
    except (TypeError, ValueError, OverflowError):
        return "; ".join(words).strip("; ")


def _decoded(text: str, code: str) -> Value:
    letter = CODES.get(code)
    if letter is None:
        return text.strip()
    try:
        held = base64.b64decode("".join(text.split()), validate=True)
        return struct.unpack(f"<{len(held) // struct.calcsize(letter)}{letter}", held)
    except (binascii.Error, struct.error, ValueError):
        return text.strip()


def _from_json(content: bytes) -> Mapping[str, Any]:
    try:
        held = json.loads(content.decode("utf-8-sig"))
    except (UnicodeDecodeError, ValueError) as error:
        raise _NoRexs(f"is not valid JSON: {error}") from None
    model = held.get("model") if isinstance(held, Mapping) else None
    if not isinstance(model, Mapping):
        raise _NoRexs("is not REXS: it has no model")
    return model


def tables(given: Any) -> list[dict[str, Any]]:
    """Return the tables in a list; none for anything that is not a list."""
    return [t for t in given if isinstance(t, dict)] if isinstance(given, list) else []


def _component(given: Mapping[str, Any]) -> Component:
    attributes: dict[str, Value] = {}
    for attribute in tables(given.get("attributes")):
        others = {k: v for k, v in attribute.items() if k not in ("id", "unit")}
        values = [v for k, v in others.items() if k.startswith(VALUES)] or list(others.values())
        value = _value(values[0]) if len(values) == 1 else ""
        _put(attributes, str(attribute.get("id", "")), value, str(attribute.get("unit") or ""))
    return Component(
        str(given.get("id", "")), str(given.get("type", "")), str(given.get("name", "")), attributes
    )


def _value(given: Any) -> Value:
    if isinstance(given, bool | str):
        return given
    if isinstance(given, int | float):
        try:
            return float(given)
        except OverflowError:
            return ""
    if isinstance(given, Mapping):
        return _decoded(str(given.get("value", "")), str(given.get("code", "")))
    return _numbers(given) if isinstance(given, list) else ""


def _model_of(given: Mapping[str, Any]) -> Model:
    """Return a model in which attributes of the first load case override those of components."""
    version = str(given.get("version", ""))
    relations = list(map(_relation, tables(given.get("relations"))))
    spectrum = given.get("load_spectrum")
    cases = tables(spectrum.get("load_cases") if isinstance(spectrum, Mapping) else None)
    every = list(map(_component, tables(given.get("components"))))
    whole = {component.id: component for component in every}
    _check_ids(every, "has")
    notes: tuple[str, ...] = ()
    if not VERSIONS.fullmatch(version):
        lacks = f"version {version} is not known" if version else "no version is given"
        notes = (f"{lacks}: read as a version from 1.1 to 2.0",)
    if cases:
        notes += (f"loads are those of the first of {len(cases)} load cases",)
        inside = list(map(_component, tables(cases[0].get("components"))))
        _check_ids(inside, "its first load case has")
        changes = {component.id: component for component in inside}
        notes += tuple(
            f"{c.title()} of the load case is left out: the file has no such component"
            for c in inside
            if c.id not in whole
        )
        for id_ in changes.keys() & whole.keys():
            attributes = {**whole[id_].attributes, **changes[id_].attributes}
            whole[id_] = replace(whole[id_], attributes=attributes)
    once = {(r.type, frozenset(r.roles.items())): r for r in relations}
    if repeated := len(relations) - len(once):
        notes += (f"relations given more than once are used once: {repeated} left out",)
    single = tuple(once.values())
    return Model(version, whole, single, notes, _pointless(single, whole))


def _check_ids(components: Iterable[Component], what_has: str) -> None:
    for id_, count in Counter(component.id for component in components).items():
        if count > 1:
            raise _NoRexs(f"{what_has} {count} components with the id {id_!r}: ids must be unique")


def _pointless(relations: Iterable[Relation], whole: Mapping[str, Component]) -> tuple[str, ...]:
    """Say which relations name components that the file does not have, each kind once."""
    missing: dict[str, list[str]] = {}
    for relation in relations:
        lost = sorted(id_ for id_ in relation.roles.values() if id_ not in whole)
        missing.setdefault(relation.type, []).extend(lost[:1])
    return tuple(
        f"relations {kind!r}: {len(ids)} left out, the file has no component {ids[0]!r}"
        + (", nor others that they name" if len(set(ids)) > 1 else "")
        for kind, ids in missing.items()
        if ids
    )
