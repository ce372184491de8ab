"""One unintended input given to the command, and the fault that it causes, if any."""

from __future__ import annotations

import json
import math
import re
import shutil
import warnings
from collections.abc import Callable, Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from tests.exchange import units
from tests.fuzz.mutations import (
    NAMES,
    NUMBERS,
    UNITS,
    Random,
    garbled,
    mutated,
    pick,
    rescaled,
    seeds,
    toml,
)

import loadshare as ls
from benchmarks.limit import TooLong, limited
from loadshare.cli.main import main
from loadshare.exchange.spreadsheet.exporting import case_frames
from loadshare.output import csv_of
from loadshare.settings import ALLOWED
from loadshare.tooth.pair.file import load_pair

CASES = Path(__file__).parents[2] / "cases"
SECONDS = 10.0
"""Processor time [s] beyond which a command counts as hanging."""
SETTINGS = (
    "operating.torque",
    "operating.power",
    "rings.4.float",
    "rings.*.float",
    "meshes.4-6.backlash",
    "errors.6.installation",
    "gears.10.support",
    "splines.4.bound",
    "march.steps",
    "title",
    "x",
)


STUDIES: dict[str, dict[str, Any]] = {
    "sweep": {"kind": "sweep", "over": {"rings.4.float": "0 um:12 um:3"}, "positions": [1]},
    "critical": {
        "kind": "critical",
        "keys": ["rings.4.float", "rings.5.float"],
        "start": "4 um",
        "stop": "8 um",
        "positions": [1],
    },
    "sensitivity": {"kind": "sensitivity", "keys": ["rings.4.float"], "positions": [2]},
    "march": {"kind": "march", "gear": "4", "revolutions": 0.1, "steps": 3},
    "compare": {"kind": "compare"},
    "fit": {"kind": "fit", "unknowns": {"rings.4.float": ["0 um", "9 um"]}, "starts": 1},
    "tolerance": {
        "kind": "tolerance",
        "samples": 16,
        "indices": 16,
        "seed": 1,
        "limit": 1.2,
        "inputs": {
            "rings.4.float": {"distribution": "uniform", "low": "0 um", "high": "9 um"},
            "rings.5.float": {
                "distribution": "truncated normal",
                "mean": "4 um",
                "deviation": "2 um",
                "low": "0 um",
                "high": "9 um",
            },
        },
        "positions": [1],
    },
}
"""Small studies of every kind."""
MEASURED = {"strain": {"position": 1, "share": {"6-10": 1.02, "7-10": 0.98}, "uncertainty": 0.01}}
COUNTS = {"samples", "steps", "starts", "indices"}


@dataclass(frozen=True, slots=True)
class Trial:
    """An input and its result.

    Attributes
    ----------
    kind : str
        Kind of input: a key of `KINDS`.
    seed, number : int
        Numbers by which it can be drawn again.
    words : tuple of str
        The command.
    code : int
        Exit code; −1 if an exception escaped.
    fault : str
        Description of the fault; empty without one.
    """

    kind: str
    seed: int
    number: int
    words: tuple[str, ...]
    code: int
    fault: str


def _command(words: tuple[str, ...]) -> tuple[int, str]:
    """Return exit code and output of a command in this process."""
    output = StringIO()
    try:
        with redirect_stdout(output), redirect_stderr(output):
            main(words)
    except SystemExit as left:
        code = left.code
    return (code if isinstance(code, int) else 0 if code is None else 1), output.getvalue()


