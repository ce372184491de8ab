from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from loadshare.cli.main import app

CASES = Path(__file__).parents[2] / "cases"
START = "from loadshare.cli.main import main; main()"


@pytest.fixture(scope="session")
def cases() -> Path:
    """Return the folder of shipped cases."""
    return CASES


def on_a_screen_of(columns: int) -> Callable[..., Any]:
    """Run the command in this process; only an exit code may leave it."""
    runner = CliRunner(env={"COLUMNS": f"{columns}", "FORCE_COLOR": None, "TTY_COMPATIBLE": None})

    def run(*words: str | Path) -> Any:
        result = runner.invoke(app, [str(word) for word in words], prog_name="loadshare")
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        assert "Traceback" not in result.output
        return result

    return run


@pytest.fixture
def command() -> Callable[..., Any]:
    """Run the command on a screen of 80 columns."""
    return on_a_screen_of(80)


@pytest.fixture
def environment() -> dict[str, str]:
    """Return the environment of a pipe: nothing that asks for colours or sets a width."""
    return plain_environment()


@pytest.fixture
def process() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command as the user does, in a process of its own."""

    def run(*words: str | Path, **settings: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-c", START, *map(str, words)],
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
            env=plain_environment(**settings),
        )

    return run


def plain_environment(**settings: str) -> dict[str, str]:
    """Return the environment of a pipe: nothing that asks for colours or sets a width."""
    wanted = {k: v for k, v in os.environ.items() if k not in ("FORCE_COLOR", "COLUMNS")}
    return wanted | {"PYTHONPATH": os.pathsep.join(sys.path), "PYTHONUTF8": "1"} | settings


@pytest.fixture
def unheld(tmp_path: Path) -> Path:
    """Write a case with a free sun between two planets: nothing holds it across their line."""
    return write_case(
        tmp_path / "unheld.toml",
        CASES / "star" / "floating_sun_3.toml",
        """remove = ['meshes."sun-planet3"', 'meshes."planet3-ring"', "gears.planet3", "stages"]""",
    )


@pytest.fixture
def half_held(tmp_path: Path, unheld: Path) -> Path:
    """Write the same with two positions; the first is unloaded and so has an equilibrium."""
    return write_case(
        tmp_path / "half_held.toml",
        unheld,
        'operating.torque = ["0 N*m", "1000 N*m"]\noperating.positions = 2',
    )


@pytest.fixture
def broken(tmp_path: Path) -> Path:
    """Write a case with three problems."""
    return write_case(
        tmp_path / "broken.toml",
        CASES / "fgfbstts" / "base.toml",
        'colour = "red"\n[gears.2]\nbase_radius = 3\n[gears.3]\nbase_radius = "3 kg"',
    )


def write_case(path: Path, base: Path, text: str) -> Path:
    """Write a case that extends another."""
    path.write_text(f"extends = '{base.as_posix()}'\n{text}\n", encoding="utf-8")
    return path
