"""Translation of pydantic's findings into our own words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from loadshare.case.described import about, tables_at
from loadshare.case.element import MARK, Element, Rule, elements_in, fields_by_key
from loadshare.case.keys import Path
from loadshare.case.origin import Origin
from loadshare.case.words import choices, did_you_mean
from loadshare.errors import CaseError
from loadshare.numbers import counted
from loadshare.settings import ALLOWED

Read = TypeVar("Read", bound=Element)

# What each kind of finding asks for; the braces are filled from pydantic's context.
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

SYMBOLS = {
    **dict.fromkeys(("z", "number_of_teeth"), "teeth"),
    **dict.fromkeys(("m", "mn", "m_n", "normal_module"), "module"),
    **dict.fromkeys(("b", "width"), "face_width"),
    **dict.fromkeys(("alpha", "alpha_n"), "pressure_angle"),
    **dict.fromkeys(("r_b", "rb"), "base_radius"),
    **dict.fromkeys(("center", "position"), "centre"),
    **dict.fromkeys(("n", "rpm"), "speed"),
    "x": "profile_shift",
    "beta": "helix_angle",
    "T": "torque",
    "P": "power",
    "k": "stiffness",
}
"""Names that formulas and other programs use for keys of a case."""
TEETH = ("teeth", "module", "face_width", "profile_shift", "addendum", "dedendum", "tip_relief")
"""Keys that users may expect in a mesh, but that belong elsewhere."""
OF_TEETH = (
    'Teeth belong to the gears, or in a pair file that the mesh names: geometry = "pair.toml".'
)


def hint_at(key: object, model: type[Element] | None, known: Iterable[str]) -> str:
    """Return a hint for a key that is unknown where it was given.

    Parameters
    ----------
    key : str or int
    model : type or None
        The element that contains it; None for the case as a whole.
    known : iterable of str
        Keys that are allowed there.

    Returns
    -------
    str
        Which key was meant, or where in a case it belongs; empty if it resembles none.
    """
    from loadshare.case.content import Content

    options = list(known)
    name = SYMBOLS.get(str(key), str(key))
    if name in options:
        return f"Did you mean {name}?"
    models = {
        section: next(elements_in(about.annotation), None)
        for section, about in Content.model_fields.items()
    }
    if model is not None and model not in models.values():
        return OF_TEETH if name in TEETH and "torque" not in options else did_you_mean(key, options)
    if name in TEETH and "geometry" in options:
        return OF_TEETH
    near = did_you_mean(key, options)
    if near:
        return near
    own = {section: found for section, found in models.items() if section not in ASKING and found}
    places = [
        f"[{section}]" if section in SINGLE else f"[{section}.NAME]"
        for section, found in own.items()
        if name in fields_by_key(found)
    ]
    if not places:
        return ""
    *others, last = places
    where = f"{', '.join(others)} or {last}" if others else last
    return f"{name} belongs in {where}."


SINGLE = ("operating", "march")
"""Sections that are one table."""
ASKING = ("study", "measured")
"""Sections that do not describe the machine."""


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
    # The number of findings has no limit, and each is compared with all others.
    found = error.errors(include_url=False)[: ALLOWED.problems]
    return [_rule(one, model) for one in found if not _follows(one, found)]


def validated(model: type[Read], data: Mapping[str, Any], origin: Origin) -> Read:
    """Return plain data as an element.

    Parameters
    ----------
    model : type of Element
    data : mapping
    origin : Origin
        Where its keys are.

    Raises
    ------
    CaseError
        With all problems.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found = translate(error, model)
        problems = [origin.problem(data, f.path, f.message, f.allowed, f.hint) for f in found]
        raise CaseError(problems) from None


def _follows(one: ErrorDetails, found: list[ErrorDetails]) -> bool:
    """Return whether a finding is only a consequence of others.

    A list with a wrong entry also counts as too short, and a default that depends on other keys is
    not made if one of them is wrong.
    """
    if one["type"] == "default_factory_not_called":
        return True
    above = one["loc"]
    inner = any(o["loc"][: len(above)] == above for o in found if len(o["loc"]) > len(above))
    return one["type"] == "too_short" and inner


def _rule(error: ErrorDetails, model: type[Element]) -> Rule:
    path = tuple(step for step in error["loc"] if not str(step).startswith(MARK))
    kind, context = error["type"], error.get("ctx", {})
    if kind == "message":
        return Rule(context["message"], path, context["allowed"], context["hint"])
    if kind == "extra_forbidden":
        keys = _keys(model, path[:-1])
        own = model if len(path) == 1 else None
        hint = hint_at(path[-1], own, keys) if own else did_you_mean(path[-1], keys)
        if not hint and isinstance(error["input"], Mapping):
            hint = "If the dot before it is part of a name, put the name in quotes."
        return Rule("unknown key", path, choices(sorted(keys)), hint)
    if kind == "missing" and isinstance(path[-1], int):
        return Rule(f"has {counted(path[-1])}, but more are needed", path[:-1])
    if kind == "missing":
        return Rule("is missing", path, hint=about(model, path))
    if kind == "literal_error":
        words = context["expected"].replace(" or ", ", ").replace("'", "").split(", ")
        hint = did_you_mean(error["input"], words)
        return Rule("is not one of the allowed words", path, choices(words), hint)
    if kind == "shape":
        return Rule("does not have an allowed form", path, error["msg"])
    given = error["input"]
    if kind == "string_type" and isinstance(given, int | float) and not isinstance(given, bool):
        hint = f"""Write it in quotes; in a shell, in single and double ones, as '"{given}"'."""
        return Rule("is a number, but a text is needed", path, f'a text such as "{given}"', hint)
    wanted = WANTED.get(kind, "another value").format_map(context)
    inner = _keys(model, path) if wanted == "a table" else []
    if inner:
        wanted += f" of {choices(inner)}"
    return Rule("is not valid here", path, wanted)


def _keys(model: type[Element], path: Path) -> list[str]:
    """Return the keys of the table at a path; none if there is no such table."""
    return [key for table in tables_at(model, path)[:1] for key in fields_by_key(table)]
