"""The commands of studies: their output and files, and how they end."""

import csv
import json
import re
from pathlib import Path

import pytest
import xarray as xr
from tests.cli.conftest import CASES, on_a_screen_of

import loadshare as ls

RING = CASES / "fgfbstts/limit_ring.toml"


@pytest.fixture
def command():
    return on_a_screen_of(160)


@pytest.fixture
def narrow():
    return on_a_screen_of(80)


@pytest.fixture
def measured(tmp_path: Path) -> Path:
    """Write a case with a measurement and studies."""
    path = tmp_path / "bench.toml"
    path.write_text(
        f"""extends = '{(CASES / "fgfbstts/installation_error.toml").as_posix()}'
[measured.bench]
position = 1
pair_share = {{ "6-10" = 0.8 }}
uncertainty = 0.01

[study.compare]
kind = "compare"

[study.fit]
kind = "fit"
unknowns = {{ "errors.6.installation[0]" = ["0 um", "100 um"] }}
starts = 2

[study.sweep]
kind = "sweep"
over = {{ "errors.6.installation[0]" = ["0 um", "50 um"] }}
positions = [1]

[study.critical]
kind = "critical"
keys = ["errors.6.installation[0]"]
start = "0 um"
stop = "50 um"
positions = [1]

[study.sensitivity]
kind = "sensitivity"
keys = ["errors.*"]

[study.march]
kind = "march"
gear = "6"
revolutions = 1.0
steps = 2
""",
        encoding="utf-8",
    )
    return path


def test_sweep(command, tmp_path):
    file = tmp_path / "sweep.csv"
    result = command(
        *("sweep", RING, "--position", 1, "-o", file),
        *("--over", "rings.4.float=rings.5.float=0 um:10 um:3"),
    )
    assert result.exit_code == 0
    assert "Sweep of limit_ring: largest Ω, by stage" in result.stdout
    row = [line for line in result.stdout.splitlines() if line.split()[:1] == ["5"]][-1]
    case = ls.load_case(RING).replace({"rings.4.float": "5 um", "rings.5.float": "5 um"})
    omega = ls.solve(case, positions=[1]).pair_omega["II"]
    assert f"{omega:.4f}" in row.split()
    with file.open() as lines:
        assert len(list(csv.DictReader(lines))) == 3 * 10


def test_a_narrow_screen_cuts_no_figure(narrow):
    """With two inputs with long names in eighty columns, every Ω is printed in full."""
    result = narrow(
        *("sweep", CASES / "two_path/clocking_error.toml", "--position", 1),
        *("--over", "shafts.'wheelA-pinionA'.clocking=0 mrad, 1 mrad"),
        *("--over", "shafts.'wheelB-pinionB'.clocking=0 mrad, 1 mrad"),
    )
    assert result.stdout.count("1.0457") == 2 * 3
    assert "by stage and group alike" in result.stdout
    keys = ("meshes.*.stiffness", "shafts.*.stiffness", "gears.6.centre.distance")
    output = narrow("sensitivity", RING, *keys, "--position", 1).stdout
    assert re.search(r'meshes\."9-10"\.stiffness +6\.425e\+06 N\*m/rad', output)
    # None has a kink, so there is no column for the other side.
    assert "falling" not in output


def test_a_sweep_with_points_that_cannot_be_solved_tells_them(command):
    result = command("sweep", RING, "--over", "rings.4.float=-1 um, 1 um", "--position", 1)
    assert result.exit_code == 1
    assert "certified" in result.stdout
    assert "is negative" in result.stderr
    assert "1 point of 2 not certified." in result.stderr


def test_critical(command, tmp_path):
    file = tmp_path / "events.csv"
    words = ("critical", RING, "--over", "rings.4.float=0 um:12 um", "-o", file)
    result = command(*words)
    assert result.exit_code == 0
    row = next(line for line in result.stdout.splitlines() if "upper stop" in line)
    assert float(row.split()[0]) == pytest.approx(8.35, abs=0.01)
    assert "float leaves boundary" in row
    assert row.split()[-1] == "1-5"
    assert "Proved: there are no other events between the certified solves." in result.stdout
    with file.open() as lines:
        events = list(csv.DictReader(lines))
    assert {e["position"] for e in events} == set("12345")
    assert all(e["confirmed"] == "True" for e in events)
    none = command("critical", RING, "--over", "rings.4.float=9 um:12 um")
    assert "none" in none.stdout


def test_inputs_that_are_not_shown_are_counted(command, monkeypatch):
    monkeypatch.setattr("loadshare.study.sensitivity.view.SHOWN", 1)
    monkeypatch.setattr("loadshare.report.figures.sensitivity.MOST", 1)
    keys = ("rings.5.float", "rings.4.float")
    printed = command("sensitivity", RING, *keys, "--position", 1).stdout
    assert "Not shown: 1 input of less effect." in printed
    picture = command("sensitivity", RING, *keys, "--position", 1, "-o", "svg:-").stdout
    assert "not shown: 1 input of less effect, or none" in picture


