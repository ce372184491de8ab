"""Physical values: the user's text and its value in SI units."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import TYPE_CHECKING, Annotated, Any

from pydantic_core import PydanticCustomError, core_schema

from loadshare.case.units import (
    COMMON,
    KINDS,
    OTHERS,
    beyond_unit,
    kind_of,
    respelled,
    si_factor,
)
from loadshare.case.words import did_you_mean
from loadshare.settings import ALLOWED

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler

NUMBER = r"[+\-−]?(?:\d+\.?\d*|\.\d+)(?:[eE][+\-−]?\d+)?"
UNIT = r"(?:1\s*/|[^\s\d.,+\-−])"
"""Pattern of the beginning of a unit; the only number before it is the 1 of a reciprocal."""
# A number is matched as a whole, so that no unit begins at the exponent of 1e-6.
_QUANTITY = re.compile(rf"\s*(?>({NUMBER}|[+\-−]?(?:inf|nan)))\s*(|{UNIT}.*?)\s*", re.DOTALL)


@dataclass(frozen=True)
class Quantity:
    """A physical value; two are equal when they are written alike.

    Parameters
    ----------
    text : str
        What the user wrote, such as ``45.9 mm``.
    si : float
        The value in SI units, angles in radians.
    """

    text: str
    si: float

    def __float__(self) -> float:
        return self.si

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Dimension:
    """The dimension of a field's physical value; the annotation by which pydantic reads it.

    Parameters
    ----------
    unit : str
        The SI unit in which it is kept.
    kind : str
        Its name in messages, with the article.
    example : str
        A value as a user would write it.
    at_least, above : float or None
        Lower bounds of the value in SI units, inclusive and exclusive.
    at_most : Quantity or None
        Upper bound.
    words : tuple of str
        Words that are allowed instead.
    """

    unit: str
    kind: str
    example: str
    at_least: float | None = None
    above: float | None = None
    at_most: Quantity | None = None
    words: tuple[str, ...] = ()

    def bounded(
        self,
        *,
        at_least: float | None = None,
        above: float | None = None,
        at_most: Quantity | None = None,
    ) -> Dimension:
        """Return this dimension with bounds; lower ones are in SI units."""
        return replace(self, at_least=at_least, above=above, at_most=at_most)

    def or_words(self, *words: str) -> Dimension:
        """Return this dimension with words that are allowed instead."""
        return replace(self, words=words)

    def read(self, given: object) -> Quantity | str:
        """Return the value that a user gave.

        Parameters
        ----------
        given : object
            A text with a unit, a pint quantity, a `Quantity`, or one of the words.

        Returns
        -------
        Quantity or str
            The value; a word stays as it is.

        Raises
        ------
        pydantic_core.PydanticCustomError
            If it is none of these, or out of bounds; the message is for the user.
        """
        if isinstance(given, str) and given in self.words:
            return given
        text = as_text(given)
        if isinstance(text, int | float) and not isinstance(text, bool):
            raise self._problem(f"{text} has no unit", number=str(text))
        match = _QUANTITY.fullmatch(text) if isinstance(text, str) else None
        if match is None:
            hint = did_you_mean(text, self.words) or _slip_in(text)
            raise self._problem("is not a number followed by a unit", hint=hint)
        number, unit = match[1].replace("−", "-"), match[2]
        if not unit:
            raise self._problem(f"{number} has no unit", number=number)
        try:
            factor = si_factor(unit, self.unit)
        except ValueError as error:
            if _GROUPED.match(str(text)):
                hint = _slip_in(text)
                raise self._problem("is not a number followed by a unit", hint=hint) from None
            raise self._unknown(number, unit, str(error)) from None
        if factor is None:
            kind = kind_of(unit) or f"in {unit}"
            meant = respelled(unit, self.unit)
            near = f"Did you mean {meant}?" if meant else ""
            hint = _rewritten(number, unit) if unit in OTHERS else near
            raise self._problem(f"is {kind}, but {self.kind} is needed", hint=hint)
        try:
            # Decimal keeps "45.9 mm" and "0.0459 m" the same number.
            exact = Decimal(number)
            value = Quantity(str(text), float(exact * Decimal(repr(factor))))
        except ArithmeticError:
            raise self._outside() from None  # an exponent of a million or more
        self._check(value.si)
        if not (exact.is_zero() or ALLOWED.smallest <= abs(value.si) <= self._largest):
            raise self._outside()
        return value

    @property
    def _largest(self) -> float:
        return ALLOWED.length if self.unit == "m" else ALLOWED.largest

    def _outside(self) -> PydanticCustomError:
        limits = f"{ALLOWED.smallest:g} to {self._largest:g} {self.unit}"
        return self._problem(f"is outside the range of any machine ({limits})")

    @property
    def allowed(self) -> str:
        """What may be given, in words."""
        return self._allowed()

    def _check(self, si: float) -> None:
        if not math.isfinite(si):
            raise self._problem("is not finite")
        if self.above is not None and si <= self.above:
            limit = "positive" if self.above == 0 else f"above {self.above:g} {self.unit}"
            raise self._problem(f"is not {limit}")
        if self.at_least is not None and si < self.at_least:
            low = f"is below {self.at_least:g} {self.unit}"
            raise self._problem("is negative" if self.at_least == 0 else low)
        if self.at_most is not None and si > self.at_most.si:
            raise self._problem(f"is above {self.at_most}")

    def _takes(self, si: float) -> bool:
        try:
            self._check(si)
        except PydanticCustomError:
            return False
        return True

    def _allowed(self, number: str | None = None) -> str:
        example, unit = self.example, self.example.partition(" ")[2]
        if number is not None and self._takes(float(number) * (si_factor(unit, self.unit) or 1.0)):
            example = f"{number} {unit}"
        words = "".join(f'"{word}", ' for word in self.words)
        return f'{words}{"or " if words else ""}{self.kind} such as "{example}"'

    def _unknown(self, number: str, unit: str, part: str) -> PydanticCustomError:
        """Return the problem of a unit with an unknown part."""
        if unit in OTHERS:
            hint = _rewritten(number, unit)
            return self._problem(f"the unit {unit} is not known", hint=hint)
        meant = respelled(unit, self.unit)
        if rest := beyond_unit(unit):
            hint = f"Did you mean {meant}?" if meant else ""
            why = f"{rest} is not part of a unit; only a unit may follow a number"
            return self._problem(why, hint=hint)
        if meant is None:
            others = ((respelled(unit, si), kind) for kind, si in KINDS.items())
            other, kind = next(((text, kind) for text, kind in others if text), (None, ""))
            if other is not None:
                return self._problem(f"{unit} would be {other}, {kind}, but {self.kind} is needed")
        fitting = [known for known in COMMON if si_factor(known, self.unit) is not None]
        hint = f"Did you mean {meant}?" if meant else did_you_mean(part, fitting)
        if not meant and part in OTHERS:
            hint = f"Write {OTHERS[part]}."
        return self._problem(f"the unit {part} is not known", hint=hint)

    def _problem(
        self, message: str, *, hint: str = "", number: str | None = None
    ) -> PydanticCustomError:
        return refusal(message, self._allowed(number), hint)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(
            self.read,
            serialization=core_schema.plain_serializer_function_ser_schema(_written, info_arg=True),
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        number = rf"\s*{NUMBER}\s*{UNIT}.*"
        return {
            "type": "string",
            "description": self.allowed,
            "pattern": f"^({'|'.join((*self.words, number))})$",
            "examples": [*self.words, self.example],
        }


def refusal(message: str, allowed: str = "", hint: str = "") -> PydanticCustomError:
    """Return an error for pydantic to raise, from which `translate` takes the words."""
    text = "{message}. Allowed: {allowed}. {hint}" if allowed else "{message}. {hint}"
    context = {"message": message, "allowed": allowed, "hint": hint}
    return PydanticCustomError("message", text, context)


_GROUPED = re.compile(
    r"\s*[+\-−]?(?:\d+(?:[.'’\s]\d{3})*,\d|\d{1,3}(?:['’]\d{3}|(?:\.\d{3}){2}|\s\d{3}(?!\d*/)))"
)
"""Numbers as other languages write them: 1,5 and 1.000,5 and 1'000 and 1 000."""


