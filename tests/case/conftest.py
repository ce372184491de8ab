from pathlib import Path

import pytest

from loadshare.case import Case, load_case

CASES = Path(__file__).parents[2] / "cases"


@pytest.fixture(scope="session")
def drive_text() -> str:
    """Return a small valid case file."""
    return Path(__file__).with_name("drive.toml").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def drive() -> Case:
    """Return the small valid case of drive.toml."""
    return load_case(Path(__file__).with_name("drive.toml"))


@pytest.fixture
def cases() -> Path:
    """Return the folder of shipped cases."""
    return CASES


@pytest.fixture
def case_files() -> list[Path]:
    """Return the shipped cases, without the pair files that some of them name."""
    return sorted(file for file in CASES.rglob("*.toml") if file.parent.name != "pairs")
