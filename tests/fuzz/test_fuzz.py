"""A sample of unintended inputs; ``make fuzz N=100000`` tries any number of them."""

import os
import stat

import pytest
from tests.cli.conftest import on_a_screen_of
from tests.fuzz.corpus import CORPUS, retried
from tests.fuzz.trial import compile_first, trial
from tests.support import mostly_slow

import loadshare as ls
from loadshare.outside import OUTSIDE


@pytest.fixture(scope="module")
def compiled():
    compile_first()


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("part", range(8))
@pytest.mark.quick(2)
def test_no_input_ends_in_anything_but_words(tmp_path, part, monkeypatch):
    """No traceback, no warning, no hang, no NaN among figures, no result that fails."""
    # As for ordinary users, whose cases may not read files outside their folder.
    monkeypatch.delenv(OUTSIDE)
    faults = []
    for number in range(40 * part, 40 * part + 40):
        folder = tmp_path / str(number)
        folder.mkdir()
        found = trial(1, number, folder)
        if found.fault:
            faults.append(found)
    assert faults == []


def test_the_harness_finds_what_must_not_be(tmp_path, monkeypatch):
    """A check that cannot fail would prove nothing."""
    from loadshare.cli import run

    def wrong(*_: object) -> None:
        raise ZeroDivisionError("of a test")

    monkeypatch.setattr(run, "_solved", wrong)
    monkeypatch.setattr("tests.fuzz.trial.SHARES", ("words",))
    faults = set()
    for number in range(60):
        folder = tmp_path / str(number)
        folder.mkdir()
        faults.add(trial(1, number, folder).fault.partition(" (")[0])
    assert "ZeroDivisionError: of a test" in faults


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes on this system")
def test_pipes_and_devices_are_not_waited_for(tmp_path):
    for name in ("result.json", "result.nc"):
        os.mkfifo(tmp_path / name)
        assert stat.S_ISFIFO((tmp_path / name).stat().st_mode)
        with pytest.raises(ls.ResultError, match="is not a regular file"):
            ls.load_result(tmp_path / name)
    os.mkfifo(tmp_path / "case.toml")
    found = on_a_screen_of(80)("check", tmp_path)
    assert found.exit_code == 2
    assert "is not a regular file" in found.output


def test_a_name_that_is_too_long_is_reported():
    found = on_a_screen_of(80)("check", "a" * 5000)
    assert found.exit_code == 2
    assert "file name too long" in found.output


KEPT = sorted(CORPUS.iterdir())
LONG = {"case-101-1696", "study-40003-5927", "study-60005-19145"}
"""Those of the inputs that take seconds."""


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize(
    "kept",
    mostly_slow(KEPT, [kept for kept in KEPT if kept.name not in LONG]),
    ids=lambda kept: kept.name,
)
@pytest.mark.quick(3)
def test_what_was_found_once_is_reported_in_words(tmp_path, kept, monkeypatch):
    monkeypatch.delenv(OUTSIDE)
    assert retried(kept, tmp_path) == ""
