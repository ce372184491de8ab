"""Descriptions of fields, from the docstrings below them: for the schema and for messages.

They are read from the source when first needed. Few cases need them, and reading them when the
elements are defined would take a quarter of the start-up time of a command.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import Any, get_args, get_origin

from loadshare.case.element import Element, elements_in, fields_by_key
from loadshare.case.keys import Path


def description(model: type[Element], field: str) -> str:
    """Return the description of a field of an element; empty where there is none."""
    return next((texts[field] for m in model.__mro__ if field in (texts := _texts(m))), "")


def about(model: type[Element], path: Path) -> str:
    """Return the first line that describes a key, or else the nearest table above it."""
    for *above, step in (path[:length] for length in range(len(path), 0, -1)):
        for table in tables_at(model, tuple(above)):
            field = fields_by_key(table).get(str(step))
            text = description(table, field) if field else ""
            if text:
                return text.splitlines()[0]
    return ""


def kinds_at(model: type[Element], path: Path) -> list[Any]:
    """Return the annotations of what an element may hold at a key."""
    kinds: list[Any] = [model]
    for step in path:
        kinds = [below for kind in kinds for below in _below(kind, step)]
    return kinds


def tables_at(model: type[Element], path: Path) -> list[type[Element]]:
    """Return the elements that an element may hold at a key."""
    return [table for kind in kinds_at(model, path) for table in _tables(kind)]


def _below(kind: Any, step: str | int) -> Iterator[Any]:
    """Yield the annotations of what such a value holds at a key or list index."""
    if get_origin(kind) is dict:
        yield get_args(kind)[1]
    elif get_origin(kind) is tuple:
        if isinstance(step, int):
            yield get_args(kind)[0]
    elif isinstance(kind, type) and issubclass(kind, Element):
        if (field := fields_by_key(kind).get(str(step))) is not None:
            yield kind.model_fields[field].annotation
            yield from kind.model_fields[field].metadata
    else:
        for inner in get_args(kind):
            yield from _below(inner, step)


def _tables(kind: Any) -> Iterator[type[Element]]:
    """Yield the elements that an annotation allows, outside lists and tables."""
    if isinstance(kind, type) and issubclass(kind, Element):
        yield kind
    elif get_origin(kind) not in (dict, tuple):
        for inner in get_args(kind):
            yield from _tables(inner)


def schema_of(model: type[Element], **settings: Any) -> dict[str, Any]:
    """Return the JSON Schema of an element, with descriptions of all fields, nested ones included.

    Parameters
    ----------
    model : type of Element
    **settings
        As for `pydantic.BaseModel.model_json_schema`.
    """
    for each in _within(model, {model}):
        for name, about in each.model_fields.items():
            about.description = description(each, name) or about.description
        each.model_rebuild(force=True)
    return model.model_json_schema(**settings)


def _within(model: type[Element], seen: set[type[Element]]) -> Iterator[type[Element]]:
    """Yield the types of elements nested in an element, except those seen, and last its own."""
    for about in model.model_fields.values():
        for inner in elements_in(about.annotation):
            if inner not in seen:
                seen.add(inner)
                yield from _within(inner, seen)
    yield model


@cache
def _texts(model: type) -> dict[str, str]:
    if not (issubclass(model, Element) and model is not Element):
        return {}
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(model))).body
    assert isinstance(tree, ast.ClassDef)
    return {
        field.target.id: inspect.cleandoc(text.value.value)
        for field, text in pairwise(tree.body)
        if isinstance(field, ast.AnnAssign)
        and isinstance(field.target, ast.Name)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
        and isinstance(text.value.value, str)
    }
