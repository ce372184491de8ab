"""The command of the reproduction: its files and its refusals."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

from benchmarks.reproduction import publish
from benchmarks.reproduction.__main__ import app
from benchmarks.reproduction.publish import PAGE, Reproduction
from benchmarks.reproduction.rings import point_chapter


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(app, list(map(str, words)))


@pytest.mark.slow
def test_page_and_pictures_are_the_same_bytes_every_time(run, seed, limited, tmp_path, monkeypatch):
    """One chapter replaces all of them, which the slow test computes."""
    found = Reproduction((point_chapter(seed, limited),), {"fgfbstts/base.toml": "0" * 64})
    monkeypatch.setattr(publish, "reproduce", lambda cases, tell: found)
    for name in ("one", "two"):
        done = run("--quiet", "-o", tmp_path / name)
        assert done.exit_code == 0
        assert done.output.count("Wrote ") == 2
    for path, holds in {PAGE: b"## Fig. 14", "reproduction/points.svg": b"<svg"}.items():
        one, two = ((tmp_path / name / path).read_bytes() for name in ("one", "two"))
        assert holds in one
        assert one == two


def test_a_folder_without_cases_is_reported_and_nothing_is_written(run, tmp_path):
    done = run("--cases", tmp_path / "nowhere", "-o", tmp_path / "out", "--quiet")
    assert done.exit_code == 2
    assert "--cases names the folder of the shipped cases" in " ".join(done.output.split())
    assert not (tmp_path / "out").exists()
