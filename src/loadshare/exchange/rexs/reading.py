"""REXS files: XML, JSON, or an archive with one of them, read into a model."""

from __future__ import annotations

import base64
import binascii
import json
import re
import struct
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn
from xml.etree import ElementTree
from xml.parsers import expat

from loadshare.exchange.rexs.archive import refuse, unpacked
from loadshare.exchange.rexs.model import Component, Model, Relation, Unread, Value
from loadshare.exchange.rexs.quantities import QUANTITIES, in_si
from loadshare.input import Unreadable, read_file
from loadshare.settings import ALLOWED

CODES = {"float64": "d", "float32": "f"}
"""Arrays as bytes, by the code in the file."""

OTHERS = {
    ".toml": "is a case already; `loadshare run` solves it",
    ".nc": "is a result, which holds its case: there is nothing to import",
    ".csv": "is one table; give the folder that holds all tables of a case",
    **dict.fromkeys((".xlsm", ".xls", ".xlsb", ".ods"), "is a workbook; save it as .xlsx"),
}
"""Files that are no gear unit, by their endings."""

FIRST_NAMES = {
    "side_1": "inner_part",
    "side_2": "outer_part",
    "u_coordinate_on_shaft_side_1": "u_coordinate_on_shaft_inner_side",
    "u_coordinate_on_shaft_side_2": "u_coordinate_on_shaft_outer_side",
}
"""Roles and attributes of couplings in version 1.0, and their later names."""

VERSIONS = re.compile(r"(1(\.[0-7])?|2(\.0)?)(\.0)?")
"""Of REXS, that are known."""


