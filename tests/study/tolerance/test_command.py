"""`loadshare tolerance` and `loadshare study`: their output and files, and how they end."""

import io

import pytest
from rich.console import Console
from tests.cli.conftest import on_a_screen_of
from tests.support import CASES

from loadshare.cli import console as room

PATHS = CASES / "two_path/clocking_error.toml"


@pytest.fixture
def command():
    return on_a_screen_of(120)


@pytest.fixture
def scattering(tmp_path):
    """Write a case with a small tolerance study."""
    path = tmp_path / "scattering.toml"
    path.write_text(
        f"""extends = '{PATHS.as_posix()}'
[study.clocking]
kind = "tolerance"
samples = 128
seed = 5
limit = 1.06
indices = 16
quantiles = [0.5, 0.9]

[study.clocking.inputs.'shafts."wheelA-pinionA".clocking']
distribution = "normal"
mean = "1.2 mrad"
deviation = "0.1 mrad"
""",
        encoding="utf-8",
    )
    return path


def test_a_study_is_reported_and_written(command, scattering, tmp_path):
    out = tmp_path / "found"
    done = command("tolerance", scattering, "clocking", "-o", out)
    assert done.exit_code == 0, done.output
    for line in (
        "128 random samples, seed 5, 1 position",
        "normal mean 1.2, deviation 0.1 mrad",
        "P(Ω > 1.06)",
        "Shares of the variance of Ω of the system",
        "Largest driver torque over positions [N·m]",
        "there may be a worse case",
        "Intervals in brackets: 95 %.",
    ):
        assert line in done.output, line
    assert "group" not in done.output
    files = ["indices", "part-000000.parquet", "study.json", "worst.json"]
    assert sorted(p.name for p in out.iterdir()) == files
    again = command("tolerance", scattering, "--output", out)
    assert again.stdout == done.stdout
    other = command("tolerance", scattering, "-o", out, "--seed", 6, "--samples", 64)
    assert other.exit_code == 2
    assert "samples: 128 there, 64 requested" in other.output
    assert "seed: 5 there, 6 requested" in other.output


def test_study_runs_it_by_name(command, scattering):
    assert command("study", scattering).output == "clocking: tolerance\n"
    done = command("study", scattering, "clocking")
    assert done.exit_code == 0, done.output
    assert done.stdout == command("tolerance", scattering).stdout


def test_refused_samples_end_with_a_code(command, scattering):
    """For some samples, the power gives so little torque that the spline's law drops."""
    path = scattering.with_name("spline.toml")
    path.write_text(
        f"""extends = '{(CASES / "fgfbstts/full_float.toml").as_posix()}'
remove = ["splines.4.normal_force"]
[splines.4]
friction = 0.1
radius = "35 mm"
stick_limit = "100 um"
[study.power]
kind = "tolerance"
samples = 24
indices = 0
positions = [1]
inputs = {{ "operating.power" = {{ distribution = "uniform", low = "20 kW", high = "800 kW" }} }}
""",
        encoding="utf-8",
    )
    done = command("tolerance", path, "--no-worst")
    assert done.exit_code == 1
    assert "REFUSED" in done.output
    assert "would drop" in done.output
    assert "of 24 not certified" in done.output
    assert "Worst case" not in done.output


def test_what_cannot_be_used_is_reported(command, scattering, tmp_path):
    wrong = command("tolerance", scattering, "other")
    assert wrong.exit_code == 2
    assert "is not a tolerance study of the case" in wrong.output
    wrong = command("tolerance", PATHS)
    assert wrong.exit_code == 2
    assert "has no tolerance study" in wrong.output


def test_the_bar_tells_rate_and_time_left(monkeypatch):
    screen = Console(file=io.StringIO(), force_terminal=True, width=120, color_system=None)
    monkeypatch.setattr(room, "console", lambda **_: screen)
    with room.progress("samples", None, rated=True) as tick:
        tick(4096, 40960)
        tick(8192, 40960)
    shown = screen.file.getvalue()
    assert "8192/40960" in shown
    assert "/s" in shown
    assert "left" in shown
