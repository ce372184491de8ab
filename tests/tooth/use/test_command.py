"""`loadshare ltca`."""

import csv
import io
import math
import re

import pytest
from tests.tooth.use.pairs import CASE, FACE, SPUR, written
from typer.testing import CliRunner

from loadshare.case import load_case
from loadshare.cli.cases import find_cases
from loadshare.cli.main import app
from loadshare.tooth import resolve


@pytest.fixture
def command():
    runner = CliRunner(env={"COLUMNS": "100"})

    def run(*words):
        result = runner.invoke(app, [str(word) for word in words], prog_name="loadshare")
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return run


def table(file):
    return list(csv.DictReader(io.StringIO(file.read_text(encoding="utf-8"))))


def test_what_it_writes(command, spur, tmp_path):
    out = tmp_path / "out"
    result = command("ltca", spur, "-o", out)
    assert result.exit_code == 0, result.output
    names = {file.name for file in out.iterdir()}
    figures = ("stiffness", "transmission_error", "load_map", "contact_pattern")
    pictures = {f"{name}{ending}" for name in figures for ending in (".svg", ".png", ".html")}
    assert names == {"law.toml", "table.csv", "lines.csv"} | pictures
    assert "A spur pair" in result.stdout
    assert "Mesh stiffness" in result.stdout
    rows = table(out / "table.csv")
    assert len(rows) == 2
    # The load on the points of every position and torque adds up to torque over base radius.
    total = {}
    for row in table(out / "lines.csv"):
        key = row["position"], float(row["torque_Nm"])
        total[key] = total.get(key, 0.0) + float(row["load_N_per_m"]) * float(row["length_m"])
    radius = 37.5e-3 * 0.9396926207859084
    for (_, torque), force in total.items():
        assert force == pytest.approx(torque / radius, rel=1e-9)


def test_a_case_can_name_the_law_file(command, spur, tmp_path):
    command("ltca", spur, "-o", tmp_path / "out/law.toml")
    by_file = written(tmp_path, CASE + 'law_file = "out/law.toml"\n', "by_file.toml")
    by_pair = written(tmp_path, CASE + 'geometry = "spur.toml"\n', "by_pair.toml")
    assert resolve(load_case(by_file)) == resolve(load_case(by_pair))


def test_options_change_the_pair(command, spur, tmp_path):
    result = command(
        "ltca", spur, "--positions", 3, "--torque", "50 N*m", "--compliance", "slices",
        "-o", tmp_path / "out",
    )  # fmt: skip
    assert "T = 50 N·m" in result.stdout
    rows = table(tmp_path / "out/table.csv")
    assert [float(row["phase"]) for row in rows] == pytest.approx([0.0, 1 / 3, 2 / 3])


def test_wrong_use_is_reported(command, spur, tmp_path):
    wrong = command("ltca", spur, "--torque", "5 kg")
    assert wrong.exit_code == 2
    assert "is a mass, but a torque is needed" in wrong.stderr
    file = written(tmp_path, SPUR.replace("teeth = 25", "teth = 25"))
    bad = command("ltca", file)
    assert bad.exit_code == 2
    assert "Did you mean teeth?" in bad.stderr
    assert "2 problems; nothing was solved." in bad.stderr


def test_misalignment_and_edges_are_reported(command, tmp_path):
    off = written(tmp_path, SPUR + '[misalignment]\ndeviation = "0.2 mrad"\n')
    result = command("ltca", off, "-o", tmp_path / "out/law.toml")
    assert "Note: driver.face" in result.stdout
    assert "turn the driver by" not in result.stdout
    assert "Load reaches the end of the face" in result.stdout


def test_what_the_law_leaves_out_is_reported(command, tmp_path):
    off = written(tmp_path, FACE + '[misalignment]\ngear_shift = "20 um"\n')
    result = command("ltca", off, "-o", tmp_path / "out/law.toml")
    lead = re.search(r"Offset and gear shift turn the driver by (\S+) µrad", result.stdout)
    # Early by s sin α along the line of action: s tan α/r at the driver, r = 25 · 4 mm/2.
    assert float(lead[1]) == pytest.approx(-20.0 / 0.05 * math.tan(math.radians(25.0)), rel=0.02)


def test_a_folder_of_cases_may_hold_pairs_and_laws(command, spur, tmp_path):
    command("ltca", spur, "-o", tmp_path / "out/law.toml")
    case = written(tmp_path, CASE + 'law_file = "out/law.toml"\n', "case.toml")
    broken = written(tmp_path, "kind = 'pump'", "broken.toml")
    assert find_cases([tmp_path]) == [broken, case]
    assert find_cases([spur]) == [spur]


@pytest.mark.parametrize("kind", [SPUR, pytest.param(FACE, marks=pytest.mark.slow)])
def test_torques_under_which_teeth_are_crushed(command, tmp_path, kind):
    """Teeth of 3 and 4 mm modules yield by some nanometres per newton and mm of width."""
    file, law = tmp_path / "pair.toml", tmp_path / "law.toml"
    file.write_text(kind, encoding="utf-8")
    words = ("ltca", file, "--compliance", "slices", "-o", law)
    assert "of their height" not in command(*words).output
    assert "of their height, too much for linear" in command(*words, "--torque", "80 kN*m").output
    law.unlink()
    done = command(*words, "--torque", "1 MN*m")
    assert done.exit_code == 1
    assert "times their height" in " ".join(done.output.split())
    assert not law.exists()
