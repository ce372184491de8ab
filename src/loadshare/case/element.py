"""The base class of all elements of a case (frozen, strict, with rules across fields)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self, TypeVar, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    ValidationError,
    model_validator,
)
from pydantic_core import InitErrorDetails

from loadshare.case.keys import Path, look_up
from loadshare.case.quantity import Quantity, refusal
from loadshare.case.table import fixed
from loadshare.readable import CONTROL
from loadshare.settings import ALLOWED

# Prefix of the steps in pydantic's error locations that name a shape of a value, not a key.
MARK = "shape:"
VALUE, LIST, NESTED, TABLE, LIMITS = (
    f"{MARK}{name}" for name in ("value", "list", "nested", "table", "limits")
)


@dataclass(frozen=True)
class Rule:
    """A broken rule across the fields of an element.

    Parameters
    ----------
    message : str
        What is wrong, without a full stop.
    path : tuple of str or int
        The key concerned, below the element.
    allowed, hint : str
        As in `Problem`.
    """

    message: str
    path: Path = ()
    allowed: str = ""
    hint: str = ""

    @classmethod
    def exclusive(cls, key: str, other: str, allowed: str = "") -> Rule:
        """Return the rule that is broken where a key is given besides another."""
        return cls(f"cannot be combined with {other}: give one or the other", (key,), allowed)

    @classmethod
    def required(cls, key: str, other: str, allowed: str = "") -> Rule:
        """Return the rule that is broken where a key is missing that another one needs."""
        return cls("is missing", (key,), allowed, f"It is required with {other}.")


class Element(BaseModel):
    """Base of the tables of a case file."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        # Most cases hold few kinds of elements: the validator of a kind is built when first needed.
        defer_build=True,
        protected_namespaces=(),
    )

    ALTERNATIVES: ClassVar[tuple[tuple[tuple[str, ...], ...], ...]] = ()
    """For each property that can be given in several ways, the keys of each way."""

    def rules(self) -> Iterator[Rule]:
        """Yield the rules across this element's fields that are broken.

        Yields
        ------
        Rule
            One for each.
        """
        yield from ()

    @model_validator(mode="after")
    def _keep_rules(self) -> Self:
        broken = [
            InitErrorDetails(
                type=refusal(rule.message, rule.allowed, rule.hint),
                loc=rule.path,
                input=look_up(written(self), rule.path) if rule.path else None,
            )
            for rule in self.rules()
        ]
        if broken:
            raise ValidationError.from_exception_data(type(self).__name__, broken)
        for name, value in self.__dict__.items():
            if isinstance(value, dict):
                self.__dict__[name] = fixed(value)
        return self

    def given(self, *fields: str) -> list[str]:
        """Return those of the named fields that hold a value, as the keys of the case file.

        Parameters
        ----------
        *fields : str
            Names of fields.

        Returns
        -------
        list of str
            The keys, in the same order.
        """
        return [name for name in fields if getattr(self, name) is not None]


def written(element: Element) -> dict[str, Any]:
    """Return an element as plain data, with what the user wrote and nothing else.

    Parameters
    ----------
    element : Element
        The element.

    Returns
    -------
    dict
        Tables, lists, texts and numbers, by the keys of the case file.
    """
    data: dict[str, Any] = element.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return data


def same_but_for_values(one: Any, other: Any) -> bool:
    """Tell whether two parts of a case differ at most in physical values that both have.

    Parameters
    ----------
    one, other : Element, table, tuple, value or word
    """
    if one is other:
        return True
    if isinstance(one, dict) and isinstance(other, dict):
        parts = zip(one.values(), other.values(), strict=False)
        return [*one] == [*other] and all(same_but_for_values(*both) for both in parts)
    if type(one) is not type(other):
        return False
    if isinstance(one, tuple):
        parts = zip(one, other, strict=False)
        return len(one) == len(other) and all(same_but_for_values(*both) for both in parts)
    if isinstance(one, Element):
        fields = type(one).model_fields
        return one.model_fields_set == other.model_fields_set and all(
            same_but_for_values(getattr(one, name), getattr(other, name)) for name in fields
        )
    return isinstance(one, Quantity) or bool(one == other)


