"""pydantic's findings in our own words."""

from __future__ import annotations

from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from loadshare.case.element import MARK, Element, Rule, elements_in
from loadshare.case.keys import Path
from loadshare.case.words import choices, count, did_you_mean

# What each kind of finding is called; the braces are filled from pydantic's context.
WANTED = {
    "string_type": "a text",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "tuple_type": "a list",
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a number of at least {ge:g}",
    "less_than": "a number below {lt:g}",
    "less_than_equal": "a number of at most {le:g}",
    "too_short": "a list of at least {min_length}",
    "too_long": "a list of at most {max_length}",
}


def translate(error: ErrorDetails, model: type[Element]) -> Rule:
    """Return one of pydantic's findings in our own words.

    Parameters
    ----------
    error : pydantic_core.ErrorDetails
        The finding.
    model : type
        The element on which it was made.

    Returns
    -------
    Rule
        The same, for the user.
    """
    path = tuple(step for step in error["loc"] if not str(step).startswith(MARK))
    kind, context = error["type"], error.get("ctx", {})
    if kind == "said":
        return Rule(context["said"], path, context["allowed"], context["hint"])
    if kind == "extra_forbidden":
        keys = list(map(str, _fields(model, path[:-1])))
        return Rule("unknown key", path, choices(sorted(keys)), did_you_mean(path[-1], keys))
    if kind == "missing" and isinstance(path[-1], int):
        return Rule(f"has {count(path[-1])}, more are needed", path[:-1])
    if kind == "missing":
        about = _fields(model, path[:-1]).get(path[-1])
        described = ((about and about.description) or "").split("\n")[0]
        return Rule("is missing", path, hint=described)
    if kind == "literal_error":
        words = context["expected"].replace(" or ", ", ").replace("'", "").split(", ")
        hint = did_you_mean(error["input"], words)
        return Rule("is not one of the words that can stand here", path, choices(words), hint)
    if kind == "shape":
        return Rule("is not of a form that can stand here", path, error["msg"])
    wanted = WANTED.get(kind, "another value").format_map(context)
    return Rule("cannot stand here", path, wanted)


def _fields(model: type[Element], path: Path) -> dict[str | int, FieldInfo]:
    """Fields, by their keys, of the table that a path leads to; none where it leads nowhere."""
    found = _by_key(model)
    for step in path:
        inner = next(elements_in(found[step].annotation), None) if step in found else None
        found = _by_key(inner) if inner else {}
    return found


def _by_key(model: type[Element]) -> dict[str | int, FieldInfo]:
    return {about.alias or name: about for name, about in model.model_fields.items()}