def test_without_stages_no_derivative_of_a_share_is_given_as_zero(command):
    without = (RING, "--position", 1, "--set", "stages=")
    note = "No stages are named, so there is no load-sharing coefficient."
    result = command("sensitivity", *without, "rings.4.float")
    (row,) = (line for line in result.stdout.splitlines() if line.startswith("rings.4.float"))
    assert row.split()[-2:] == ["–", "–"]
    assert note in result.stdout
    assert "accurate" not in result.stdout
    assert note in command("sweep", *without, "--over", "rings.4.float=0 um:4 um:2").stdout


def test_sensitivity(command, tmp_path):
    file = tmp_path / "rates.nc"
    result = command("sensitivity", RING, "errors.*", "--position", 1, "-o", file)
    assert result.exit_code == 0
    assert "errors.9.installation[1]" in result.stdout
    assert file.stat().st_size > 0
    # A ring without float touches on all sides, and presses on one.
    at_kink = command(
        *("sensitivity", RING, "rings.4.float", "--position", 1),
        *("--set", "rings.4.float=0 um"),
    )
    assert "is on the verge" in at_kink.stdout
    assert "lower stop" in at_kink.stdout


def test_march(command, tmp_path):
    file = tmp_path / "march.nc"
    case = CASES / "fgfbstts/full_float.toml"
    words = ("march", case, "--gear", 4, "--revolutions", 1, "--steps", 4, "-o", file)
    result = command(*words)
    assert result.exit_code == 0
    assert "PASSED  4 of 4 positions certified" in result.stdout
    assert "dissipated [J]" in result.stdout
    assert file.stat().st_size > 0
    plain = command("march", RING, "--gear", 4, "--revolutions", 1, "--steps", 1)
    assert "no slip carries over" in plain.stdout
    table = tmp_path / "march.csv"
    assert command(*words[:-1], table).exit_code == 0
    with table.open(encoding="utf-8") as lines:
        turned = {row["position"]: float(row["revolutions"]) for row in csv.DictReader(lines)}
    assert turned == {"1": 0.0, "2": 0.25, "3": 0.5, "4": 0.75}


@pytest.mark.parametrize("words", [("march",), ("study", "way")], ids=["march", "study"])
def test_a_refused_step_of_a_march_keeps_those_before_it(command, tmp_path, words):
    """The third torque presses the teeth further than they are high."""
    shipped = (CASES / "fgfbstts/full_float.toml").as_posix()
    case = tmp_path / "case.toml"
    case.write_text(
        f"""extends = "{shipped}"
remove = ["operating.power", "operating.speed", "operating.positions"]
[operating]
torque = ["1000 N*m", "2000 N*m", "4000 kN*m", "1000 N*m"]
[march]
gear = "4"
revolutions = 1.0
steps = 4
[study.way]
kind = "march"
""",
        encoding="utf-8",
    )
    kind, *name = words
    files = [tmp_path / file for file in ("march.csv", "march.json")]
    result = command(kind, case, *name, "--allow-outside", "-o", files[0], "-o", files[1])
    assert result.exit_code == 1
    assert "REFUSED  2 of 4 positions certified" in result.stdout
    assert "dissipated [J]" in result.stdout
    refused, last = result.stderr.splitlines()[-2:]
    assert refused.startswith("REFUSED  position 3: the displacements are too large")
    assert last == "2 steps of 4 certified; each needs the one before."
    with files[0].open(encoding="utf-8") as lines:
        assert {row["position"] for row in csv.DictReader(lines)} == {"1", "2"}
    document = json.loads(files[1].read_text(encoding="utf-8"))
    assert f"REFUSED  {document['refused']}" == refused
    assert {row["position"] for row in document["rows"]} == {1, 2}


def test_files_of_a_comparison_tell_units_and_whole_positions(command, measured, tmp_path):
    """A figure without a position used to make the positions of all others 1.0."""
    more = 'measured.more={torque={"6-10"="7000 N*m"}, torque_uncertainty="100 N*m"}'
    files = [tmp_path / f"compared.{form}" for form in ("json", "csv", "nc")]
    words = [word for file in files for word in ("-o", file)]
    assert command("compare", measured, "--set", more, *words).exit_code == 0
    rows = json.loads(files[0].read_text(encoding="utf-8"))["rows"]
    assert [str(row["position"]) for row in rows] == ["1", "None"]
    assert [row["unit"] for row in rows] == ["1", "N·m"]
    with files[1].open(encoding="utf-8") as lines:
        assert [row["position"] for row in csv.DictReader(lines)] == ["1", ""]
    with xr.open_dataset(files[2]) as found:
        assert found.position.fillna(0).values.tolist() == [1, 0]
        assert found.unit.values.tolist() == ["1", "N·m"]


