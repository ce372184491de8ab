"""Check what would be released: what wheel and sdist hold, and that each installs and runs.

Run as ``python -m tests.surroundings.distribution dist``; it needs a package index.
"""

import argparse
import os
import subprocess
import sys
import tarfile
import tempfile
import venv
import zipfile
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[2]
NEEDED = (
    *("py.typed", "case/starters/planetary.toml"),
    *(f"report/page/templates/{name}" for name in ("report.html", "page.css", "page.js")),
)
"""Files of the package other than Python."""
CASE = ("fgfbstts/base.toml", "fgfbstts/limit_ring.toml")


def version() -> str:
    """Return the version of the source."""
    scope: dict[str, str] = {}
    exec((ROOT / "src/loadshare/_version.py").read_text(encoding="utf-8"), scope)
    return scope["__version__"]


def problems_of_wheel(names: Iterable[str]) -> list[str]:
    """Return what is wrong with the names in a wheel."""
    held = set(names)
    package = {n.removeprefix("loadshare/") for n in held if n.startswith("loadshare/")}
    source = ROOT / "src/loadshare"
    wanted = {f.relative_to(source).as_posix() for f in source.rglob("*.py")} | set(NEEDED)
    cases = ROOT / "cases"
    wanted |= {f"cases/{f.relative_to(cases).as_posix()}" for f in cases.rglob("*.toml")}
    found = [f"lacks {name}" for name in sorted(wanted - package)]
    other = {
        n for n in held if not n.startswith(("loadshare/", f"loadshare-{version()}.dist-info/"))
    }
    found += [f"holds {name}" for name in sorted(other)]
    found += [f"holds {n}" for n in sorted(held) if "__pycache__" in n]
    if not any(n.endswith(".dist-info/licenses/LICENSE") for n in held):
        found.append("lacks LICENSE")
    return found


def problems_of_sdist(names: Iterable[str]) -> list[str]:
    """Return what is wrong with the names in an sdist."""
    held = {name.partition("/")[2] for name in names}
    wanted = ("LICENSE", "README.md", "CHANGELOG.md", "pyproject.toml", "constraints.txt")
    folders = ("src/loadshare/__init__.py", "tests/conftest.py", f"cases/{CASE[0]}")
    found = [f"lacks {name}" for name in (*wanted, *folders) if name not in held]
    hidden = (n for n in held if "__pycache__" in n or n.startswith((".venv", "site/", "dist/")))
    return found + [f"holds {name}" for name in sorted(hidden)]


def files_in(folder: Path) -> tuple[Path, Path]:
    """Return absolute paths of the wheel and the sdist in a folder."""
    wheels, sdists = (sorted(folder.resolve().glob(end)) for end in ("*.whl", "*.tar.gz"))
    if (len(wheels), len(sdists)) != (1, 1):
        raise SystemExit(f"{folder}: holds {len(wheels)} wheels and {len(sdists)} sdists")
    return wheels[0], sdists[0]


def installed_and_run(file: Path) -> None:
    """Install a distribution into an empty environment; solve a case with it outside the clone."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        venv.create(place / "env", with_pip=True)
        scripts = place / "env" / ("Scripts" if sys.platform == "win32" else "bin")
        pip = [str(scripts / "python"), "-m", "pip", "install", "--quiet"]
        pins = ["-c", str(ROOT / "constraints.txt")]
        subprocess.run([*pip, *pins, str(file)], check=True, cwd=place)
        for name in CASE:
            text = (ROOT / "cases" / name).read_bytes()
            (place / Path(name).name).write_bytes(text)
        command = str(scripts / "loadshare")
        output = _output(place, command, "--version")
        if output.split() != ["loadshare", version()]:
            raise SystemExit(f"{file.name}: --version says {output!r}")
        if "PASSED  5 of 5 positions certified" not in _output(
            place, command, "run", "limit_ring.toml"
        ):
            raise SystemExit(f"{file.name}: the main job does not pass")
        _output(place, command, "new", "own")
        _output(place, command, "new", "four", "--example", "star/floating_sun_4")
        _output(place, command, "report", "own.toml", "-o", "own.html")


def _output(place: Path, *words: str) -> str:
    # Nothing of the source may be importable.
    alone = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | {"PYTHONUTF8": "1"}
    done = subprocess.run(
        words, capture_output=True, encoding="utf-8", check=False, cwd=place, env=alone
    )
    if done.returncode:
        raise SystemExit(f"{' '.join(words)}: ended with {done.returncode}\n{done.stderr}")
    return done.stdout


def main() -> None:
    """Check every distribution in a folder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--tag", default="", help="tag of the release, which names the version")
    options = parser.parse_args()
    if options.tag and options.tag != f"v{version()}":
        raise SystemExit(f"the tag is {options.tag}, the version {version()}")
    wheel_file, sdist_file = files_in(options.folder)
    with zipfile.ZipFile(wheel_file) as wheel:
        wrong = {wheel_file: problems_of_wheel(wheel.namelist())}
    with tarfile.open(sdist_file) as sdist:
        wrong[sdist_file] = problems_of_sdist(sdist.getnames())
    problems = [f"{file.name} {problem}" for file, found in wrong.items() for problem in found]
    if problems:
        raise SystemExit("\n".join(problems))
    for file in wrong:
        installed_and_run(file)
        size = file.stat().st_size // 1024
        sys.stdout.write(f"{file.name}: {size} KiB; installs, and runs the main job\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
