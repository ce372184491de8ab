import math
import subprocess
import sys
from typing import Annotated

import numpy as np
import pint
import pytest
from pydantic import TypeAdapter, ValidationError
from tests.support import shipped

import loadshare as ls
from loadshare.case import quantity as q
from loadshare.case import units


def read(kind, given):
    return TypeAdapter(kind).validate_python(given)


@pytest.mark.parametrize(
    ("kind", "text", "si"),
    [
        (q.Length, "45.9 mm", 0.0459),
        (q.Length, "8.24 um", 8.24e-6),
        (q.Length, "8.24 µm", 8.24e-6),
        (q.Length, "3 micron", 3e-6),
        (q.Length, "3 nm", 3e-9),
        (q.Length, "−1.5e-1 cm", -1.5e-3),
        (q.Length, "2in", 0.0508),
        (q.Length, "1 ft", 0.3048),
        (q.Angle, "180 deg", math.pi),
        (q.Angle, "1 mrad", 1e-3),
        (q.Angle, "60 arcmin", math.radians(1)),
        (q.Angle, "3600 arcsec", math.radians(1)),
        (Annotated[q.Quantity, q.ANGULAR_SPEED], "60 rpm", math.tau),
        (Annotated[q.Quantity, q.ANGULAR_SPEED], "60 rev/min", math.tau),
        (Annotated[q.Quantity, q.ANGULAR_SPEED], "60 r/min", math.tau),
        (Annotated[q.Quantity, q.ANGULAR_SPEED], "1 Hz", math.tau),
        (q.Power, "2 MW", 2e6),
        (q.Power, "1 hp", 745.6998715822702),
        (q.Torque, "2 kN*m", 2e3),
        (q.Torque, "2 N·mm", 2e-3),
        (q.Torque, "2 N m", 2.0),
        (q.Force, "1 lbf", 4.4482216152605),
        (q.Stiffness, "1.78e7 N/m", 1.78e7),
        (q.Stiffness, "17.8 N/um", 1.78e7),
        (Annotated[q.Quantity, q.TORSIONAL_STIFFNESS], "1 N*m/mrad", 1e3),
        (Annotated[q.Quantity, q.TORSIONAL_COMPLIANCE], "2e-7 rad/(N*m)", 2e-7),
        (Annotated[q.Quantity, q.HERTZ_COMPLIANCE], "1e-6 rad/(N*m)^(2/3)", 1e-6),
        (Annotated[q.Quantity, q.HERTZ_COMPLIANCE], "1e-6 rad/(N*m)**(2/3)", 1e-6),
        (Annotated[q.Quantity, q.HERTZ_COMPLIANCE], "1 urad/(kN·m)^(2/3)", 1e-8),
        (q.Expansion, "11.5e-6 /K", 11.5e-6),
        (q.Expansion, "11.5e-6 1/K", 11.5e-6),
        (q.Expansion, "1e-31/K", 1e-31),
    ],
)
def test_units_that_engineers_write(kind, text, si):
    value = read(kind, text)
    assert value.text == text
    assert float(value) == pytest.approx(si, rel=1e-15)


@pytest.mark.parametrize(
    ("kind", "given", "message"),
    [
        (q.Length, 45.9, '45.9 has no unit. Allowed: a length such as "45.9 mm". '),
        (q.Length, 0, '0 has no unit. Allowed: a length such as "0 mm". '),
        (q.Length, "nan", 'nan has no unit. Allowed: a length such as "45.9 mm". '),
        (q.Radius, -5, '-5 has no unit. Allowed: a length such as "45.9 mm". '),
        (q.Length, -5, '-5 has no unit. Allowed: a length such as "-5 mm". '),
        (q.Length, "45.9", '45.9 has no unit. Allowed: a length such as "45.9 mm". '),
        (
            Annotated[q.Quantity, q.TORSIONAL_STIFFNESS],
            "5 N*m",
            "is a torque, but a torsional stiffness is needed. "
            'Allowed: a torsional stiffness such as "5e5 N*m/rad". ',
        ),
        (
            Annotated[q.Quantity, q.HERTZ_COMPLIANCE],
            "1 rad/(N*m)",
            "is in rad/(N*m), but a Hertz compliance is needed. "
            'Allowed: a Hertz compliance such as "1e-6 rad/(N*m)^(2/3)". ',
        ),
        (
            q.Torque,
            "5 Nm",
            'the unit Nm is not known. Allowed: a torque such as "2175 N*m". Did you mean N*m?',
        ),
        (
            Annotated[q.Quantity, q.TORSIONAL_STIFFNESS],
            "8e4 Nm/rad",
            "the unit Nm is not known. Allowed: a torsional stiffness such as "
            '"5e5 N*m/rad". Did you mean N*m/rad?',
        ),
        (
            Annotated[q.Quantity, q.TORSIONAL_COMPLIANCE],
            "2 rad/kNm",
            "the unit kNm is not known. Allowed: a torsional compliance such as "
            '"2e-7 rad/(N*m)". Did you mean rad/(kN*m)?',
        ),
        (
            q.Length,
            "5 kNm",
            "kNm would be kN*m, a torque, but a length is needed. "
            'Allowed: a length such as "45.9 mm". ',
        ),
        (
            q.Length,
            "5 MM",
            'the unit MM is not known. Allowed: a length such as "45.9 mm". Did you mean mm?',
        ),
        (q.Length, "nan mm", 'is not finite. Allowed: a length such as "45.9 mm". '),
        (q.Length, "1e999 mm", 'is not finite. Allowed: a length such as "45.9 mm". '),
        *(
            (
                q.Length,
                text,
                "is outside the range of any machine (1e-40 to 10000 m). "
                'Allowed: a length such as "45.9 mm". ',
            )
            for text in ("1e9999999 mm", "-1e99999999999999999999 mm", "1e-9999999 mm")
        ),
        *(
            (
                q.Length,
                text,
                'is not a number followed by a unit. Allowed: a length such as "45.9 mm". '
                "Use a decimal point, and no separators between thousands.",
            )
            for text in (
                "1,5 mm",
                "1.000,5 mm",
                "1 000 mm",
                "1'000 mm",
                "1’000,5 mm",
                "1.000.000 mm",
            )
        ),
        (
            q.Length,
            True,
            'is not a number followed by a unit. Allowed: a length such as "45.9 mm". ',
        ),
        (
            q.Expansion,
            "11.5e-6 2/K",
            "is not a number followed by a unit. "
            'Allowed: a thermal expansion such as "11.5e-6 /K". ',
        ),
        (
            q.Length,
            "2e5 3 mm",
            'is not a number followed by a unit. Allowed: a length such as "45.9 mm". ',
        ),
        *(
            (
                q.Length,
                text,
                'is not a number followed by a unit. Allowed: a length such as "45.9 mm". ',
            )
            for text in ("5 3 mm", "1+1 mm", "5 +mm", "1 -3 mm")
        ),
    ],
)
def test_values_that_are_none(kind, given, message):
    with pytest.raises(ValidationError) as caught:
        read(kind, given)
    assert caught.value.errors()[0]["msg"] == message


