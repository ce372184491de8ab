"""pydantic's findings in our own words."""

from __future__ import annotations

from pydantic import ValidationError
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

TEETH = ("module", "face_width", "profile_shift", "addendum", "dedendum", "tip_relief")
"""Keys that one may expect of a mesh, and that stand elsewhere."""
OF_TEETH = (
    'Teeth stand with the gears, or in a pair file that the mesh names: geometry = "pair.toml".'
)


def translate(error: ValidationError, model: type[Element]) -> list[Rule]:
    """Return pydantic's findings in our own words, each mistake once.

    Parameters
    ----------
    error : pydantic.ValidationError
        The findings.
    model : type
        The element on which they were made.

    Returns
    -------
    list of Rule
        The same, for the user.
    """
    found = error.errors(include_url=False)
    return [_told(one, model) for one in found if not _follows(one, found)]


def _follows(one: ErrorDetails, found: list[ErrorDetails]) -> bool:
    """Whether a finding only follows from others.

    A list is too short for an entry that is wrong, and a default that follows other keys cannot be
    made while one of them is.
    """
    if one["type"] == "default_factory_not_called":
        return True
    above = one["loc"]
    inner = any(o["loc"][: len(above)] == above for o in found if len(o["loc"]) > len(above))
    return one["type"] == "too_short" and inner


def _told(error: ErrorDetails, model: type[Element]) -> Rule:
    path = tuple(step for step in error["loc"] if not str(step).startswith(MARK))
    kind, context = error["type"], error.get("ctx", {})
    if kind == "said":
        return Rule(context["said"], path, context["allowed"], context["hint"])
    if kind == "extra_forbidden":
        keys = list(map(str, _fields(model, path[:-1])))
        hint = OF_TEETH if path[-1] in TEETH else did_you_mean(path[-1], keys)
        return Rule("unknown key", path, choices(sorted(keys)), hint)
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
