"""The units a case may use: a small registry in which the angle is a dimension of its own."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import cache, lru_cache
from typing import TYPE_CHECKING

from loadshare.settings import ALLOWED

if TYPE_CHECKING:
    import pint

# With the radian as a base unit, a torque (N*m) cannot pass for a torsional stiffness (N*m/rad).
DEFINITIONS = """
milli- = 1e-3 = m-
micro- = 1e-6 = µ- = μ- = u-
nano- = 1e-9 = n-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-

meter = [length] = m = metre
micron = 1e-6 * meter
inch = 0.0254 * meter = in
foot = 0.3048 * meter = ft
gram = [mass] = g
second = [time] = s
kelvin = [temperature] = K
minute = 60 * second = min
hour = 3600 * second = h
radian = [angle] = rad
degree = 3.141592653589793 / 180 * radian = deg = °
arcminute = degree / 60 = arcmin
arcsecond = degree / 3600 = arcsec
revolution = 6.283185307179586 * radian = rev = r
rpm = revolution / minute
hertz = revolution / second = Hz
newton = 1000 * gram * meter / second ** 2 = N
pound_force = 4.4482216152605 * newton = lbf
pascal = newton / meter ** 2 = Pa
watt = newton * meter / second = W
horsepower = 745.6998715822702 * watt = hp
"""

_WORD = re.compile(r"[^\W\d_]+")
_NO_POWER = re.compile(r"([^\W\d_])([2-4])(?!\w)")
_PRODUCTS = re.compile("[×•∙-]")
"""Signs of a product that are none here."""

# Spellings that a did-you-mean may propose: those that engineers use.
COMMON = (
    *("m", "mm", "um", "µm", "micron", "nm", "cm", "in", "ft", "g", "kg", "s", "ms", "min", "h"),
    *("rad", "mrad", "urad", "deg", "arcmin", "arcsec", "rev", "rpm", "Hz"),
    *("N", "kN", "MN", "lbf", "W", "kW", "MW", "hp", "Pa", "MPa", "GPa"),
    *("N*m", "kN*m", "N*mm", "N/m", "N/mm", "N/um", "N*m/rad", "rad/(N*m)", "rad/(N*m)^(2/3)"),
    *("kg/m^3", "g/cm^3", "K", "/K", "m/s^2"),
)

OTHERS = {
    **dict.fromkeys(("1/min", "U/min", "min-1", "min^-1", "min⁻¹", "/min", "rev/m"), "rpm"),
    **dict.fromkeys(("lb-ft", "lbf-ft", "ft-lb", "ft-lbf", "lb*ft", "ft*lb"), "ft*lbf"),
    **dict.fromkeys(("lb-in", "lbf-in", "in-lb", "in-lbf", "lb*in", "in*lb"), "in*lbf"),
    **dict.fromkeys(("lb", "lbs"), "lbf: a force; 1 lb of mass is 0.45359237 kg"),
    **dict.fromkeys(("inches", '"'), "in"),
    **dict.fromkeys(("thou", "mil"), "in: one thousandth is 0.001 in"),
    **dict.fromkeys(("PS", "CV"), "W, kW or hp: 1 PS is 735.49875 W"),
    **dict.fromkeys(("kgf", "kp"), "N: 1 kgf is 9.80665 N"),
    **dict.fromkeys(("t", "tonne"), "kg: 1 t is 1000 kg"),
    **dict.fromkeys(("°F", "degF", "degreeF"), "K: a rise of 1 °F is 0.5556 K"),
    **dict.fromkeys(
        ("°C", "degC", "degreeC", "C", "delta_degC", "Δ°C"), "K: a rise of 1 °C is 1 K"
    ),
    **dict.fromkeys(("gon", "grad", "grade"), "deg: 1 gon is 0.9 deg"),
    "feet": "ft",
    "daN": "N: 1 daN is 10 N",
    "bar": "MPa: 1 bar is 0.1 MPa",
    "psi": "lbf/in^2",
}
"""Common spellings of units that have another name here, and that name."""

# The SI unit in which each kind of quantity is kept, by the name that messages use.
KINDS = {
    "a length": "m",
    "an angle": "rad",
    "a mass": "kg",
    "a density": "kg/m^3",
    "a time": "s",
    "a temperature rise": "K",
    "an acceleration": "m/s^2",
    "a speed": "m/s",
    "an angular speed": "rad/s",
    "a frequency": "1/s",
    "a force": "N",
    "a torque": "N*m",
    "a torque per angle": "N*m/rad",
    "a stiffness": "N/m",
    "a power": "W",
    "a pressure": "Pa",
}


FACTORS: dict[str, dict[str, float]] = {
    "m": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9, "in": 0.0254},
    "rad": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0},
    "rad/s": {"rad/s": 1.0, "rpm": 0.10471975511965977},
    "N": {"N": 1.0, "kN": 1e3},
    "N*m": {"N*m": 1.0, "kN*m": 1e3},
    "W": {"W": 1.0, "kW": 1e3, "MW": 1e6},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "N/um": 1e6},
    "kg": {"kg": 1.0, "g": 1e-3},
    "Pa": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9},
    "1/K": {"1/K": 1.0, "/K": 1.0},
    **{
        si: {si: 1.0}
        for si in (
            *("N/m^1.5", "N/m^(10/9)", "N*m/rad", "rad/(N*m)", "rad/(N*m)^(2/3)"),
            *("kg/m^3", "K", "m/s^2"),
        )
    },
}
"""Factors of the registry for the commonest spellings, by SI unit: starting it takes as long as a
solve."""
_SI = {unit: si for si, known in FACTORS.items() for unit in known}


_POWER = re.compile(
    r"(?<=[^\W\d]|[)°])\s*\*\*\s*\(?\s*([-+]?\d{1,9}(?:\.\d{1,9})?)"
    r"(?![\w.])\s*(?:/\s*([1-9]\d{0,2})\s*\))?"
)
"""A power of a unit, or of several in brackets: a number, or a fraction in brackets."""


_NO_SIGN = re.compile(r"[^\w\s\u200b°·⋅⁻*/^()+\-.,%]")
"""Characters that occur in no unit; pint would silently stop at them, or skip them."""


@cache
def registry() -> pint.UnitRegistry[float]:
    """Return the registry of the units that a case may use.

    Returns
    -------
    pint.UnitRegistry
        Built on first use, shared afterwards; the angle is a dimension of its own.
    """
    import pint

    units: pint.UnitRegistry[float] = pint.UnitRegistry(None, cache_folder=None)
    units.load_definitions(DEFINITIONS.splitlines())
    return units


@lru_cache(maxsize=1024)
def si_factor(unit: str, target: str) -> float | None:
    """Return the factor that converts a number in `unit` to `target`.

    Parameters
    ----------
    unit : str
        A unit as an engineer writes it: ``mm``, ``N·m/rad``, ``rad/(N*m)^(2/3)``.
    target : str
        The SI unit wanted.

    Returns
    -------
    float or None
        The factor, or None where the two units are of different dimensions.

    Raises
    ------
    ValueError
        If the text is not a unit; the exception's argument is the unknown part.
    """
    if unit in _SI and target in FACTORS:
        return FACTORS[target].get(unit)
    given, wanted = _parse(unit), _parse(target)
    try:
        if given.dimensionality != wanted.dimensionality:
            return None
        factor = float((given / wanted).to_base_units().magnitude)
    except (ArithmeticError, ValueError):
        factor = math.inf
    if not ALLOWED.smallest <= factor <= ALLOWED.largest:
        raise ValueError(unit)
    return factor


def kind_of(unit: str) -> str | None:
    """Return what kind of quantity `unit` measures, or None where it has no name of its own.

    Parameters
    ----------
    unit : str
        A unit that `si_factor` accepts.

    Returns
    -------
    str or None
        Such as ``a length``.
    """
    return next((kind for kind, si in KINDS.items() if si_factor(unit, si) is not None), None)


def beyond_unit(unit: str) -> str:
    """Return a text from its first character that occurs in no unit; empty if there is none.

    Parameters
    ----------
    unit : str
        The text after a number.
    """
    found = _NO_SIGN.search(unit)
    return unit[found.start() :] if found else ""


def respelled(unit: str, target: str) -> str | None:
    """Return a unit with the sign that is missing in it, or None.

    Parameters
    ----------
    unit : str
        A text that is no unit of the right kind: ``Nm/rad``, ``N/mm2``, ``rad/N*m``.
    target : str
        The SI unit of what it must measure.
    """
    for found in _respellings(unit):
        try:
            if si_factor(found, target) is not None:
                return found
        except ValueError:
            continue
    return None


def _respellings(unit: str) -> Iterator[str]:
    """Yield a unit with product signs, a power sign, or brackets below its fraction bar."""
    yield _PRODUCTS.sub("*", unit)
    for word in _WORD.finditer(unit):
        if _is_known(word[0]):
            continue
        for cut in range(1, len(word[0])):
            product = f"{word[0][:cut]}*{word[0][cut:]}"
            for put in (product, f"({product})"):
                yield unit[: word.start()] + put + unit[word.end() :]
    yield _NO_POWER.sub(r"\1^\2", unit)
    above, bar, below = unit.partition("/")
    if bar and "/" not in below:
        yield f"{above}/({below})"


def _is_known(unit: str) -> bool:
    try:
        _parse(unit)
    except ValueError:
        return False
    return True


@lru_cache(maxsize=1024)
def _parse(unit: str) -> pint.Quantity[float]:
    import pint

    text = unit.replace("·", "*").replace("⋅", "*").replace("^", "**")
    text = f"1{text}" if text.startswith("/") else text
    # A power of a power, or a power with a large exponent, would take for ever.
    powers = [abs(float(up) / float(down or 1.0)) for up, down in _POWER.findall(text)]
    if (
        len(unit) > ALLOWED.unit
        or "**" in _POWER.sub("", text)
        or max(powers, default=0.0) > ALLOWED.power
        or beyond_unit(unit)
    ):
        raise ValueError(unit)
    try:
        parsed = registry().parse_expression(text)
    except pint.UndefinedUnitError as error:
        names = error.unit_names
        raise ValueError(names if isinstance(names, str) else names[0]) from None
    except Exception as error:  # the parser passes on any error of its tokenizer
        raise ValueError(unit) from error
    # A number is no unit, and "5 mm" after another number is a slip of the pen.
    try:
        wrong = (
            not isinstance(parsed, registry().Quantity) or parsed.magnitude != 1 or parsed.unitless
        )
    except ArithmeticError:
        wrong = True  # Powers of powers may overflow.
    if wrong:
        raise ValueError(unit)
    return parsed
