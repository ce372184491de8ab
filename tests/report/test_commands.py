"""`loadshare draw` and `loadshare report`."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.report.pages import Reader
from tests.support import CASES
from typer.testing import CliRunner

from loadshare.cli.main import app

RING = CASES / "fgfbstts/limit_ring.toml"
STAR = CASES / "star/floating_sun_3.toml"


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Run the command in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*words):
        result = CliRunner().invoke(app, [str(w) for w in words], prog_name="loadshare")
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return run


def test_draw_writes_a_drawing(command):
    result = command("draw", STAR)
    assert (result.exit_code, result.stdout, result.stderr) == (0, "Wrote drawing.svg.\n", "")
    svg = Path("drawing.svg").read_text(encoding="utf-8")
    assert "planet2" in svg
    assert "sun (input), ring (output)" in svg


def test_draw_shows_what_does_not_fit(command):
    result = command("draw", RING, "--set", "gears.6.centre.angle=38 deg", "-o", "wrong.svg")
    assert result.exit_code == 2
    assert result.stdout == "Wrote wrong.svg.\n"
    assert 'meshes."4-6".pressure_angle' in result.stderr
    assert result.stderr.endswith("1 problem; the drawing shows what could be read.\n")
    assert "27.5 mm too far apart" in Path("wrong.svg").read_text(encoding="utf-8")


def test_draw_nothing_of_a_case_that_could_not_be_read_just_then(command, monkeypatch):
    """If the file is back at the second read, the picture would be incomplete, or another one."""
    from loadshare.errors import CaseError, Problem

    def missing(file, **_):
        raise CaseError([Problem(str(file), "", "", "input/output error")])

    monkeypatch.setattr("loadshare.case.load_case", missing)
    Path("old.svg").write_text("old", encoding="utf-8")
    result = command("draw", STAR, "-o", "old.svg")
    assert result.exit_code == 2
    assert result.stderr.endswith("input/output error.\n1 problem; nothing was solved.\n")
    assert Path("old.svg").read_text(encoding="utf-8") == "old"


def test_draw_a_train_that_locks(command):
    """Each value of the case is valid, but the train cannot turn."""
    mesh = '{pressure_angle = "20 deg", stiffness = "1e6 N*m/rad"}'
    result = command("draw", STAR, "--set", f'meshes."planet1-planet2"={mesh}')
    assert result.exit_code == 2
    assert result.stdout == "Wrote drawing.svg.\n"


@pytest.mark.parametrize("words", [("draw", "none.toml"), ("report", "none")])
def test_no_case(command, words):
    result = command(*words)
    assert result.exit_code == 2
    assert "Traceback" not in result.output
    assert result.stderr


def test_draw_tells_which_endings_there_are(command):
    result = command("draw", STAR, "-o", "a.bmp")
    assert result.exit_code == 2
    assert ".svg" in result.stderr
    assert not Path("a.bmp").exists()


def test_report_writes_a_page(command):
    result = command("report", STAR)
    assert (result.exit_code, result.stdout) == (0, "Wrote report.html.\n")
    assert "Star with 3 planets" in Path("report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["report", "run"])
def test_the_page_of_a_changed_case_says_so_and_how_to_make_it_again(command, name):
    change = "operating.torque=500 N*m"
    assert command(name, STAR, "--set", change, "-o", "page.html").exit_code == 0
    text = Reader(Path("page.html").read_text(encoding="utf-8")).text
    assert f"Changed {change}" in text
    for words in ("run {}", "report {} -o report.html"):
        assert f"loadshare {words.format(STAR)} --set '{change}'" in text


def test_a_report_is_html_and_nothing_else(command):
    result = command("report", STAR, "-o", "report.pdf")
    assert result.exit_code == 2
    assert "report.pdf: this command cannot write a picture. Allowed: .html." in result.stderr
    assert not Path("report.pdf").exists()


def test_report_tells_what_failed_and_writes_the_page_all_the_same(command):
    Path("bad.toml").write_text("title = 'bad'\n", encoding="utf-8")
    result = command("report", "bad.toml", STAR, "-o", "both.html")
    assert result.exit_code == 2
    assert result.stderr.startswith("bad.toml: cannot be used\nbad.toml: operating: is missing")
    page = Path("both.html").read_text(encoding="utf-8")
    assert "cannot be used" in page
    assert "Star with 3 planets" in page


def test_a_page_that_cannot_be_written_is_reported(command):
    Path("report.html").mkdir()
    result = command("report", STAR)
    assert result.exit_code == 2
    assert "Traceback" not in result.output
