"""A typed program that uses the package: it is run and type-checked."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

import loadshare as ls

PROGRAM = Path(__file__).with_name("consumer.py")
ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_program_runs(tmp_path, capsys):
    spec = importlib.util.spec_from_file_location("consumer", PROGRAM)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.main(tmp_path)
    assert (tmp_path / "floats.svg").exists()


def test_the_program_names_all_that_is_public():
    text = PROGRAM.read_text(encoding="utf-8")
    public = [name for name in dir(ls) if not name.startswith("__")]
    assert [name for name in public if f"ls.{name}" not in text] == []


@pytest.mark.slow
def test_its_types_are_those_that_a_user_sees(tmp_path):
    """The program is checked without the project's own settings, in a folder of its own."""
    program = tmp_path / "program.py"
    wrong = "\nwrong: int = ls.solve(ls.examples('star/floating_sun_4'))\nls.no_such_thing\n"
    program.write_text(PROGRAM.read_text(encoding="utf-8") + wrong, encoding="utf-8")
    cache = ROOT / ".mypy_cache" / "consumer"
    words = ["--strict", "--config-file=", "--cache-dir", str(cache), "--no-pretty", str(program)]
    environment = os.environ | {"MYPYPATH": str(ROOT / "src")}
    found = subprocess.run(
        [sys.executable, "-m", "mypy", "--follow-imports=silent", *words],
        capture_output=True,
        encoding="utf-8",
        check=False,
        cwd=tmp_path,
        env=environment,
    )
    errors = [line for line in found.stdout.splitlines() if ": error:" in line]
    assert len(errors) == 2, found.stdout + found.stderr
    assert "Result" in errors[0]
    assert "no_such_thing" in errors[1]