def without_alternatives(model: type[Element], low: Any, high: Any) -> Any:
    """Return `low` without the keys of a property that `high` gives in another way.

    Parameters
    ----------
    model : type of Element
    low, high : mapping
        Plain data of an element, and those that take precedence.
    """
    gone: set[str] = set()
    for ways in model.ALTERNATIVES:
        if any(key in high for way in ways for key in way):
            gone.update(key for way in ways if not any(k in high for k in way) for key in way)
    return {key: value for key, value in low.items() if key not in gone}


def elements_in(annotation: Any) -> Iterator[type[Element]]:
    """Yield the elements that a field may hold, in the order of its annotation."""
    if isinstance(annotation, type) and issubclass(annotation, Element):
        yield annotation
    for inner in get_args(annotation):
        yield from elements_in(inner)


def fields_by_key(model: type[Element]) -> dict[str, str]:
    """Return the names of an element's fields by their keys in a case file."""
    return {about.alias or name: name for name, about in model.model_fields.items()}


def shaped(allowed: str, *, limits: tuple[str, ...] = ()) -> Discriminator:
    """Return a discriminator that picks a union's member by shape: one problem, not several.

    Parameters
    ----------
    allowed : str
        What may be given, in words.
    limits : tuple of str
        Keys by which a table belongs to the `LIMITS` member rather than the `TABLE` one.

    Returns
    -------
    pydantic.Discriminator
        For members tagged `VALUE`, `LIST`, `NESTED` (list of lists), `TABLE` or `LIMITS`.
    """

    def shape(value: Any) -> str:
        if isinstance(value, Mapping):
            return LIMITS if any(key in value for key in limits) else TABLE
        if isinstance(value, Element):
            return LIMITS if any(hasattr(value, key) for key in limits) else TABLE
        if isinstance(value, list | tuple):
            return NESTED if value and isinstance(value[0], list | tuple) else LIST
        return VALUE

    return Discriminator(shape, custom_error_type="shape", custom_error_message=allowed)


T = TypeVar("T")
_HIGH = ALLOWED.largest
_LOW = ALLOWED.smallest
Number = Annotated[float, Strict(), Field(ge=-_HIGH, le=_HIGH, allow_inf_nan=False)]
Positive = Annotated[float, Strict(), Field(ge=_LOW, le=_HIGH, allow_inf_nan=False)]
NotNegative = Annotated[float, Strict(), Field(ge=0, le=_HIGH, allow_inf_nan=False)]
Turns = Annotated[float, Strict(), Field(gt=0, le=ALLOWED.revolutions, allow_inf_nan=False)]


def _readable(text: str) -> str:
    if found := CONTROL.search(text):
        allowed = "printable characters, line breaks and tabs"
        raise refusal(f"holds a control character, {found[0]!a}", allowed)
    return text


Text = Annotated[str, AfterValidator(_readable)]
"""Text for human readers."""

Count = Annotated[int, Strict(), Field(ge=1, le=ALLOWED.samples)]
Positions = Annotated[int, Strict(), Field(ge=1, le=ALLOWED.positions)]
Steps = Annotated[int, Strict(), Field(ge=1, le=ALLOWED.steps)]

OneOrMore = Annotated[T, Tag(VALUE)] | Annotated[tuple[T, ...], Field(min_length=1), Tag(LIST)]
PerPosition = Annotated[
    OneOrMore[T], shaped("a value with its unit, or a list of them, one per position")
]
"""A value that may be given once, or once per position."""


def without_default(schema: dict[str, Any]) -> None:
    """Delete from a schema, in place, a default that no user would write."""
    del schema["default"]


def values(value: Quantity | tuple[Quantity, ...]) -> tuple[float, ...]:
    """Return a value that may be given per position as a list [SI units].

    Parameters
    ----------
    value : Quantity or tuple of Quantity
        A value that may be given per position.

    Returns
    -------
    tuple of float
        One value, or one per position.
    """
    return tuple(item.si for item in (value if isinstance(value, tuple) else (value,)))
