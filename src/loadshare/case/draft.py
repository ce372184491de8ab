"""A case on its way in: its elements, each read on its own, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, get_args, get_origin

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from loadshare.case.content import Content
from loadshare.case.element import Element, written
from loadshare.case.gears import Errors, Gear
from loadshare.case.keys import Path, look_up
from loadshare.case.links import Ring, Shaft, Spline
from loadshare.case.measured import Measurement
from loadshare.case.meshes import Mesh
from loadshare.case.operation import March, Operating, Stage
from loadshare.case.origin import Origin
from loadshare.case.quantity import as_text
from loadshare.case.study import Study
from loadshare.case.translate import translate
from loadshare.case.words import choices, did_you_mean
from loadshare.errors import Problem


@dataclass
class Draft:
    """The valid elements of a case, by the same names as in `Content`, and the problems found."""

    data: Mapping[str, Any]
    origin: Origin
    problems: list[Problem] = field(default_factory=list)
    title: str = ""
    source: str = ""
    notes: str = ""
    assumed: tuple[str, ...] = ()
    operating: Operating | None = None
    march: March | None = None
    gears: dict[str, Gear] = field(default_factory=dict)
    meshes: dict[str, Mesh] = field(default_factory=dict)
    shafts: dict[str, Shaft] = field(default_factory=dict)
    splines: dict[str, Spline] = field(default_factory=dict)
    rings: dict[str, Ring] = field(default_factory=dict)
    errors: dict[str, Errors] = field(default_factory=dict)
    stages: dict[str, Stage] = field(default_factory=dict)
    measured: dict[str, Measurement] = field(default_factory=dict)
    study: dict[str, Study] = field(default_factory=dict)

    def problem(self, path: Path, message: str, allowed: str = "", hint: str = "") -> Problem:
        """Return a problem with a key, with its file and what was given."""
        return self.origin.problem(self.data, path, message, allowed, hint)

    def has(self, path: Path) -> bool:
        """Tell whether the user gave a key."""
        return look_up(self.data, path) is not None

    def names(self, section: str) -> list[str]:
        """Return the names of all elements of a section, the invalid ones as well."""
        table = self.data.get(section)
        return list(table) if isinstance(table, Mapping) else []

    def sound(self, *sections: str) -> bool:
        """Tell whether every element of the named sections is valid."""
        return all(len(self.names(name)) == len(getattr(self, name)) for name in sections)

    def content(self) -> dict[str, Any]:
        """Return the elements that were given, by section."""
        return {name: getattr(self, name) for name in Content.model_fields if name in self.data}


def read_draft(data: Mapping[str, Any], origin: Origin) -> Draft:
    """Read each element of a case on its own, so that none hides the problems of another.

    Parameters
    ----------
    data : mapping
        A case as plain data.
    origin : Origin
        Where its keys stand.

    Returns
    -------
    Draft
        The valid elements and the problems of the others.
    """
    draft = Draft(data, origin)
    fields = Content.model_fields
    for key in data:
        if key not in fields:
            hint = did_you_mean(key, fields)
            draft.problems.append(draft.problem((key,), "unknown key", choices(fields), hint))
    for name, about in fields.items():
        if name in data:
            _read_section(draft, name, about)
        elif about.is_required():
            hint = about.description or ""
            draft.problems.append(draft.problem((name,), "is missing", hint=hint))
    return draft


def plain(given: Any) -> Any:
    """Return what a user built in Python as plain data, the same that a file would give.

    Parameters
    ----------
    given : object
        Elements, tables, lists, physical values; names may be numbers, None means left out.

    Returns
    -------
    object
        Tables by text, lists, texts and numbers.
    """
    if isinstance(given, Element):
        return written(given)
    if isinstance(given, Mapping):
        return {str(key): plain(item) for key, item in given.items() if item is not None}
    if isinstance(given, list | tuple):
        return [plain(item) for item in given]
    return as_text(given)


def _read_section(draft: Draft, name: str, about: FieldInfo) -> None:
    model = _element_of(name)
    value = draft.data[name]
    if model is not None and not isinstance(value, Mapping):
        draft.problems.append(draft.problem((name,), "cannot stand here", "a table"))
    elif model is None or get_origin(about.annotation) is not dict:
        element = _read(draft, (name,), value, model or about.annotation)
        if element is not None:
            setattr(draft, name, element)
    else:
        found = getattr(draft, name)
        for key, item in value.items():
            path = (name, key)
            element = _read(draft, path, _with_ends(draft, path, item), model)
            if element is not None:
                found[key] = element


def _read(draft: Draft, path: Path, value: Any, kind: Any) -> Any:
    try:
        return _adapter(kind).validate_python(value)
    except ValidationError as error:
        model = kind if isinstance(kind, type) and issubclass(kind, Element) else Content
        for details in error.errors(include_url=False):
            found = translate(details, model)
            draft.problems.append(
                draft.problem((*path, *found.path), found.message, found.allowed, found.hint)
            )
    return None


def _with_ends(draft: Draft, path: Path, item: Any) -> Any:
    """Return an element with the gears that its name tells, or None where it tells none."""
    keys = {"meshes": ("driver", "driven"), "shafts": ("ends",)}.get(str(path[0]))
    if keys is None or not isinstance(item, Mapping) or all(key in item for key in keys):
        return item
    ends = _ends(str(path[1]), draft.names("gears"))
    if ends is None:
        own = " and ".join(keys)
        draft.problems.append(
            draft.problem(path, "the name does not tell two gears", f"a name a-b, or {own} within")
        )
        # The rest of the element is still worth reading.
        ends = ("", "")
    told = dict(zip(keys, ends if len(keys) == 2 else (ends,), strict=True))
    return {**told, **item}


def _ends(name: str, gears: list[str]) -> tuple[str, str] | None:
    """Return the two gears of a name a-b; a gear's own name may hold dashes."""
    at = [index for index, letter in enumerate(name) if letter == "-"]
    splits = [(name[:index], name[index + 1 :]) for index in at]
    known = [split for split in splits if set(split) <= set(gears)]
    candidates = known or splits
    return candidates[0] if len(candidates) == 1 else None


def _element_of(section: str) -> type[Element] | None:
    return next(_elements(Content.model_fields[section].annotation), None)


def _elements(annotation: Any) -> Iterator[type[Element]]:
    if isinstance(annotation, type) and issubclass(annotation, Element):
        yield annotation
    for inner in get_args(annotation):
        yield from _elements(inner)


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)
