"""What no case file may contain: invalid names, impossible numbers, endless files.

Each is reported quickly as a problem with its key; none ends in a traceback.
"""

import os
import sys
import tomllib

import pytest
from tests.support import shipped
from typer.testing import CliRunner

import loadshare as ls
from benchmarks.limit import limited
from loadshare.case import load_case
from loadshare.case.units import si_factor
from loadshare.cli.cases import read_changes
from loadshare.cli.main import app
from loadshare.settings import ALLOWED

PAIR = """
[operating]
input = "a"
output = "b"
torque = "100 N*m"

[gears.a]
centre = ["0 mm", "0 mm"]
base_radius = "50 mm"

[gears.b]
centre = ["160 mm", "0 mm"]
base_radius = "100 mm"

[meshes."a-b"]
pressure_angle = "20.364134805 deg"
stiffness = "1e6 N*m/rad"
"""


def refusal_of(tmp_path, text: str) -> str:
    """Return the problems of a case file."""
    path = tmp_path / "case.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ls.CaseError) as failure:
        load_case(path)
    return str(failure.value)


def test_the_pair_itself_is_a_case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(PAIR, encoding="utf-8")
    assert ls.solve(load_case(path)).passed


@pytest.mark.parametrize(
    ("change", "key"),
    [
        (('output = "b"', 'output = ""'), "operating.output"),
        (('input = "a"', 'input = ""'), "operating.input"),
        (("", '[shafts."-"]\nstiffness = "rigid"\n'), 'shafts."-"'),
        (("", '[meshes."-"]\npressure_angle = "20 deg"\nstiffness = "1 N*m/rad"\n'), 'meshes."-"'),
        (("", '[errors.""]\ninstallation = ["1 um", "0 um"]\n'), 'errors.""'),
        (("", '[gears.""]\ncentre = ["0 mm", "0 mm"]\nbase_radius = "1 mm"\n'), 'gears.""'),
        (("", '[stages.""]\nmeshes = ["a-b"]\n'), 'stages.""'),
        (("", '[splines.""]\nbending_stiffness = "1 N/m"\nclearance = "1 um"\n'), 'splines.""'),
        (("", '[march]\ngear = ""\nrevolutions = 1\nsteps = 3\n'), "march.gear"),
        (("", '[stages." a"]\nmeshes = ["a-b"]\n'), 'stages." a": cannot be a name'),
        (("", '[stages."a\\u0000"]\nmeshes = ["a-b"]\n'), "stages"),
        (("", f'[stages.{"s" * 5000}]\nmeshes = ["a-b"]\n'), "stages"),
        (("", '[march]\ngear = "a"\nrevolutions = 1e308\nsteps = 3\n'), "march.revolutions"),
        (("", '[march]\ngear = "a"\nrevolutions = 1\nsteps = 1000000000\n'), "march.steps"),
        (("torque =", "positions = 1000000000\ntorque ="), "operating.positions"),
    ],
)
def test_names_and_counts(tmp_path, change, key):
    old, new = change
    message = refusal_of(tmp_path, PAIR.replace(old, new, 1) if old else PAIR + new)
    assert key in message
    # An invalid name is not reported a second time as a missing gear.
    assert not (key.endswith('""') and '"" is not a gear' in message)


@pytest.mark.parametrize("number", ["1e-308", "5e-324", "1e-300", "1e300", "-1e308", "1e400"])
@pytest.mark.parametrize(
    ("value", "key"),
    [
        ('"100 N*m"', "operating.torque"),
        ('"50 mm"', "gears.a.base_radius"),
        ('"160 mm"', "gears.b.centre"),
        ('"1e6 N*m/rad"', "stiffness"),
        ('"20.364134805 deg"', "pressure_angle"),
    ],
)
def test_numbers_that_no_machine_has(tmp_path, number, value, key):
    unit = value.strip('"').split(" ")[1]
    assert key in refusal_of(tmp_path, PAIR.replace(value, f'"{number} {unit}"', 1))