def _judged(words: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """Return the exit code of a command, and its fault."""
    code, output = _command(words)
    if code not in (0, 1, 2):
        return code, f"left with {code}"
    if "Traceback" in output:
        return code, f"a traceback: {output.strip().splitlines()[-1]}"
    if code and not output.strip():
        return code, "left without a word"
    file = folder / "found.json"
    if code == 0 and file.exists():
        document = json.loads(file.read_text(encoding="utf-8"))
        if not all(math.isfinite(x) for x in _figures(document)):
            return code, "figures that are no numbers"
        if not ls.load_result(file).passed:
            return code, "a result that does not pass"
    return code, ""


def _figures(data: Any) -> Iterator[float]:
    if isinstance(data, dict | list):
        for item in data.values() if isinstance(data, dict) else data:
            yield from _figures(item)
    elif isinstance(data, float):
        yield data


@cache
def shipped_cases() -> list[tuple[Path, dict[str, Any]]]:
    """Return the shipped cases except the one with teeth, whose analysis may take long."""
    return [s for s in seeds(CASES) if s[0].parent.name != "pairs" and "geometry" not in s[0].name]


def _case(random: Random, folder: Path) -> tuple[str, ...]:
    """Write a case with some values changed."""
    file, data = pick(random, shipped_cases())
    (folder / "case.toml").write_text(toml(mutated(random, data)), encoding="utf-8")
    lay_beside(file, folder)
    return _solved(random, folder)


def _rescaled(random: Random, folder: Path) -> tuple[str, ...]:
    """Write a case with other numbers that one might mean."""
    file, data = pick(random, shipped_cases())
    (folder / "case.toml").write_text(toml(rescaled(random, data)), encoding="utf-8")
    lay_beside(file, folder)
    return _solved(random, folder)


def _study(random: Random, folder: Path) -> tuple[str, ...]:
    """Write studies with some values changed, and run one."""
    name = pick(random, tuple(STUDIES))
    made = (rescaled if random.integers(2) else mutated)(random, study_case(name))
    (folder / "case.toml").write_text(toml(shortened(made)), encoding="utf-8")
    lay_beside(CASES / "fgfbstts" / "limit_ring.toml", folder)
    return ("study", str(folder / "case.toml"), name)


def study_case(name: str) -> dict[str, Any]:
    """Return a case that contains a study."""
    study = {name: STUDIES[name]}
    return {"extends": "limit_ring.toml", "study": study, "measured": MEASURED}


def shortened(case: dict[str, Any]) -> dict[str, Any]:
    """Return a case without counts that may legitimately take hours: samples, steps."""
    for table in _tables_in(case):
        for key in COUNTS & set(table):
            if isinstance(table[key], int) and 20 < table[key] <= ALLOWED.samples:
                table[key] = 20
    return case


def _tables_in(data: Any) -> Iterator[dict[str, Any]]:
    if isinstance(data, dict):
        yield data
    for item in data.values() if isinstance(data, dict) else data:
        if isinstance(item, dict | list):
            yield from _tables_in(item)


def _bytes(random: Random, folder: Path) -> tuple[str, ...]:
    """Write a case with some bytes changed."""
    file, _ = pick(random, shipped_cases())
    (folder / "case.toml").write_bytes(garbled(random, file.read_bytes()))
    lay_beside(file, folder)
    return _solved(random, folder)


def lay_beside(file: Path, folder: Path) -> None:
    """Put the files that a case may extend next to it."""
    for known in file.parent.glob("*.toml"):
        shutil.copyfile(known, folder / known.name)


def _solved(random: Random, folder: Path) -> tuple[str, ...]:
    case = str(folder / "case.toml")
    if random.integers(4) == 0:
        return ("check", case)
    return ("run", case, "--position", "1", "-o", str(folder / "found.json"))


def _words(random: Random, folder: Path) -> tuple[str, ...]:
    """Run a command with invalid arguments on a valid case."""
    case = str(pick(random, shipped_cases())[0])
    value = f"{pick(random, NUMBERS)} {pick(random, UNITS)}"
    if random.integers(3) == 0:
        value = pick(random, NAMES)
    key = pick(random, SETTINGS)
    grid = f"{value}:{pick(random, NUMBERS)} {pick(random, UNITS)}:{pick(random, NUMBERS)}"
    which = (
        ("run", case, "--position", pick(random, NUMBERS)),
        ("run", case, "--position", "1", "--set", f"{key}={value}"),
        ("run", case, "--position", "1", "--set", f"{value}={key}"),
        ("run", case, "--position", "1", "--tolerance", pick(random, NUMBERS)),
        ("sweep", case, "--position", "1", "--over", f"{key}={grid}"),
        ("sweep", case, "--position", "1", "--over", f"rings.4.float={grid}"),
        ("critical", case, "--position", "1", "--over", f"{key}={value}:{pick(random, NUMBERS)}"),
        ("check", case, pick(random, NAMES)),
        ("run", pick(random, NAMES)),
        (pick(random, NAMES), case),
        ("schema", pick(random, NAMES)),
        ("sensitivity", case, key, "--position", "1", "--set", f"{key}={value}"),
        ("march", case, "--gear", pick(random, NAMES), "--revolutions", pick(random, NUMBERS)),
        ("march", case, "--steps", "2", "--revolutions", "0.1", "--set", f"{key}={value}"),
    )
    return tuple(str(word).replace("\x00", "") for word in pick(random, which))


def _pair(random: Random, folder: Path) -> tuple[str, ...]:
    """Write tooth data with some values changed."""
    _, data = pick(random, seeds(CASES / "fgfbstts" / "pairs"))
    (folder / "pair.toml").write_text(toml(mutated(random, data)), encoding="utf-8")
    return ("pair", str(folder / "pair.toml"))


def _rexs(random: Random, folder: Path) -> tuple[str, ...]:
    """Write a gear unit with values or bytes changed."""
    parts = pick(random, (units.planetary, units.two_stages))()
    file = folder / "unit.rexs"
    if random.integers(2):
        file.write_bytes(garbled(random, units.xml(*parts)))
    else:
        data = json.loads(units.rexsj(*parts, "2.0"))
        file.write_text(json.dumps(mutated(random, data)), encoding="utf-8")
    return ("import", str(file), "-o", str(folder / "case.toml"))


def _tables(random: Random, folder: Path) -> tuple[str, ...]:
    """Write the tables of a case with cells or bytes changed."""
    _, data = pick(random, plain_cases())
    box = folder / "box"
    box.mkdir()
    tables = {name: csv_of(frame) for name, frame in case_frames(data)}
    damaged = pick(random, tuple(tables))
    for name, text in tables.items():
        content = text.encode()
        if name == damaged and random.integers(2):
            content = garbled(random, content)
        elif name == damaged:
            cells = re.split("([,\n])", text)
            for _ in range(random.integers(1, 4)):
                cells[2 * random.integers(len(cells) // 2)] = pick(random, (*NUMBERS, *NAMES))
            content = "".join(cells).encode("utf-8", "surrogatepass")
        (box / f"{name}.csv").write_bytes(content)
    return ("import", str(box), "-o", str(folder / "case.toml"))


@cache
def plain_cases() -> list[tuple[Path, dict[str, Any]]]:
    """Return the shipped cases with all that they inherit."""
    return [(file, ls.load_case(file).to_dict()) for file, _ in shipped_cases()]


def _imported(words: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """Import tables; if they make a case, solve it."""
    code, wrong = _judged(words, folder)
    if code or wrong:
        return code, wrong
    found = str(folder / "found.json")
    return _judged(("run", words[-1], "--position", "1", "-o", found), folder)


def _exchanged(words: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """Import a unit; if it makes a case, solve it, export it and import it again."""
    code, wrong = _judged(words, folder)
    if code or wrong:
        return code, wrong
    unit, case, copy = words[1], words[-1], str(folder / "copy.rexs")
    code, wrong = _judged(("export", case, unit, "-o", copy), folder)
    if code or wrong:
        return code, wrong
    return _judged(("import", copy, "-o", str(folder / "again.toml")), folder)


def _read(words: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """Read tooth data: they make two bodies, or are refused by name."""
    try:
        load_pair(words[1])
    except ls.CaseError as error:
        return 2, "" if str(error).strip() else "refused without a word"
    return 0, ""


_RESULTS: list[dict[str, Any]] = []


def _result(random: Random, folder: Path) -> tuple[str, ...]:
    """Write a result with some values changed, and its digest recomputed."""
    from loadshare.results.digest import DIGEST, digest_of

    if not _RESULTS:
        for name in ("limit_ring", "all_elements", "spline_clearance"):
            found = ls.solve(CASES / "fgfbstts" / f"{name}.toml", positions=[1])
            _RESULTS.append(json.loads(found.to_json()))
    document = mutated(random, pick(random, _RESULTS))
    if random.integers(2):
        document[DIGEST] = digest_of(document)
    (folder / "result.json").write_text(json.dumps(document), encoding="utf-8")
    return ("result", str(folder / "result.json"))


def _loaded(words: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """Load a result: it passes, or is refused by name."""
    try:
        found = ls.load_result(words[1])
    except ls.ResultError as error:
        return 2, "" if str(error).strip() else "refused without a word"
    return 0, "" if found.passed else "a result that does not pass"


KINDS: dict[str, Callable[[Random, Path], tuple[str, ...]]] = {
    "case": _case,
    "numbers": _rescaled,
    "bytes": _bytes,
    "study": _study,
    "words": _words,
    "pair": _pair,
    "rexs": _rexs,
    "tables": _tables,
    "result": _result,
}
JUDGES = {"pair": _read, "rexs": _exchanged, "tables": _imported, "result": _loaded}
SHARES = (
    *(("case",) * 14 + ("numbers",) * 4 + ("bytes",) * 8 + ("words",) * 6 + ("study",) * 2),
    *(("pair",) * 4 + ("rexs",) * 2 + ("tables",) * 2 + ("result",) * 4),
)
"""Relative frequency of each kind: studies take ten times as long as all others."""


def compile_first() -> None:
    """Compile everything an input may need: this takes minutes, and must not count as a hang."""
    case = CASES / "fgfbstts" / "all_elements.toml"
    ls.solve_many(case, {"rings.4.float [um]": [1.0, 2.0]}, engine="compiled")


def drawn(seed: int, number: int, folder: Path) -> tuple[str, tuple[str, ...]]:
    """Draw an input, write its files into an empty folder, and return its kind and its command."""
    random = np.random.default_rng([seed, number])
    kind = pick(random, SHARES)
    return kind, KINDS[kind](random, folder)


def trial(seed: int, number: int, folder: Path) -> Trial:
    """Draw an input and try it.

    Parameters
    ----------
    seed, number : int
    folder : pathlib.Path
        An empty folder; the files stay there.
    """
    kind, words = drawn(seed, number, folder)
    return Trial(kind, seed, number, words, *tried(kind, words, folder))


def tried(kind: str, words: tuple[str, ...], folder: Path) -> tuple[int, str]:
    """Run an input; return its exit code and its fault."""
    try:
        with chdir(folder), limited(SECONDS), warnings.catch_warnings():
            warnings.simplefilter("error")
            return JUDGES.get(kind, _judged)(words, folder)
    except TooLong:
        return -1, f"takes longer than {SECONDS:.0f} s"
    except BaseException as error:  # noqa: BLE001 -- whatever escapes is what is looked for
        trace = error.__traceback__
        while trace is not None and trace.tb_next is not None:
            trace = trace.tb_next
        where = f"{trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}" if trace else ""
        return -1, f"{type(error).__name__}: {str(error)[:200]} ({where})"
