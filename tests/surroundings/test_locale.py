"""Answers do not depend on language or encoding; a character that a stream cannot show becomes a
question mark.
"""

import json
import subprocess
import sys

import pytest
from tests.cli.conftest import plain_environment
from tests.support import CASES, mostly_slow

RING = CASES / "fgfbstts" / "limit_ring.toml"
SETTINGS = {
    "C": {"LC_ALL": "C"},
    "no UTF-8": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    "POSIX and ASCII": {"LC_ALL": "POSIX", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"},
    "Latin 1": {"PYTHONUTF8": "0", "PYTHONIOENCODING": "latin-1"},
    "unknown": {"LC_ALL": "xx_XX.nothing", "LANG": "xx_XX", "PYTHONUTF8": "0"},
}


def ran(*words: object, before: str = "", **settings: str) -> subprocess.CompletedProcess[bytes]:
    start = f"{before}\nfrom loadshare.cli.main import main; main()"
    environment = plain_environment(**settings)
    environment.pop("LC_ALL", None) if "LC_ALL" not in settings else None
    return subprocess.run(
        [sys.executable, "-c", start, *map(str, words)],
        capture_output=True,
        check=False,
        env=environment,
    )


@pytest.fixture(scope="module")
def wanted(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, bytes, bytes]:
    folder = tmp_path_factory.mktemp("wanted")
    return run_in(folder, PYTHONUTF8="1")


def run_in(folder, before="", **settings):
    table, result = folder / "a.csv", folder / "a.json"
    words = ("run", RING, "-o", table, "-o", result)
    done = ran(*words, before=before, **settings)
    assert done.returncode == 0, done.stderr
    assert all(line.startswith(b"Wrote ") for line in done.stderr.splitlines())
    return done.stdout, table.read_bytes(), result.read_bytes()


@pytest.mark.parametrize("name", mostly_slow(SETTINGS, {"POSIX and ASCII"}))
def test_files_are_the_same_under_any_locale(wanted, tmp_path, name):
    shown, table, result = run_in(tmp_path, **SETTINGS[name])
    assert (table, result) == wanted[1:]
    assert json.loads(result.decode("utf-8"))
    for line in (b"PASSED  5 of 5 positions certified", b"7567.1"):
        assert line in shown


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
@pytest.mark.slow
def test_a_case_with_letters_of_any_kind_is_read_and_named(tmp_path, settings):
    case = tmp_path / "Straße µ.toml"
    case.write_text(f"extends = '{RING.as_posix()}'\nname = 'Straße Ω'\n", encoding="utf-8")
    # One process for both checks.
    first = """
import sys
from loadshare.cli.main import main
try:
    main(["check", sys.argv.pop()])
except SystemExit:
    pass
"""
    missing = ran("run", tmp_path / "größer.toml", case, before=first, **settings)
    assert missing.returncode == 2
    assert b"Traceback" not in missing.stderr
    assert b"in 1 of 1 case." in missing.stderr
    assert b"no such file" in missing.stderr


def test_a_locale_with_decimal_commas_changes_no_figure(wanted, tmp_path):
    """A locale of the system is used, if any; libraries that print by the locale are called."""
    import locale

    before = "import locale; locale.setlocale(locale.LC_ALL, {name!r})"
    known = locale.setlocale(locale.LC_ALL)
    for name in ("de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "German_Germany"):
        try:
            locale.setlocale(locale.LC_ALL, name)
        except locale.Error:
            continue
        locale.setlocale(locale.LC_ALL, known)
        found = run_in(tmp_path, before.format(name=name), PYTHONUTF8="1")
        assert found == wanted
        return
    # Without such a locale, Python itself is made to use commas.
    commas = """
import locale
locale.localeconv = lambda: {"decimal_point": ",", "thousands_sep": ".", "grouping": [3, 0]}
"""
    assert run_in(tmp_path, commas, PYTHONUTF8="1") == wanted