def _slip_in(text: object) -> str:
    """Return a hint at why a text is not a number with a unit, if the reason is obvious."""
    if not isinstance(text, str):
        return ""
    number, _, unit = text.strip().partition(" ")
    if unit.strip() in OTHERS:
        return _rewritten(number, unit.strip())
    if _GROUPED.match(text):
        return "Use a decimal point, and no separators between thousands."
    return ""


def _rewritten(number: str, unit: str) -> str:
    """Return a hint at how to write a unit that has another name here."""
    other = OTHERS[unit]
    return f"Write {other}." if ":" in other else f'Write "{number} {other}".'


def as_text(given: object) -> object:
    """Return a physical value as text, and anything else as it is.

    Parameters
    ----------
    given : object
        A `Quantity`, a pint quantity of any registry, or something else.

    Returns
    -------
    object
        Number and unit as text, for an array as a list of texts; a NumPy scalar as a Python number;
        anything else unchanged.
    """
    if isinstance(given, Quantity):
        return given.text
    magnitude, units = getattr(given, "magnitude", None), getattr(given, "units", None)
    if magnitude is None or units is None:
        # Testing for NumPy's types would import it for every command.
        is_scalar = hasattr(given, "dtype") and getattr(given, "ndim", None) == 0
        return given.item() if is_scalar else given  # type: ignore[attr-defined]
    if "Δ" in (unit := f"{units:~C}"):
        # pint's own sign for degrees of a difference; the base unit is the kelvin.
        return as_text(given.to_base_units())  # type: ignore[attr-defined]
    return _texts(magnitude.tolist() if getattr(magnitude, "ndim", 0) else magnitude, unit)


