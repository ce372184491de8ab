"""The case: a user's description of a transmission, checked, with every value as written."""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Self

from pydantic import PrivateAttr

from loadshare.arguments import check_mapping
from loadshare.case.checks import check
from loadshare.case.content import ABOUT, Content
from loadshare.case.copies import with_copies
from loadshare.case.draft import as_data, defaults, read_draft
from loadshare.case.element import Element
from loadshare.case.keys import Path, covers, parse
from loadshare.case.origin import CHANGES, Origin
from loadshare.case.revise import differing, revise
from loadshare.case.table import fixed
from loadshare.errors import CaseError
from loadshare.output import write_whole
from loadshare.readable import readable
from loadshare.table import text_table
from loadshare.view import View

if TYPE_CHECKING:
    from loadshare.case.gears import Gear


class Case(Content):
    """A transmission, how it is loaded, and what is known about these inputs.

    Physical values may be texts with a unit, pint quantities or `Quantity`; elements may be tables
    or models. Two cases are equal if their contents are, even if their names or files differ.

    Parameters
    ----------
    content : mapping, optional
        The sections of a case file, see `Content`.
    name : str
        Name of the case, by default that of its file.
    origin : Origin, optional
        Where its keys were written; for messages.
    **sections
        More sections, or all of them.

    Raises
    ------
    CaseError
        With all problems of the case at once.
    """

    _name: str = PrivateAttr()
    _hash: str | None = PrivateAttr(default=None)

    def __init__(
        self,
        content: Mapping[str, Any] | None = None,
        /,
        *,
        name: str = "",
        origin: Origin | None = None,
        **sections: Any,
    ) -> None:
        check_mapping("sections by name", "{'gears': {}}", content or {})
        if not isinstance(name, str):
            raise TypeError(f"the name of a case is a text, not {type(name).__name__}")
        # A file could not hold a control character, nor its digest a lone surrogate.
        name = readable(name)
        origin = origin or Origin(name or "case", outside=True)
        self._take(as_data({**(content or {}), **sections}, origin.file), origin, name, None)

    def _take(self, data: dict[str, Any], origin: Origin, name: str, before: Case | None) -> None:
        """Read and check plain data, except what is shared with an earlier case."""
        data, origin = with_copies(data, origin)
        draft = read_draft(data, origin, None if before is None else (before, before._data))
        problems = [*draft.problems, *check(draft, None if draft.problems else before)]
        if problems:
            raise CaseError(problems)
        given = {n: getattr(draft, n) for n in Content.model_fields if n in data}
        # Each section has been validated: validating all of them again would find nothing new.
        content = {name: fixed(section) for name, section in {**defaults(), **given}.items()}
        made = Content.model_construct(_fields_set={*given}, **content)
        for slot in ("__dict__", "__pydantic_fields_set__", "__pydantic_extra__"):
            object.__setattr__(self, slot, getattr(made, slot))
        self.model_post_init(None)
        self._data, self._origin, self._name = data, origin, name

    @property
    def name(self) -> str:
        """Name of the case, by default that of its file without the ending."""
        return self._name

    @property
    def hash(self) -> str:
        """SHA-256 of what affects the mechanics: the values in SI units, no titles and notes."""
        if self._hash is None:
            content = {n: _in_si(getattr(self, n)) for n in Content.model_fields if n not in ABOUT}
            text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
            self._hash = hashlib.sha256(text.encode()).hexdigest()
        return self._hash

    @property
    def files(self) -> tuple[FilePath, ...]:
        """Files that the case is read from: its own, those it extends, and those of mesh laws."""
        found = [self._origin.file, *self._origin.files.values()]
        return (*(FilePath(name) for name in dict.fromkeys(found)), *self.law_files)

    @property
    def law_files(self) -> tuple[FilePath, ...]:
        """Files that mesh laws are read from, or computed from."""
        return tuple(FilePath(file).parent / named for file, named in self._named_files)

    @property
    def _named_files(self) -> tuple[tuple[str, str], ...]:
        """Files of mesh laws, each after the file that names it."""
        return tuple(
            (self._origin.of(("meshes", name, key)), getattr(mesh, key))
            for name, mesh in self.meshes.items()
            for key in mesh.given("law_file", "geometry")
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the case as plain data, with every value as it was written.

        Returns
        -------
        dict
            Tables, lists, texts and numbers, by the keys of the case file.
        """
        return copy.deepcopy(dict(self._data))

    def to_toml(self, path: str | FilePath | None = None) -> str:
        """Return the case as a file that extends no other, and write it if a path is given.

        Files of mesh laws are named as they are, relative to the case's own folder.

        Parameters
        ----------
        path : str or pathlib.Path, optional
            File to write.

        Returns
        -------
        str
            The text; `load_case` on it in that folder gives an equal case.
        """
        from loadshare.case.writer import toml_text

        text = toml_text(self._data)
        if path is not None:
            write_whole(FilePath(path), text)
        return text

    def replace(self, changes: Mapping[str, Any]) -> Case:
        """Return a copy with some keys changed, checked like any other case.

        Parameters
        ----------
        changes : mapping of str to object
            New values by dotted key path, as in ``{'meshes."4-6".stiffness': "4e6 N*m/rad"}``;
            None removes the key.

        Returns
        -------
        Case
            The changed case.

        Raises
        ------
        CaseError
            If a path does not exist, or with all problems of the changed case.
        """
        data, origin = revise(self._data, self._origin, changes)
        changed = type(self).__new__(type(self))
        changed._take(data, origin, self._name, self)
        return changed

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy, as pydantic does; use `replace` to change something in it.

        Raises
        ------
        TypeError
            If there are updates, which would be neither checked nor written to a file.
        """
        if update:
            raise TypeError(
                "cases cannot be changed; Case.replace makes a new one with other values"
            )
        return super().model_copy(deep=deep)

    def copy(self, **arguments: Any) -> Self:
        """Return a copy as `model_copy` does: pydantic's older method would check no update."""
        return self.model_copy(**arguments)

    def differences(self, before: Case) -> Iterator[tuple[Path, Any, Any]]:
        """Yield each key in which the case differs from an earlier one, with its value in both.

        A value is None where the key is missing. For a case that `replace` made this takes no time.
        """
        return iter(differing(before._data, self._data))

    def changes_since(self, before: Case) -> dict[Path, Any] | None:
        """Return what `replace` has changed since an earlier case; None if it was not `replace`.

        Parameters
        ----------
        before : Case

        Returns
        -------
        dict of Path to object, or None
            Each new value, by its key; both cases name the same files in the same places.
        """

        def place(case: Case) -> tuple[Any, ...]:
            origin = case._origin
            return case._name, origin.file, origin.outside, case._named_files

        found = {path: after for path, _, after in self.differences(before)}
        replaced = all(self._origin.of(path) == CHANGES for path in found)
        return found if replaced and place(self) == place(before) else None

    def is_assumed(self, key: str) -> bool:
        """Tell whether an input, or a table that holds it, is marked as assumed.

        Parameters
        ----------
        key : str
            Dotted key path.

        Returns
        -------
        bool
            Whether a pattern of `assumed` covers it.
        """
        path = parse(key)
        return any(covers(parse(pattern), path) for pattern in self.assumed)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Case):
            return NotImplemented
        return self.__dict__ == other.__dict__

    def __hash__(self) -> int:
        return hash(self.hash)

    def __repr__(self) -> str:
        parts = f"{len(self.gears)} gears, {len(self.meshes)} meshes"
        return f"Case({self._name or 'unnamed'}: {parts})"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        return _view(self).html


