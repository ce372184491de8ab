"""Quantities of REXS attributes, and how files spell their units."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from functools import lru_cache

from loadshare.case.units import si_factor
from loadshare.case.words import LONGEST
from loadshare.exchange.rexs.model import Unread, Value
from loadshare.settings import ALLOWED

NO_UNIT = ("", "none", "-", "1")
"""Spellings for a number that has no unit."""

PURE = "1"
DIRECTION = "direction"

QUANTITIES = {
    **dict.fromkeys(
        (
            "normal_module",
            "face_width",
            "common_face_width",
            "support_vector",
            "u_coordinate_on_shaft",
            "u_coordinate_on_shaft_inner_side",
            "u_coordinate_on_shaft_outer_side",
            "length",
            "outer_diameter_begin",
            "outer_diameter_end",
            "inner_diameter_begin",
            "inner_diameter_end",
            "operating_radial_bearing_clearance",
            "mounted_radial_bearing_clearance",
            "radial_bearing_clearance",
            "radial_clearance",
            "radial_backlash",
            "misalignment_in_v_direction",
            "misalignment_in_w_direction",
            "maximum_normal_backlash",
        ),
        "m",
    ),
    **dict.fromkeys(("helix_angle_reference_diameter", "normal_pressure_angle"), "rad"),
    **dict.fromkeys(("force_u_direction", "force_v_direction", "force_w_direction"), "N"),
    **dict.fromkeys(
        (
            "number_of_teeth",
            "profile_shift_coefficient",
            "addendum_modification_coefficient",
            "poisson_ratio",
            "gear_shift_index",
        ),
        PURE,
    ),
    **dict.fromkeys(
        (
            "shear_modulus",
            "elastic_modulus",
            "mesh_stiffness_for_load_distribution_along_face_width",
        ),
        "Pa",
    ),
    **dict.fromkeys(("u_axis_vector", "w_axis_vector"), DIRECTION),
    "radial_stiffness": "N/m",
    "rotational_stiffness": "N*m/rad",
    "rotational_speed": "rad/s",
    "torque_around_u_axis": "N*m",
}
"""Attributes that the import reads, and the SI unit of what they measure."""

FLAGS = ("defines_torque", "transmits_torque", "radial_force_absorption", "is_engaged")
"""Attributes that the import reads as true or false; `is_engaged` also as a list of these."""

POSITIVE = ("radial_stiffness", "rotational_stiffness", "face_width", "common_face_width", "length")
"""Quantities that are never less than zero."""

STANDARD = {
    "mm": ("m", 1e-3),
    "mum": ("m", 1e-6),
    "deg": ("rad", math.pi / 180.0),
    "°": ("rad", math.pi / 180.0),
    "rad": ("rad", 1.0),
    "N": ("N", 1.0),
    "kN": ("N", 1e3),
    "N m": ("N*m", 1.0),
    "N / m": ("N/m", 1.0),
    "N / mm": ("N/m", 1e3),
    "N mm / rad": ("N*m/rad", 1e-3),
    "N m / rad": ("N*m/rad", 1.0),
    "N / (mm mum)": ("Pa", 1e9),
    "N / mm^2": ("Pa", 1e6),
    "1 / min": ("rad/s", math.pi / 30.0),
    "none": (PURE, 1.0),
}
"""Units as the standard spells them: what they measure, and their SI value."""

ROUND_OFF = 1e-15
"""Relative change of a number by one or two multiplications."""

TURNS = ("1/min", "min^-1", "min-1", "U/min")
"""Other spellings of revolutions per minute."""


def in_si(name: str, value: Value, unit: str) -> Value | None:
    """Return the value of an attribute in SI units.

    Parameters
    ----------
    name : str
        Name of the attribute.
    value : float, bool, str or tuple
        As given in the file.
    unit : str

    Returns
    -------
    Value or None
        `Unread` for a quantity of `QUANTITIES` that is not a number in a unit of its kind; None if
        the file gives the attribute but no value. Other attributes in a unit that the standard does
        not use are texts.
    """
    target = QUANTITIES.get(name)
    if isinstance(value, tuple) and len(value) == 1 and name in (*QUANTITIES, *FLAGS):
        value = value[0]
    if name in FLAGS:
        return _flag(name, value)
    if target is None:
        return _scaled(value, STANDARD.get(unit, ("", None))[1], unit)
    if value in ("", ()) or (isinstance(value, float) and math.isnan(value)):
        return None
    numbers = value if isinstance(value, tuple) else (value,)
    text = _text(numbers)
    given = text if unit in NO_UNIT else f"{text} {unit}"
    if not all(isinstance(v, float) and abs(v) <= ALLOWED.largest for v in numbers):
        return Unread(given, "is not a number of a usable size")
    is_vector = target == DIRECTION or name == "support_vector"
    if len(numbers) != (3 if is_vector else 1):
        return Unread(given, f"is not {'three numbers' if is_vector else 'one number'}")
    if name in POSITIVE and any(isinstance(v, float) and v < 0.0 for v in numbers):
        return Unread(given, "is less than zero")
    if not any(numbers):
        return None if target == DIRECTION else value
    if target == DIRECTION:
        return value
    factor = factor_of(unit, target)
    if factor is not None:
        return _scaled(value, factor, unit)
    why = "has no unit" if unit in NO_UNIT else "is in a unit that is not known for it"
    return Unread(given, why, _usual(target))


def _flag(name: str, value: Value) -> Value | None:
    """Return a value that is true or false; only couplings are so for several gears of a unit."""
    if value in ("", ()):
        return None
    if isinstance(value, str) and value.lower() in ("true", "false"):
        return value.lower() == "true"
    states = value if isinstance(value, tuple) and name == "is_engaged" else (value,)
    if all(isinstance(state, bool) for state in states):
        return value
    return Unread(_text(states), "is neither true nor false", "true, false")


def _text(values: Iterable[object]) -> str:
    """Return values as a message shows them."""
    text = " ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in values)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _scaled(value: Value, factor: float | None, unit: str) -> Value:
    if factor == 1.0 or not isinstance(value, float | tuple):
        return value
    if factor is None:
        return f"{value} {unit}"
    return tuple(factor * v for v in value) if isinstance(value, tuple) else factor * value


@lru_cache(maxsize=1024)
def factor_of(unit: str, target: str) -> float | None:
    """Return the SI value of a unit; None if it is unknown or does not measure `target`."""
    if unit in NO_UNIT:
        return 1.0 if target == PURE else None
    if unit in STANDARD:
        measured, factor = STANDARD[unit]
        return factor if measured == target else None
    if target == PURE:
        return None
    apart = re.sub(r"N(?=m)", "N ", re.sub(r"\bmum\b", "um", unit.strip()))
    spelled = re.sub(r"\s+", "*", re.sub(r"\s*([/*·])\s*", r"\1", apart))
    try:
        return si_factor("rpm" if spelled in TURNS else spelled, target)
    except ValueError:
        return None


def _usual(target: str) -> str:
    """Return the standard's units for a kind of quantity."""
    if target == PURE:
        return "no unit"
    return ", ".join(unit for unit, (measured, _) in STANDARD.items() if measured == target)


def torque_of(value: float) -> str:
    """Return a torque as text for a case: all its digits, without round-off of its unit."""
    short = f"{value:.12g}"
    return f"{short if math.isclose(float(short), value, rel_tol=ROUND_OFF) else repr(value)} N*m"
