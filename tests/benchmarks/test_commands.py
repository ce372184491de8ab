"""The commands of the benchmarks that publish: their output, files and refusals."""

import json

import pytest
from typer.testing import CliRunner

from benchmarks.chart.__main__ import app as chart
from benchmarks.chart.draw import draw_branches, draw_precision
from benchmarks.chart.measure import Measure
from benchmarks.documents import read_figures, write_figures
from benchmarks.graphics.__main__ import app as graphics
from benchmarks.stress.__main__ import app as stress
from loadshare.cli.main import app as loadshare


@pytest.fixture
def run():
    runner, apps = CliRunner(), {"stress": stress, "chart": chart, "graphics": graphics}
    return lambda name, *words: runner.invoke(apps[name], list(words))


def test_one_problem_is_explained_and_written_as_a_case(run, tmp_path):
    file = tmp_path / "problem.toml"
    done = run("stress", "--family", "verge", "--problem", "7", "--case", str(file))
    assert done.exit_code == 0
    assert "has an answer" in done.output
    assert "certified" in done.output
    assert CliRunner().invoke(loadshare, ["check", str(file)]).exit_code == 0


def test_a_problem_without_an_answer_is_refused_by_name(run):
    done = run("stress", "--family", "impossible", "--problem", "0")
    assert done.exit_code == 0
    assert "has no answer" in done.output
    assert "refused" in done.output


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("stress", "--family", "nonsense"), "stiffness-ratio"),
        (("stress", "--problem", "3"), "goes with --family"),
        (("stress", "--family", "verge", "--problem", "200"), "problems 0 to 199"),
        (("chart", "--redraw", "-o", "nowhere"), "leave out --redraw"),
        (("graphics", "--draw", "-o", "nowhere"), "leave out --draw"),
        (("chart", "--cases", "nowhere", "-o", "elsewhere", "--quiet"), "--cases"),
    ],
)
def test_wrong_words_are_reported(run, words, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = run(*words)
    assert done.exit_code == 2
    assert message in done.output


def test_the_page_of_the_graphics_processor_has_what_was_measured(run, tmp_path):
    row = {"workload": "rings", "title": "limit rings", "equilibria": 300, "threads": 64}
    row |= {"core": 1.2, "device": 0.05, "moved": 0.02, "sets": 7, "visits": 1.5}
    row |= {"settled": 300, "settled_by_core": 299, "alike": 298, "worst": 2e-13}
    write_figures(tmp_path / "graphics.json", {"facts": {"device": "any"}, "rows": [row]})
    assert run("graphics", "--draw", "-o", str(tmp_path)).exit_code == 0
    page = (tmp_path / "graphics.md").read_text()
    assert "| limit rings | 1.20 | 0.050 | 24 | 0.020 | 7 | 1.50 | 300, 299 | 298 |" in page
    assert "| device | any |" in page
    assert "limit rings" in (tmp_path / "graphics.svg").read_text()


@pytest.mark.slow
def test_the_map_of_one_family_is_written_and_drawn_again(run, tmp_path):
    words = ("stress", "--family", "lost-contact", "--ours", "--quick", "-o", str(tmp_path))
    assert run(*words, "--quiet").exit_code == 0
    names = {p.name for p in tmp_path.iterdir()}
    assert names == {f"stability.{k}" for k in ("json", "md", "png", "svg", "html")}
    (cell,) = json.loads((tmp_path / "stability.json").read_text())["cells"]
    assert cell["counts"] == {
        "certified": 20,
        "refused": 0,
        "wrong": 0,
        "crashed": 0,
        "not for it": 0,
    }
    before = (tmp_path / "stability.md").read_text()
    (tmp_path / "stability.md").unlink()
    assert run("stress", "--redraw", "-o", str(tmp_path)).exit_code == 0
    assert (tmp_path / "stability.md").read_text() == before
    # The page must open without a network, so it contains its scripts.
    assert "<script src=" not in (tmp_path / "stability.html").read_text()


@pytest.mark.slow
def test_charts_are_drawn_from_figures(tmp_path):
    def one(workload, method, tolerance, us, worst):
        times = (us, us, us / 2, us / 2, us / 3)
        return Measure(workload, method, tolerance, 8, 8, 8, *times, worst / 10, worst, 1.0, "")

    measures = [one("law", "ours, batch", None, 5.0, 1e-13), one("law", "DAQP", 1e-9, 900.0, 1e-9)]
    for file in draw_precision(measures, {"law": "b + c law"}, tmp_path):
        assert file.stat().st_size > 10_000
    scaled = [one(f"branches-{n}", "ours, batch", None, n, 1e-12) for n in (4, 8)]
    files = draw_branches(scaled, tmp_path)
    assert [f.suffix for f in files] == [".png", ".svg", ".html"]


def test_figures_that_are_not_finite_survive_as_nothing(tmp_path):
    file = tmp_path / "figures.json"
    write_figures(file, {"a": [1.5, float("nan")], "b": {"c": float("inf"), "d": "text"}})
    assert read_figures(file) == {"a": [1.5, None], "b": {"c": None, "d": "text"}}