def _texts(magnitude: Any, unit: str) -> object:
    """Return a number, or each number in nested lists, as text with its unit."""
    if isinstance(magnitude, list):
        return [_texts(number, unit) for number in magnitude]
    return f"{float(magnitude)!r} {unit}".strip()


def _written(value: Quantity | str, info: core_schema.SerializationInfo) -> str | float:
    if isinstance(value, Quantity):
        return value.si if info.context == "SI" else value.text
    return value


LENGTH = Dimension("m", "a length", "45.9 mm")
ANGLE = Dimension("rad", "an angle", "20 deg")
ANGULAR_SPEED = Dimension("rad/s", "an angular speed", "8780 rpm")
POWER = Dimension("W", "a power", "2000 kW")
TORQUE = Dimension("N*m", "a torque", "2175 N*m")
FORCE = Dimension("N", "a force", "500 N")
STIFFNESS = Dimension("N/m", "a stiffness", "1.78e7 N/m")
BALL_STIFFNESS = Dimension("N/m^1.5", "a ball bearing's stiffness", "1.2e10 N/m^1.5")
ROLLER_STIFFNESS = Dimension("N/m^(10/9)", "a roller bearing's stiffness", "4e9 N/m^(10/9)")
TORSIONAL_STIFFNESS = Dimension("N*m/rad", "a torsional stiffness", "5e5 N*m/rad")
TORSIONAL_COMPLIANCE = Dimension("rad/(N*m)", "a torsional compliance", "2e-7 rad/(N*m)")
HERTZ_COMPLIANCE = Dimension("rad/(N*m)^(2/3)", "a Hertz compliance", "1e-6 rad/(N*m)^(2/3)")
ACCELERATION = Dimension("m/s^2", "an acceleration", "9.81 m/s^2")
TEMPERATURE = Dimension("K", "a temperature rise", "40 K")
EXPANSION = Dimension("1/K", "a thermal expansion", "11.5e-6 /K")
MASS = Dimension("kg", "a mass", "12.5 kg")
MODULUS = Dimension("Pa", "a modulus", "79.3 GPa")
DENSITY = Dimension("kg/m^3", "a density", "7850 kg/m^3")

Length = Annotated[Quantity, LENGTH]
Distance = Annotated[Quantity, LENGTH.bounded(at_least=0)]
Radius = Annotated[Quantity, LENGTH.bounded(above=0)]
Angle = Annotated[Quantity, ANGLE]
Power = Annotated[Quantity, POWER]
Torque = Annotated[Quantity, TORQUE]
Force = Annotated[Quantity, FORCE]
Stiffness = Annotated[Quantity, STIFFNESS]
PositiveStiffness = Annotated[Quantity, STIFFNESS.bounded(above=0)]
Acceleration = Annotated[Quantity, ACCELERATION]
Temperature = Annotated[Quantity, TEMPERATURE]
Expansion = Annotated[Quantity, EXPANSION.bounded(at_least=0)]
Mass = Annotated[Quantity, MASS.bounded(above=0)]
Density = Annotated[Quantity, DENSITY.bounded(above=0)]
Modulus = Annotated[Quantity, MODULUS.bounded(above=0)]