def test_compare_and_fit(command, measured, tmp_path):
    compared = command("compare", measured, "-o", tmp_path / "compared.csv")
    assert compared.exit_code == 0
    assert "pair_share 6-10" in compared.stdout
    assert (tmp_path / "compared.csv").read_text().startswith("measurement,quantity")
    file = tmp_path / "fitted.toml"
    words = ("--over", "errors.6.installation[0]=0 um:100 um", "-o", file)
    fitted = command("fit", measured, *words)
    assert fitted.exit_code == 0
    assert "40.5663" in fitted.stdout
    assert ls.compare(file).chi_square < 1e-12


@pytest.mark.parametrize(
    ("name", "shows"),
    [
        ("compare", "Measured against computed"),
        ("fit", "χ² from each starting point"),
        ("sweep", "Sweep of bench"),
        ("critical", "Events from 0 to 50 [um]"),
        ("sensitivity", "errors.6.installation[0]"),
        ("march", "no slip carries over"),
    ],
)
@pytest.mark.quick(2)
def test_a_study_that_the_case_holds(command, measured, name, shows):
    result = command("study", measured, name)
    assert result.exit_code == 0
    assert shows in result.stdout


def test_a_study_that_lacks_an_answer_ends_as_the_command_does(command, tmp_path):
    path = tmp_path / "open.toml"
    path.write_text(
        f"""extends = '{RING.as_posix()}'
[study.sweep]
kind = "sweep"
over = {{ "rings.4.float" = ["-1 um", "1 um"] }}
positions = [1]
""",
        encoding="utf-8",
    )
    result = command("study", path, "sweep")
    assert result.exit_code == 1
    assert "1 point of 2 not certified." in result.stderr


def test_an_event_that_is_not_confirmed_is_reported(command, monkeypatch):
    from dataclasses import replace

    from loadshare.study import critical as room

    found = ls.critical(RING, "rings.4.float", "8 um", "9 um", positions=[1])
    doubtful = replace(found, events=(replace(found.events[0], confirmed=False), *found.events[1:]))
    monkeypatch.setattr(room, "critical", lambda *_, **__: doubtful)
    result = command("critical", RING, "--over", "rings.4.float=8 um:9 um")
    assert result.exit_code == 1
    assert "1 event of 2 not confirmed" in result.stderr
    assert [line.split()[-2] for line in result.stdout.splitlines()[-2:]] == ["NO", "yes"]


def test_studies_are_listed(command, measured):
    assert "fit: fit\n" in command("study", measured).stdout
    assert "has no study" in command("study", RING).stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("sweep", RING, "--over", "rings.4.float"), "is not of the form"),
        (("sweep", RING, "--over", "rings.4.flot=0 um:1 um:2"), "Did you mean float"),
        (("sweep", RING, "--over", "a=0:1:2", "-o", "x.txt"), "unknown ending .txt. Allowed: "),
        (("critical", RING, "--over", "rings.4.float=0 um:1 N"), "cannot be expressed"),
        (("critical", RING, "--over", "rings.4.float=0:1 um"), "0 has no unit"),
        (
            ("critical", RING, "--over", "rings.4.float=0 kg:1 kg"),
            "is a mass, but a length is needed",
        ),
        (("critical", RING, "--over", "a=0:1", "--position", 9), "unknown key"),
        (
            *[("sweep", RING, "--over", "rings.4.float=0 um:1 um:2", "--position", 9)],
            "positions 1 to 5",
        ),
        (("sensitivity", RING, "rings.4.flot"), "is not in the case"),
        (("fit", RING, "--over", "rings.4.float=1 um"), "is not of the form"),
        (("fit", RING, "--over", "rings.4.float=0 um:1 um"), "contains no measurement"),
        (("compare", RING), "contains no measurement"),
        (("march", RING), "march: is missing"),
        (("study", RING, "x"), "study.x: is not in the case"),
    ],
)
def test_what_cannot_be_done_is_reported(command, words, message):
    result = command(*words)
    assert result.exit_code == 2
    assert message in result.stderr.replace("\n", " ")


def test_a_refused_study_ends_as_such(command):
    result = command(
        *("march", CASES / "fgfbstts/full_float.toml", "--set", "splines.4.stick_limit=1 um"),
        *("--gear", 4, "--revolutions", 1, "--steps", 2),
    )
    assert result.exit_code == 1
    assert "REFUSED" in result.stderr