@pytest.mark.parametrize("size", [ALLOWED.smallest, ALLOWED.largest])
def test_numbers_at_the_limits_are_solved_or_refused(size):
    """They overflow nowhere."""
    case = ls.Case(tomllib.loads(PAIR))
    for key, unit in (
        ("operating.torque", "N*m"),
        ('meshes."a-b".stiffness', "N*m/rad"),
    ):
        try:
            result = ls.solve(case.replace({key: f"{size!r} {unit}"}))
        except ls.Refused:
            continue
        assert result.passed


@pytest.mark.parametrize(
    "unit",
    ["9^9^9^9", "N^1e9", "N*m^99999", "mm**-1e308", "N*m*(2^(2^(2^9)))", "m^2^3", "(kN^12)^12"],
)
def test_units_that_would_take_for_ever(tmp_path, unit):
    assert f'operating.torque = "100 {unit}"' in refusal_of(tmp_path, PAIR.replace("N*m", unit, 1))


@pytest.mark.parametrize(
    "unit", ["rad/(N*m)^(2/3)", "m^2", "N/mm^1.5", "m^-1", "mm**2", "m^(1/3)", "1/s", "m^ 2"]
)
def test_units_that_engineers_write(unit):
    assert si_factor(unit, unit) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "text",
    [
        "notes = " + "[" * 100_000 + "]" * 100_000,
        "notes = " + "[" * 50 + "]" * 50,
        "x = " + "{a = " * 3000 + "1" + "}" * 3000,
        "[" + "a." * 5000 + "a]\n",
        # When parsed, its memory would grow with the square of its steps: 20 GB.
        "a" + ".a" * 100_000 + " = 1",
        "x = {" + '\'a\' . "b\\"" .' * 50_000 + "c = 1}",
        'x = """\n\\""""\n' + "a." * 50_000 + "a = 1",
    ],
)
def test_nesting(tmp_path, text):
    assert "is nested deeper than 20 tables and lists" in refusal_of(tmp_path, text + "\n" + PAIR)


@pytest.mark.parametrize(
    "text",
    [
        "# " + "a." * 1000 + "a",
        'title = "' + "a." * 1000 + 'a"',
        "title = '" + "a." * 1000 + "a'",
        'title = """"\n' + "a." * 1000 + 'a"""',
        "title = '''\n" + "a." * 1000 + "a'''",
        'title = \'a\' # """ ' + "a." * 1000,
    ],
)
def test_what_is_no_key_may_have_any_dots(tmp_path, text):
    path = tmp_path / "case.toml"
    path.write_text(text + "\n" + PAIR, encoding="utf-8")
    load_case(path)


def test_nesting_in_python_and_on_the_command_line():
    deep: list[object] = []
    for _ in range(5000):
        deep = [deep]
    with pytest.raises(ls.CaseError, match="nested too deeply"):
        ls.Case({"notes": deep})
    circle: dict[str, object] = {}
    circle["notes"] = circle
    with pytest.raises(ls.CaseError, match="nested too deeply"):
        ls.Case(circle)
    assert read_changes(["notes=" + "[" * 50_000])  # a text, for which no note is too long


def test_a_number_of_thousands_of_digits(tmp_path):
    assert "cannot be read" in refusal_of(tmp_path, "x = " + "9" * 5000 + "\n" + PAIR)


def test_entries(tmp_path):
    many = ", ".join(['"gears.*"'] * (ALLOWED.entries + 1))
    assert "10001 entries" in refusal_of(tmp_path, f"assumed = [{many}]\n{PAIR}")


def test_a_file_that_is_too_large(tmp_path):
    text = PAIR + "#" * ALLOWED.bytes
    assert "larger than 4 MiB" in refusal_of(tmp_path, text)


