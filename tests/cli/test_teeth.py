"""Quantities that follow from teeth, as tables, against a commercial report on a gearbox."""

import pytest

from loadshare.case import Case, load_case
from loadshare.report.teeth import teeth_tables


def rows(case: Case, number: int) -> dict[str, dict[str, str]]:
    table = list(teeth_tables(case))[number]
    titles = [column.title for column in table.columns]
    return {
        row[0].text: dict(zip(titles, [c.text for c in row], strict=True)) for row in table.rows
    }


def test_meshes_of_the_gearbox_as_printed(cases):
    """NREL 5 MW, KISSsoft reports: working angles, contact ratios and base diameters."""
    case = load_case(cases / "nrel_5mw" / "gearbox.toml")
    meshes = rows(case, 1)
    printed = {
        "planet_11-sun_1": ("28.118", "1.115"),
        "ring_1-planet_11": ("17.161", "1.278"),
        "planet_21-sun_2": ("24.169", "1.370"),
        "ring_2-planet_21": ("15.630", "1.618"),
        "wheel-pinion": ("22.856", "1.463"),
    }
    for mesh, (angle, ratio) in printed.items():
        assert float(meshes[mesh]["α_wt"]) == pytest.approx(float(angle), abs=6e-4)
        assert meshes[mesh]["ε_α"] == ratio
    assert meshes["wheel-pinion"]["ε_β"] == "1.421"
    gears = rows(case, 0)
    for gear, diameter in (("sun_1", 803.437), ("planet_21", 710.408), ("wheel", 1266.770)):
        assert 2.0 * float(gears[gear]["base"]) == pytest.approx(diameter, abs=6e-4)


def test_the_command_prints_them(command, cases, tmp_path):
    case = load_case(cases / "planetary" / "four_planets.toml")
    finer = case.replace({"gears.sun.tolerance_class": 6})
    finer.to_toml(tmp_path / "a.toml")
    found = command("check", tmp_path / "a.toml", "--teeth")
    assert found.exit_code == 0
    for word in (
        "Gears: centre",
        "135.0000",
        "Meshes: centre distance",
        "Tolerances by ISO 1328-1",
    ):
        assert word in found.stdout
    assert "Gears:" not in command("check", tmp_path / "a.toml").stdout


def test_what_tells_no_teeth_has_no_tables(cases):
    assert not list(teeth_tables(load_case(cases / "fgfbstts" / "base.toml")))


def test_a_shaft_tells_its_stiffness(cases):
    case = load_case(cases / "fgfbstts" / "base.toml")
    changes = {'shafts."2-4".stiffness': None, 'shafts."2-4".diameter': "60 mm"}
    found = rows(case.replace(changes | {'shafts."2-4".length': "200 mm"}), 0)
    assert found == {"2-4": {"shaft": "2-4", "stiffness": "504480"}}