def _in_si(part: Any) -> Any:
    """Return a section as plain data, with every value in SI units."""
    if isinstance(part, dict):
        return {name: _in_si(item) for name, item in part.items()}
    if isinstance(part, Element):
        return part.model_dump(mode="json", by_alias=True, context="SI")
    return part


ELEMENTS = ("gears", "meshes", "shafts", "splines", "rings", "bearings", "errors")


def _view(case: Case) -> View:
    """Return the view of a case: its title, load and gears."""
    counts = {name: len(getattr(case, name)) for name in ELEMENTS}
    facts = (
        ("title", case.title),
        ("source", case.source),
        ("operating point", _operating(case)),
        ("elements", ", ".join(f"{name} {count}" for name, count in counts.items() if count)),
        ("stages", ", ".join(case.stages)),
        ("assumed", ", ".join(case.assumed)),
        ("studies", ", ".join(case.study)),
    )
    rows = ((name, gear.type, _held(case, name, gear)) for name, gear in case.gears.items())
    heads = ("gear", "type", "held by")
    gears = text_table("Gears", heads, rows, words=heads)
    return View(f"Case {case.name or 'unnamed'}", facts, (gears,))


def _operating(case: Case) -> str:
    point = case.operating
    given = case.to_dict()["operating"]
    load = ", ".join(f"{k} {given[k]}" for k in ("torque", "power", "speed") if k in given)
    return f"{point.input} → {point.output}, {load}"


def _held(case: Case, name: str, gear: Gear) -> str:
    if gear.held:
        return "held"
    if case.floats(name):
        return "floats"
    return gear.support if isinstance(gear.support, str) else "elastic" if gear.support else "rigid"
