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
from typing import Any

from loadshare.case.element import Element, elements_in


def description(model: type[Element], field: str) -> str:
    """Return the description of a field of an element; empty where there is none."""
    return next((texts[field] for m in model.__mro__ if field in (texts := _texts(m))), "")


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
