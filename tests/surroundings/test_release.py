"""Preconditions of a release: bounds that were tested, and workflows that call existing targets."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml
from tests.surroundings import distribution

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def pins(name: str) -> dict[str, str]:
    lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
    found = [line for line in lines if line and not line.startswith("#")]
    # A name and a number, but no address to take it from.
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+", line) for line in found)
    return {line.split("==")[0].lower(): line.split("==")[1] for line in found}


def numbers(version: str) -> tuple[int, ...]:
    found = [int(part) for part in version.split(".") if part.isdigit()]
    while found and found[-1] == 0:
        found.pop()
    return tuple(found)


@pytest.mark.parametrize("bound", PROJECT["dependencies"])
def test_the_lowest_version_of_each_package_is_the_one_that_is_tested(bound):
    name, _, lowest = bound.partition(">=")
    tested = pins("constraints-lowest.txt")[name]
    # The first release of some versions was withdrawn or appeared on another day: 2.2 came as
    # 2.2.2.
    assert numbers(tested)[: len(numbers(lowest))] == numbers(lowest)
    assert numbers(pins("constraints.txt")[name]) >= numbers(lowest)


@pytest.mark.parametrize("file", WORKFLOWS, ids=lambda f: f.name)
def test_a_workflow_calls_what_is_there(file):
    # YAML reads "on" as true.
    flow = yaml.safe_load(file.read_text(encoding="utf-8"))
    assert {"name", True, "jobs", "permissions"} <= set(flow)
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE))
    for job in flow["jobs"].values():
        assert job["runs-on"]
        for step in job["steps"]:
            if "uses" in step:
                # Actions are named with a version, never with a branch.
                assert re.fullmatch(r"[\w.-]+/[\w./-]+@v\d+(\.\d+)*", step["uses"])
                continue
            words = step["run"].split()
            if words[0] == "make":
                assert words[1] in targets
            for word in words:
                if word.startswith(("tests/", "cases/", ".ci/")):
                    assert (ROOT / word).exists()


def test_workflows_hold_no_secret():
    text = "".join(file.read_text(encoding="utf-8") for file in WORKFLOWS)
    assert "secrets." not in text
    assert "password" not in text.replace("no password is stored", "")
    assert len(WORKFLOWS) == 3


def test_the_workflow_runs_what_is_promised():
    flow = yaml.safe_load((ROOT / ".github/workflows/test.yml").read_text(encoding="utf-8"))
    matrix = flow["jobs"]["newest"]["strategy"]["matrix"]
    promised = [c.rpartition(" ")[2] for c in PROJECT["classifiers"] if ":: 3." in c]
    assert matrix["python"] == promised
    assert {system.partition("-")[0] for system in matrix["os"]} == {"ubuntu", "macos", "windows"}


def test_what_a_wheel_must_hold_is_looked_for():
    source = ROOT / "src" / "loadshare"
    info = f"loadshare-{distribution.version()}.dist-info"
    whole = [f"loadshare/{f.relative_to(source).as_posix()}" for f in source.rglob("*.py")]
    whole += [f"loadshare/{name}" for name in distribution.NEEDED]
    cases = ROOT / "cases"
    whole += [f"loadshare/cases/{f.relative_to(cases).as_posix()}" for f in cases.rglob("*.toml")]
    whole += [f"{info}/licenses/LICENSE", f"{info}/METADATA"]
    assert distribution.problems_of_wheel(whole) == []
    assert distribution.problems_of_wheel([*whole, "tests/a.py"]) == ["holds tests/a.py"]
    assert distribution.problems_of_wheel(whole[:-2]) == ["lacks LICENSE"]
    assert distribution.problems_of_wheel([n for n in whole if "py.typed" not in n])
    assert distribution.problems_of_wheel([n for n in whole if "floating_sun_4" not in n])


def test_what_an_sdist_must_hold_is_looked_for():
    assert "lacks LICENSE" in distribution.problems_of_sdist(["loadshare-1/README.md"])
    found = distribution.problems_of_sdist(["loadshare-1/site/index.html"])
    assert found[-1] == "holds site/index.html"


def test_distributions_are_installed_from_elsewhere(tmp_path, monkeypatch):
    """`make dist` gives their folder relative to the clone."""
    folder = tmp_path / "dist"
    folder.mkdir()
    for name in ("a-1-py3-none-any.whl", "a-1.tar.gz"):
        (folder / name).touch()
    monkeypatch.chdir(tmp_path)
    assert all(file.is_absolute() for file in distribution.files_in(Path("dist")))
    (folder / "a-2.tar.gz").touch()
    with pytest.raises(SystemExit, match="1 wheels and 2 sdists"):
        distribution.files_in(Path("dist"))