@pytest.mark.skipif(sys.platform == "win32", reason="has neither pipes nor devices in folders")
def test_what_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", "/dev/zero", "/dev/null"):
        with pytest.raises(ls.CaseError, match="is not a regular file"):
            load_case(path)
    with pytest.raises(ls.CaseError, match="is a folder; name a case in it"):
        load_case(tmp_path)
    with pytest.raises(ls.CaseError, match="has a name that no file can have"):
        load_case(f"{tmp_path}/a\0.toml")
    with pytest.raises(ls.ResultError, match="has a name that no file can have"):
        ls.load_result(f"{tmp_path}/a\0.json")


def test_a_long_chain(tmp_path):
    for number in range(1000):
        (tmp_path / f"{number}.toml").write_text(f'extends = "{number + 1}.toml"\n')
    (tmp_path / "1000.toml").write_text(PAIR)
    with pytest.raises(ls.CaseError, match="chain of 20 files"):
        load_case(tmp_path / "0.toml")


def many(count: int, text: str) -> str:
    return "".join(text.format(i) for i in range(count))


GEAR = "[gears.g{0}]\ncentre = ['0 mm', '0 mm']\nbase_radius = '1 mm'\n"


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (many(ALLOWED.elements, GEAR), "gears: has 1002 entries. Allowed: at most 1000."),
        (many(20_000, "[x{}.a.a.a.a]\n"), "has 20003 entries. Allowed: at most 10000."),
        ("[gears.c]\n" + many(30_000, "k{} = 1\n"), "gears.c: has 30000 entries."),
        (many(9000, "[x{}]\n"), "has more problems than the 1,000 shown."),
        ("[gears.c]\n" + many(9000, "k{} = 1\n"), "has more problems than the 1,000 shown."),
        (
            many(990, GEAR)
            + many(
                999, "[meshes.'gg{0}-hh{0}']\npressure_angle = '20 deg'\nstiffness = '1 N*m/rad'\n"
            ),
            '"gg400" is not a gear',
        ),
    ],
)
@pytest.mark.quick(2)
def test_problems_without_number_take_a_moment(tmp_path, text, wanted):
    """Each of these used to take minutes, because similar names were searched among all others."""
    with limited(10.0):
        message = refusal_of(tmp_path, PAIR + text)
    assert wanted in message
    assert message.count("\n") <= 2 * ALLOWED.problems


@pytest.mark.parametrize("number", ["0x" + "f" * 10_000, "0b" + "1" * 100_000])
def test_numbers_that_python_does_not_write(tmp_path, number):
    message = refusal_of(tmp_path, PAIR.replace("torque =", f"positions = {number}\ntorque =", 1))
    assert "operating.positions = 0xfff" in message


def test_a_mark_of_byte_order_is_no_part_of_a_case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + PAIR.encode())
    assert set(load_case(path).gears) == {"a", "b"}


def test_a_key_that_is_written_twice_is_reported_as_written(tmp_path):
    assert "cannot declare gears.a twice" in refusal_of(tmp_path, PAIR + "[gears.a]\n")


@pytest.mark.skipif(os.name != "posix", reason="links ask for rights on this system")
def test_links_in_a_circle(tmp_path):
    (tmp_path / "loop.toml").symlink_to(tmp_path / "loop.toml")
    with pytest.raises(ls.CaseError, match="too many levels of symbolic links"):
        load_case(tmp_path / "loop.toml")
    assert "loop.toml" in refusal_of(tmp_path, 'extends = "loop.toml"\n')
    done = CliRunner().invoke(app, ["check", str(tmp_path / "loop.toml")])
    assert done.exit_code == 2
    assert "too many levels of symbolic links" in done.output


def test_a_number_of_teeth_that_no_float_holds_is_reported():
    with pytest.raises(ls.CaseError, match="teeth"):
        shipped("planetary/four_planets").replace({"gears.sun.teeth": 10**320})
