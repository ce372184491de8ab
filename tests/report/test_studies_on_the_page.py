"""Studies on the page: those of the case, those given, and those without an answer."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from selenium.webdriver.common.by import By
from tests.chromium import CONTRAST, NAMES, badly_set, on_screen, too_wide, visit, waiting
from tests.report.pages import Reader
from tests.report.test_looks import DRAWN
from tests.support import mostly_slow, shipped
from typer.testing import CliRunner

import loadshare as ls
from loadshare.cli.main import app
from loadshare.report.page import chapter, report_page, save_report, write_report
from loadshare.report.page.studies import quick_studies, run_part, study_part

HELD = {
    "measured.fig10": {"position": 1, "pair_share": {"6-10": 0.99}, "uncertainty": 0.01},
    "study": {
        "clearance": {
            "kind": "sweep",
            "over": {"rings.*.float": "0 um:12 um:5"},
            "positions": [1],
        },
        "changes": {
            "kind": "critical",
            "keys": ["rings.4.float"],
            "start": "8 um",
            "stop": "9 um",
            "positions": [1],
        },
        "matters": {
            "kind": "sensitivity",
            "keys": ["rings.4.float", "errors.6.installation[1]"],
            "positions": [1],
        },
        "turning": {"kind": "march", "gear": "1", "revolutions": 1, "steps": 2},
        "measured": {"kind": "compare"},
        "fitted": {"kind": "fit", "unknowns": {"errors.6.installation[0]": ["-50 um", "50 um"]}},
        "scatter": {
            "kind": "tolerance",
            "samples": 64,
            "seed": 1,
            "limit": 1.01,
            "indices": 0,
            "inputs": {"rings.*.float": {"distribution": "uniform", "low": "0 um", "high": "9 um"}},
        },
    },
}


@pytest.fixture(scope="module")
def case():
    return shipped("fgfbstts/limit_ring").replace(HELD)


@pytest.fixture(scope="module")
def scatter(case):
    return ls.tolerance(case, study="scatter", positions=[1], workers=1, worst=False)


@pytest.fixture(scope="module")
def bare(case):
    """Return a chapter without studies."""
    return chapter(case)


@pytest.fixture(scope="module")
def one(case, bare, scatter):
    """Return a chapter with all studies of the case; the long one is given."""
    made = replace(bare, studies=[study_part("scatter", scatter, case)])
    parts = [run_part(case, name) for name in quick_studies(case)]
    return replace(made, studies=[*parts, *made.studies])


@pytest.fixture(scope="module")
def page(one, tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "report.html"
    save_report([one], file)
    return file


def test_every_kind_is_shown_but_a_long_one_only_on_request(case, bare, one):
    assert quick_studies(case) == [n for n in HELD["study"] if n != "scatter"]
    assert [part.name for part in one.studies] == list(HELD["study"])
    assert one.left_out == {}
    assert bare.left_out == {name: b["kind"] for name, b in HELD["study"].items()}
    assert one.unanswered == []
    assert all(part.figures and part.facts for part in one.studies)
    assert [p.name for p in one.studies if not p.tables] == ["turning"]  # no spline slips


def test_the_page_tells_the_studies_own_figures(case, scatter, page):
    text = Reader(page.read_text(encoding="utf-8")).text
    swept = ls.run_study(case, "clearance")
    for point in swept.points:
        shares = " ".join(f"{omega:.4f}" for omega in point.result.omega.values())
        assert f" {point.values[0]:.6g} {shares} " in text
    for event in ls.run_study(case, "changes").events:
        states = f"{event.before} {event.after} {event.position}"
        assert f" {event.value:.9g} {event.element} {event.kind} {states} " in text
    (unknown,) = ls.run_study(case, "fitted").unknowns
    fitted = f"{unknown.start:.6g} {unknown.value:.6g} {unknown.deviation:.3g} -50 … 50"
    assert f"errors.6.installation[0] um {fitted}" in text
    mean = scatter.of().summary.mean
    assert f" system {mean.value:.4f} ({mean.low:.4f} … {mean.high:.4f}) " in text


def test_studies_come_after_the_inputs(page):
    heads = re.findall(r"<h3>(.*?)</h3>", page.read_text(encoding="utf-8"))
    order = ["Pictures", "Tables", "Inputs", "Studies", "How to reproduce"]
    assert [head for head in heads if head in order] == order


@pytest.mark.slow
def test_a_study_without_an_answer_is_part_of_the_page(case, bare):
    lost = {"kind": "sweep", "over": {"rings.77.float": "0:1:2"}}
    broken = case.replace({"study": {"lost": lost}})
    part = run_part(broken, "lost")
    assert "rings.77" in part.problems[0]
    one = replace(bare, studies=[part])
    assert one.unanswered[0].startswith("study lost: ")
    assert "rings.77" in Reader(report_page([one])).text


def test_the_steps_before_a_refused_one_are_part_of_the_page():
    """The third torque presses the teeth further than they are high."""
    case = shipped("fgfbstts/full_float").replace(
        {
            "operating.power": None,
            "operating.speed": None,
            "operating.positions": None,
            "operating.torque": ["1000 N*m", "2000 N*m", "4000 kN*m", "1000 N*m"],
            "march": {"gear": "4", "revolutions": 1.0, "steps": 4},
            "study": {"way": {"kind": "march"}},
        }
    )
    part = run_part(case, "way")
    assert part.title == "way: march"
    assert part.facts["way"] == "2 steps, 0.25 revolutions of gear 4"
    assert part.figures
    assert [row[0] for table in part.tables for row in table.texts] == ["4", "5"]
    refused, last = part.problems
    assert refused.startswith("REFUSED  position 3: the displacements are too large")
    assert last == "2 steps of 4 certified; each needs the one before."


@pytest.mark.slow
def test_from_python(case, scatter, tmp_path):
    (one,) = write_report([case], tmp_path / "report.html", studies={"mine": scatter})
    assert [part.name for part in one.studies] == ["mine"]
    with pytest.raises(ValueError, match="studies are shown with one case, not with 2"):
        write_report([case, case], tmp_path / "no.html", studies={"mine": scatter})
    assert not (tmp_path / "no.html").exists()


@pytest.mark.parametrize(
    ("width", "dark"), mostly_slow([(390, True), (1280, False), (1920, True)], {(390, True)})
)
def test_their_pictures_fit_every_screen(browser, page, width, dark):
    on_screen(browser, width, dark=dark)
    visit(browser, page)
    waiting(browser, 60).until(lambda b: b.execute_script(DRAWN))
    assert too_wide(browser, width) <= 0
    pictures = browser.find_elements(By.CSS_SELECTOR, ".study .figure svg.marks")
    assert len(pictures) >= len(HELD["study"])
    assert [bad for picture in pictures for bad in badly_set(browser, picture)] == []
    assert browser.execute_script(CONTRAST) == []
    assert browser.execute_script(NAMES) == []
    assert browser.get_log("browser") == []


@pytest.mark.slow
def test_the_command_runs_what_is_requested(case, tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(case.to_toml(), encoding="utf-8")
    out = tmp_path / "report.html"

    def report(*words):
        done = CliRunner().invoke(app, ["report", str(file), "-o", str(out), *words])
        return done, Reader(out.read_text(encoding="utf-8")).text if done.exit_code == 0 else ""

    done, text = report("--study", "measured")
    assert done.exit_code == 0
    assert "measured: comparison" in text
    assert "Not run for this page: clearance (sweep)" in text
    done, text = report("--no-studies")
    assert "measured: comparison" not in text
    done, _ = report("--study", "lost")
    assert done.exit_code == 2
    assert "lost: no such study. Allowed: changes, clearance" in " ".join(done.stderr.split())
    done, _ = report("--study", "measured", "--no-studies")
    assert done.exit_code == 2
    assert "contradicts --no-studies" in done.stderr


def test_a_case_that_cannot_be_read_is_reported_not_its_study(tmp_path):
    """`extends` is taken from the folder of the file; its studies cannot be known."""
    file, out = tmp_path / "case.toml", tmp_path / "report.html"
    file.write_text('extends = "gone.toml"\n[study.floats]\nkind = "sensitivity"\n', "utf-8")
    done = CliRunner().invoke(app, ["report", str(file), "-o", str(out), "--study", "floats"])
    assert done.exit_code == 2
    assert "no such study" not in done.stderr
    assert "there is no such file" in " ".join(Reader(out.read_text("utf-8")).text.split())


def test_a_folder_without_samples_is_reported_before_anything_is_solved(tmp_path):
    """A typing error in its name used to start the whole study, in a folder of that name."""
    file = tmp_path / "case.toml"
    file.write_text("", encoding="utf-8")
    folder = tmp_path / "samlpes"
    done = CliRunner().invoke(app, ["report", str(file), "--study", f"pins={folder}"])
    assert done.exit_code == 2
    assert "contains no samples of a tolerance study" in " ".join(done.stderr.split())
    assert not folder.exists()


def test_samples_that_are_kept_are_not_solved_again(case, tmp_path):
    found = ls.tolerance(case, study="scatter", workers=1, worst=False, out=tmp_path / "kept")
    part = run_part(case, "scatter", kept=tmp_path / "kept")
    assert not part.problems
    assert f"{found.of().summary.mean.value:.4f}" in str(part.tables[0].rows)
