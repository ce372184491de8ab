"""Folders that cannot be written, and users without a home: commands still answer."""

import pwd
import subprocess
import sys

import pytest
from tests.cli.conftest import plain_environment
from tests.job.test_compilation import as_a_user, read_only  # noqa: F401 -- a fixture
from tests.support import CASES
from tests.tooth.use.pairs import SPUR

from loadshare import user_cache
from loadshare.cli.main import main

RING = CASES / "fgfbstts" / "limit_ring.toml"
SWEEP = ("sweep", RING, "--set", "rings.4.float=1 um, 2 um", "--position", 1)
STUDY = """extends = '{ring}'
[study.scatter]
kind = "tolerance"
samples = 16
indices = 0
[study.scatter.inputs]
"rings.4.float" = {{ distribution = "uniform", low = "2 um", high = "12 um" }}
"""


def ended(*words: object) -> object:
    with pytest.raises(SystemExit) as end:
        main([str(word) for word in words])
    return end.value.code


def test_commands_answer_where_nothing_can_be_written(read_only, tmp_path):  # noqa: F811
    out = tmp_path / "out"
    output = answered(
        read_only,
        tmp_path,
        [("run", RING), SWEEP, ("batch", CASES / "star", "-o", out, "-j", 1)],
    )
    assert "could not be kept" not in output
    assert (out / "summary.json").exists()


@pytest.mark.slow
def test_teeth_are_analysed_where_nothing_can_be_written(read_only, tmp_path):  # noqa: F811
    """The tooth contact is compiled, which takes half a minute, and the code cannot be stored."""
    pair, out = tmp_path / "pair.toml", tmp_path / "out"
    pair.write_text(SPUR, encoding="utf-8")
    output = answered(read_only, tmp_path, [("ltca", pair, "--positions", 1, "-o", out / "pair")])
    # This is reported once.
    assert output.count("NUMBA_CACHE_DIR") + output.count("could not be kept") == 1
    assert (out / "pair" / "law.toml").exists()


def answered(read_only, tmp_path, commands) -> str:  # noqa: F811
    """Return the output of commands for a user who may write into one folder only."""
    script = f"""
from loadshare.cli.main import main
for words in {[[str(w) for w in words] for words in commands]!r}:
    try:
        main(words)
    except SystemExit as end:
        assert end.code == 0, (words, end.code)
"""
    environment = plain_environment(LOADSHARE_CACHE="", NUMBA_CACHE_DIR="") | read_only
    done = subprocess.run(
        [*as_a_user(), sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        cwd=tmp_path / "home",
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert list((tmp_path / "home").iterdir()) == []
    return done.stderr


def test_an_output_folder_that_cannot_be_written_is_reported(read_only, tmp_path):  # noqa: F811
    home = read_only["HOME"]
    commands = {
        f"{home}/a.json": ("run", RING, "-o", f"{home}/a.json"),
        f"{home}/own.toml": ("new", "own", "-o", f"{home}/own.toml"),
        f"{home}/out": ("batch", CASES / "star", "-o", f"{home}/out"),
        f"{home}/new/a.csv": (*SWEEP, "-o", f"{home}/new/a.csv"),
    }
    script = f"""
import sys
from loadshare.cli.main import main
for words in {[[str(w) for w in words] for words in commands.values()]!r}:
    try:
        main(words)
    except SystemExit as end:
        print("\\nended with", end.code, file=sys.stderr, flush=True)
"""
    done = subprocess.run(
        [*as_a_user(), sys.executable, "-B", "-c", script],
        capture_output=True,
        text=True,
        check=True,
        env=plain_environment(),
    )
    said = done.stderr.split("\nended with 2\n")
    assert [part.splitlines()[-1] for part in said[:-1]] == [
        f"{file}: cannot be written: Permission denied" for file in commands
    ]


@pytest.fixture
def no_home(monkeypatch, tmp_path):
    """Set up a user whom the system knows by number only, as in many containers."""

    def unknown(number: int) -> None:
        raise KeyError(number)

    for name in ("HOME", "XDG_CACHE_HOME", "LOADSHARE_CACHE", "NUMBA_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(pwd, "getpwuid", unknown)
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    return here


def test_without_a_home_laws_are_not_kept(no_home, tmp_path):
    pair = tmp_path / "pair.toml"
    pair.write_text(SPUR, encoding="utf-8")
    assert user_cache.cache_folder() is None
    assert ended("ltca", pair, "--positions", 1, "-o", tmp_path / "out") == 0
    assert list(no_home.iterdir()) == []


def test_without_a_home_compiled_code_is_kept_nowhere_else(no_home, tmp_path, monkeypatch):
    """Numba would create a folder named ~ in the user's current folder."""
    from loadshare import code_cache

    def function(x: float) -> float:
        return x

    classes = code_cache.CompileResultCacheImpl._locator_classes
    monkeypatch.setattr(
        code_cache.CompileResultCacheImpl,
        "_locator_classes",
        [place for place in classes if "UserWide" in place.__name__],
    )
    with pytest.raises(RuntimeError, match="no locator available"):
        code_cache.CodeCache(function, lambda _: None)
    assert list(no_home.iterdir()) == []


def test_samples_that_have_no_place_are_reported(monkeypatch, tmp_path, capsys):
    import tempfile

    case = tmp_path / "case.toml"
    case.write_text(STUDY.format(ring=RING.as_posix()), encoding="utf-8")

    def nowhere(**_: object) -> str:
        raise FileNotFoundError(2, "No usable temporary directory found")

    monkeypatch.setattr(tempfile, "mkdtemp", nowhere)
    for words in (("tolerance", case), ("study", case, "scatter")):
        assert ended(*words) == 2
        message = capsys.readouterr().err
        assert "no folder for temporary files (No usable temporary directory found)" in message
        assert "--output" in message
    assert ended("tolerance", case, "--no-worst", "-o", tmp_path / "own") == 0