def read_model(path: Path) -> Model:
    """Read a REXS file: XML, JSON, or either in a zip archive.

    Raises
    ------
    CaseError
        If it cannot be read or is no REXS.
    """
    try:
        content = read_file(path, ALLOWED.other_bytes)
        if path.suffix.lower() in OTHERS:
            refuse(path, OTHERS[path.suffix.lower()])
        content = unpacked(path, content)
    except OSError as error:
        refuse(path, (error.strerror or "cannot be read").lower())
    except Unreadable as error:
        refuse(path, str(error))
    is_json = content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{"
    try:
        model = _from_json(content) if is_json else _from_xml(content)
    except _NoRexs as error:
        refuse(path, str(error))
    except RecursionError:
        refuse(path, "is nested too deeply")
    if not model.components:
        refuse(path, "is no REXS: it has no components")
    return model


class _NoRexs(Exception):  # noqa: N818 -- reported as a problem, never raised to a user
    """Why a text is no REXS."""


def _from_xml(content: bytes) -> Model:
    root = _parsed(content)
    if root.tag != "model":
        raise _NoRexs(f"is no REXS: its first element is {root.tag}, not model")
    relations = [
        _relation(
            r.get("type", ""), {ref.get("role", ""): ref.get("id", "") for ref in r.iter("ref")}
        )
        for r in root.iterfind("relations/relation")
    ]
    whole = [_component(c) for c in root.iterfind("components/component")]
    cases = [
        {c.get("id", ""): _component(c) for c in case.iter("component")}
        for case in root.iterfind("load_spectrum/load_case")
    ]
    return _loaded(root.get("version", ""), whole, relations, cases)


def _parsed(content: bytes) -> ElementTree.Element:
    """Parse XML that declares no document type: entities are a way to make much of little."""
    builder = ElementTree.TreeBuilder()
    parser = expat.ParserCreate()

    def refuse(*_: Any) -> NoReturn:
        raise _NoRexs("declares a document type, as no REXS does")

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
    try:
        parser.Parse(content, True)
        return builder.close()
    except (expat.ExpatError, AssertionError, ValueError, LookupError) as error:
        raise _NoRexs(f"is not valid XML: {error}") from None


def _component(element: ElementTree.Element) -> Component:
    attributes: dict[str, Value] = {}
    for attribute in element.iterfind("attribute"):
        array = attribute.find("array")
        if array is None:
            value = _scalar((attribute.text or "").strip())
        elif array.get("code"):
            value = _decoded(array.text or "", array.get("code", ""))
        else:
            value = _numbers([(c.text or "").strip() for c in array.iterfind("c")])
        _put(attributes, attribute.get("id", ""), value, attribute.get("unit", ""))
    return Component(
        element.get("id", ""), element.get("type", ""), element.get("name", ""), attributes
    )


def _relation(kind: str, roles: dict[str, str]) -> Relation:
    """Return a relation, couplings as later versions name them."""
    if kind == "coupling" and "side_1" in roles:
        return Relation("side", {FIRST_NAMES.get(role, role): id_ for role, id_ in roles.items()})
    return Relation(kind, roles)


def _put(attributes: dict[str, Value], name: str, value: Value, unit: str) -> None:
    name = FIRST_NAMES.get(name, name)
    read = in_si(name, value, unit)
    if read is None:
        return
    before = attributes.get(name, read)
    if name in QUANTITIES and before != read and not isinstance(before, Unread):
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
        return ""


def _decoded(text: str, code: str) -> Value:
    letter = CODES.get(code)
    if letter is None:
        return ""
    try:
        held = base64.b64decode("".join(text.split()), validate=True)
        return struct.unpack(f"<{len(held) // struct.calcsize(letter)}{letter}", held)
    except (binascii.Error, struct.error, ValueError):
        return ""


def _from_json(content: bytes) -> Model:
    try:
        held = json.loads(content.decode("utf-8-sig"))
    except (UnicodeDecodeError, ValueError) as error:
        raise _NoRexs(f"is not valid JSON: {error}") from None
    model = held.get("model") if isinstance(held, Mapping) else None
    if not isinstance(model, Mapping):
        raise _NoRexs("is no REXS: it has no model")
    relations = [
        _relation(
            str(r.get("type", "")),
            {str(ref.get("role", "")): str(ref.get("id", "")) for ref in tables(r.get("refs"))},
        )
        for r in tables(model.get("relations"))
    ]
    whole = [_json_component(c) for c in tables(model.get("components"))]
    spectrum = model.get("load_spectrum")
    cases = [
        {c.id: c for c in map(_json_component, tables(case.get("components")))}
        for case in tables(spectrum.get("load_cases") if isinstance(spectrum, Mapping) else None)
    ]
    return _loaded(str(model.get("version", "")), whole, relations, cases)


def tables(given: Any) -> list[dict[str, Any]]:
    """Return the tables of a list; nothing of what is no list."""
    return [t for t in given if isinstance(t, dict)] if isinstance(given, list) else []


def _json_component(given: Mapping[str, Any]) -> Component:
    attributes: dict[str, Value] = {}
    for attribute in tables(given.get("attributes")):
        values = [v for k, v in attribute.items() if k not in ("id", "unit")]
        value = _json_value(values[0]) if len(values) == 1 else ""
        _put(attributes, str(attribute.get("id", "")), value, str(attribute.get("unit") or ""))
    return Component(
        str(given.get("id", "")), str(given.get("type", "")), str(given.get("name", "")), attributes
    )


def _json_value(given: Any) -> Value:
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


def _loaded(
    version: str,
    components: list[Component],
    relations: list[Relation],
    cases: list[dict[str, Component]],
) -> Model:
    """Return a model with what its first load case says of components laid over them."""
    whole = {component.id: component for component in components}
    for id_, count in Counter(component.id for component in components).items():
        if count > 1:
            raise _NoRexs(f"has {count} components with the id {id_!r}: every id is that of one")
    notes: tuple[str, ...] = ()
    if not VERSIONS.fullmatch(version):
        given = f"version {version} is not known" if version else "no version is given"
        notes = (f"{given}: read as one from 1.1 to 2.0",)
    if cases:
        notes += (f"loads are those of the first of {len(cases)} load cases",)
        for id_, changed in cases[0].items():
            if id_ in whole:
                one = whole[id_]
                attributes = {**one.attributes, **changed.attributes}
                whole[id_] = Component(one.id, one.type, one.name, attributes)
    once = {(r.type, frozenset(r.roles.items())): r for r in relations}
    if repeated := len(relations) - len(once):
        notes += (f"relations given more than once count once: {repeated} left out",)
    single = tuple(once.values())
    return Model(version, whole, single, notes, _pointless(single, whole))


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