@pytest.mark.parametrize(
    ("kind", "given", "hint"),
    [
        (q.TORSIONAL_COMPLIANCE, "2e-7 rad/N*m", "Did you mean rad/(N*m)?"),
        (q.MODULUS, "206e3 N/mm2", "Did you mean N/mm^2?"),
        (q.DENSITY, "7850 kg/m3", "Did you mean kg/m^3?"),
        (q.TORQUE, "5 N×m", "Did you mean N*m?"),
        (q.ANGULAR_SPEED, "5 min⁻¹", 'Write "5 rpm".'),
        (q.STIFFNESS, "5 lb/in", "Write lbf: a force; 1 lb of mass is 0.45359237 kg."),
        (q.EXPANSION, "5e-6 1/°C", "Write K: a rise of 1 °C is 1 K."),
        (q.STIFFNESS, "5 N/mm/um", ""),
    ],
)
def test_a_unit_that_is_nearly_right_is_proposed(kind, given, hint):
    with pytest.raises(ValueError) as caught:
        kind.read(given)
    assert caught.value.context["hint"] == hint


@pytest.mark.parametrize(
    "more", [" # kN*m", "#", "?", "!", ":", "=", ";", ";kg", '""', " 'x'", "@s", " \\ /s", "$"]
)
def test_nothing_follows_a_unit(more):
    """Not even characters that the unit parser ignores."""
    with pytest.raises(ValidationError) as caught:
        read(q.Torque, f"5 N*m{more}")
    message = f"{more.strip()} is not part of a unit; only a unit may follow a number"
    allowed = 'Allowed: a torque such as "2175 N*m". '
    assert caught.value.errors()[0]["msg"] == f"{message}. {allowed}"


def test_pint_quantities_of_any_registry():
    theirs = pint.UnitRegistry()
    assert read(q.Length, theirs.Quantity(45.9, "mm")).si == 0.0459
    assert read(q.Angle, theirs.Quantity(20, "deg")).text == "20.0 deg"
    stiffness = read(Annotated[q.Quantity, q.TORSIONAL_STIFFNESS], theirs.Quantity(5e5, "N*m/rad"))
    assert stiffness.si == 5e5
    for rise in (theirs.Quantity(5, "delta_degC"), theirs.Quantity(9, "delta_degF")):
        assert read(q.Temperature, rise).si == pytest.approx(5.0)
    assert read(q.Expansion, theirs.Quantity(1e-5, "1/delta_degC")).si == 1e-5
    ours = units.registry().Quantity(1.0, "kN*m")
    assert read(q.Torque, ours).si == pytest.approx(1e3)


def test_one_length_in_two_units_is_one_number():
    assert read(q.Length, "45.9 mm").si == read(q.Length, "0.0459 m").si


def test_text_and_schema():
    adapter = TypeAdapter(q.Length)
    assert adapter.dump_python(adapter.validate_python("1 mm")) == "1 mm"
    schema = adapter.json_schema()
    assert schema["type"] == "string"
    assert schema["description"] == 'a length such as "45.9 mm"'
    assert schema["examples"] == ["45.9 mm"]


def test_the_registry_is_a_small_one_of_its_own():
    """Pint's own takes ten times as long to build, and accepts a torque as a stiffness."""
    assert len(list(units.registry())) < 0.2 * len(list(pint.UnitRegistry()))


def test_importing_the_room_does_not_import_pint():
    code = "import sys, loadshare.case; sys.exit('pint' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("si", units.FACTORS)
def test_common_units_are_known_without_the_registry_and_as_it_says(si):
    """They agree to the last digit, and fit no other kind."""
    for unit, factor in units.FACTORS[si].items():
        given = units._parse(unit)
        assert float((given / units._parse(si)).to_base_units().magnitude) == factor
        for other in units.FACTORS:
            same = given.dimensionality == units._parse(other).dimensionality
            assert (units.si_factor(unit, other) is not None) == same == (other == si)


def test_a_table_of_quantities_for_one_value_is_reported():
    ureg = pint.UnitRegistry()
    case = shipped("fgfbstts/limit_ring")
    with pytest.raises(ls.CaseError, match=r"rings\.4\.float"):
        case.replace({"rings.4.float": np.array([[4.0, 5.0]]) * ureg.um})
