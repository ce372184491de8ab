"""A case while it is read: its elements, each read on its own, and their problems."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Set
from functools import cache
from typing import Any, TypeVar, get_origin

from pydantic import ConfigDict, PrivateAttr, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from loadshare.case.content import ENDS, Content, Sections
from loadshare.case.described import description
from loadshare.case.element import Element, elements_in, written
from loadshare.case.keys import Path, dotted, ends_of
from loadshare.case.origin import Origin
from loadshare.case.place import Vector
from loadshare.case.quantity import as_text
from loadshare.case.translate import hint_at, translate
from loadshare.case.words import choices
from loadshare.errors import CaseError, Problem
from loadshare.settings import ALLOWED

Found = TypeVar("Found")
MORE = f"has more problems than the {ALLOWED.problems:,} shown"


class Draft(Sections):
    """The valid elements of a case, and the problems of the others."""

    model_config = ConfigDict(frozen=False)

    _problems: list[Problem] = PrivateAttr(default_factory=list)
    _known: dict[str, Any] = PrivateAttr(default_factory=dict)

    @property
    def data(self) -> Mapping[str, Any]:
        """The case as plain data."""
        return self._data

    @property
    def problems(self) -> list[Problem]:
        """Problems of single elements."""
        return self._problems

    def add_problem(self, path: Path, message: str, allowed: str = "", hint: str = "") -> None:
        """Add a problem with a key.

        Raises
        ------
        CaseError
            If the largest number of problems is reached.
        """
        self._problems.append(self.problem(path, message, allowed, hint))
        if len(self._problems) >= ALLOWED.problems:
            raise CaseError([*self._problems, self.problem((), MORE, "", "")])

    def cached(self, name: str, find: Callable[[], Found]) -> Found:
        """Return a value that several checks need, computed once, after all elements were read."""
        if name not in self._known:
            self._known[name] = find()
        found: Found = self._known[name]
        return found

    def centres(self) -> dict[str, Vector]:
        """Return the centres [m] of all gears for which they are given or can be derived."""
        return self.cached("centres", super().centres)

    def names(self, section: str) -> list[str]:
        """Return the names of all elements of a section, the invalid ones as well."""
        table = self._data.get(section)
        return list(table) if isinstance(table, Mapping) else []

    def sound(self, *sections: str) -> bool:
        """Tell whether every element of the named sections is valid."""
        return all(len(self.names(name)) == len(getattr(self, name)) for name in sections)


def read_draft(
    data: Mapping[str, Any],
    origin: Origin,
    before: tuple[Sections, Mapping[str, Any]] | None = None,
) -> Draft:
    """Read each element of a case on its own, so that none hides the problems of another.

    Parameters
    ----------
    data : mapping
        A case as plain data.
    origin : Origin
        Where its keys are.
    before : (Sections, mapping), optional
        An earlier case and its plain data: parts that are the same objects there are not read
        again.

    Returns
    -------
    Draft
        The valid elements and the problems of the others.
    """
    fields = Content.model_fields
    draft = Draft.model_construct(**defaults())
    draft._data, draft._origin = data, origin
    if before is not None and [*before[1]["gears"]] != draft.names("gears"):
        # With other gears, a name a-b may stand for another pair.
        before = None
    if data and not any(key in fields for key in data):
        draft.add_problem((), "contains none of the sections of a case", choices(fields))
        return draft
    for key in data:
        if key not in fields:
            draft.add_problem((key,), "unknown key", choices(fields), hint_at(key, None, fields))
    for name, about in fields.items():
        if about.is_required() and data.get(name, {}) == {}:
            missing = "is empty" if name in data else "is missing"
            draft.add_problem((name,), missing, hint=description(Content, name))
        elif name in data:
            _read_section(draft, name, about, before)
    return draft


def as_data(given: Any, file: str = "case", path: Path = ()) -> Any:
    """Return what a user built in Python as the plain data that a file would give.

    Parameters
    ----------
    given : object
        Elements, tables, lists, arrays, physical values; names may be numbers, None means left
        out.
    file : str
    path : tuple of str or int
        Where the object is, for messages.

    Returns
    -------
    object
        Tables with text keys, lists, texts and numbers.

    Raises
    ------
    CaseError
        If it is nested too deeply, or holds too many entries or something that no file can hold.
    """
    if len(path) > ALLOWED.depth:
        allowed = f"at most {ALLOWED.depth} levels of tables and lists"
        raise CaseError([Problem(file, "", "", "is nested too deeply", allowed)])
    if isinstance(given, Element):
        return written(given)
    if isinstance(given, Mapping):
        if len(given) > ALLOWED.entries:
            message, allowed = f"has {len(given)} entries", f"at most {ALLOWED.entries}"
            raise CaseError([Problem(file, dotted(path), "", message, allowed)])
        named = ((str(k), item) for k, item in given.items() if item is not None)
        return {key: as_data(item, file, (*path, key)) for key, item in named}
    given = as_text(given)
    if hasattr(given, "dtype") and hasattr(given, "tolist"):
        # A NumPy array or a pandas column; neither library is imported just to test for one.
        given = given.tolist()
    if isinstance(given, list | tuple | range | Iterator):
        return [as_data(item, file, (*path, k)) for k, item in enumerate(given)]
    if isinstance(given, bytes | Set):
        message, allowed = f"is of type {type(given).__name__}", "tables, lists, texts and numbers"
        raise CaseError([Problem(file, dotted(path), repr(given), message, allowed)])
    return given


def defaults() -> dict[str, Any]:
    """Return the default of each section.

    Pydantic inspects the signature of every default factory, which takes longer than reading.
    """
    fields = Draft.model_fields.items()
    return {name: {} if about.default_factory else about.default for name, about in fields}


def _read_section(
    draft: Draft,
    name: str,
    about: FieldInfo,
    before: tuple[Sections, Mapping[str, Any]] | None,
) -> None:
    value = draft.data[name]
    known = before[1].get(name) if before is not None else None
    if before is not None and value is known:
        setattr(draft, name, getattr(before[0], name))
        return
    model = next(elements_in(about.annotation), None)
    most = ALLOWED.elements if isinstance(value, Mapping) else ALLOWED.entries
    if isinstance(value, Mapping | list) and len(value) > most:
        draft.add_problem((name,), f"has {len(value)} entries", f"at most {most}")
        return
    if model is not None and not isinstance(value, Mapping):
        named = isinstance(value, list) and get_origin(about.annotation) is dict
        hint = f"Write [{name}.NAME] for each." if named else ""
        draft.add_problem((name,), "is not valid here", "a table", hint)
    elif model is None or get_origin(about.annotation) is not dict:
        element = _read(draft, (name,), value, model or about.rebuild_annotation())
        if element is not None:
            setattr(draft, name, element)
    else:
        read = getattr(before[0], name) if before is not None and isinstance(known, Mapping) else {}
        for key, item in value.items():
            path = (name, key)
            if key in read and known is not None and known[key] is item:
                getattr(draft, name)[key] = read[key]
                continue
            if not 0 < len(key) <= ALLOWED.name or not key.isprintable() or key != key.strip():
                allowed = f"1 to {ALLOWED.name} printable characters, no space at either end"
                draft.add_problem(path, "cannot be a name", allowed)
            element = _read(draft, path, _with_ends(draft, path, item), model)
            if element is not None:
                getattr(draft, name)[key] = element


def _read(draft: Draft, path: Path, value: Any, kind: Any) -> Any:
    try:
        return _adapter(kind).validate_python(value)
    except ValidationError as error:
        model = kind if isinstance(kind, type) and issubclass(kind, Element) else Content
        for found in translate(error, model):
            draft.add_problem((*path, *found.path), found.message, found.allowed, found.hint)
    return None


def _with_ends(draft: Draft, path: Path, item: Any) -> Any:
    """Return an element with the gears that its name gives; add a problem if it gives none."""
    keys = ENDS.get(str(path[0]))
    if keys is None or not isinstance(item, Mapping) or all(key in item for key in keys):
        return item
    ends = ends_of(str(path[1]), draft.names("gears"))
    if ends is None:
        own = " and ".join(keys)
        draft.add_problem(
            path, "the name does not give two gears", f"a name a-b, or {own} in the table"
        )
        # The rest of the element is still worth reading.
        ends = ("", "")
    named = dict(zip(keys, ends if len(keys) == 2 else (ends,), strict=True))
    return {**named, **item}


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)
