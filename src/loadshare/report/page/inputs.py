"""The inputs of a case as tables, with their units as they were written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from loadshare.case import Case
from loadshare.case.content import ABOUT, Content
from loadshare.case.keys import dotted
from loadshare.numbers import NONE
from loadshare.table import Cell, Column, Table


def input_tables(case: Case) -> Iterator[Table]:
    """Yield one table for each section of a case; assumed inputs are marked.

    Parameters
    ----------
    case : Case
    """
    data = case.to_dict()
    for section in Content.model_fields:
        found = data.get(section)
        if section in ABOUT or not found:
            continue
        title = section.capitalize()
        if all(isinstance(item, Mapping) for item in found.values()):
            yield _elements(case, section, title, found)
        else:
            columns = [Column("key"), Column("value")]
            rows = [[Cell(key), _cell(case, (section, key), v)] for key, v in found.items()]
            yield Table(title, columns, rows)


def _elements(case: Case, section: str, title: str, found: Mapping[str, Any]) -> Table:
    keys = list(dict.fromkeys(key for element in found.values() for key in element))
    rows = [
        [Cell(name), *(_cell(case, (section, name, k), element.get(k)) for k in keys)]
        for name, element in found.items()
    ]
    return Table(title, [Column("name"), *map(Column, keys)], rows)


def _cell(case: Case, path: tuple[str, ...], value: Any) -> Cell:
    if value is None:
        return Cell(NONE)
    assumed = case.is_assumed(dotted(path))
    if isinstance(value, Mapping) and not assumed:
        assumed = any(case.is_assumed(dotted((*path, key))) for key in value)
    return Cell(written(value), assumed=assumed)


def written(value: Any) -> str:
    """Return an input as words: lists with commas, tables as ``key value``."""
    if isinstance(value, Mapping):
        return "; ".join(f"{key} {written(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        nested = any(isinstance(item, list | tuple) for item in value)
        return (" | " if nested else ", ").join(written(item) for item in value)
    return str(value).lower() if isinstance(value, bool) else str(value)
