"""Cases guided by coverage: ``python -m tests.fuzz.guided FOLDER -max_total_time=600``.

Atheris (libFuzzer) keeps in FOLDER each case that reaches new lines, and mutates those further.
Arguments that begin with ``-`` are libFuzzer's. Faults are printed, once of each kind, and kept in
`corpus`, where the tests try them again.

``make fuzz-guided`` installs Atheris, which has wheels for few systems, and runs this module.
"""

from __future__ import annotations

import shutil
import sys
import tomllib
from pathlib import Path
from tempfile import mkdtemp
from zlib import crc32

import atheris
import numpy as np
import tests.fuzz.instrumented  # noqa: F401 -- before all that imports what it counts
from tests.fuzz.corpus import keep
from tests.fuzz.mutations import garbled, mutated, rescaled, toml
from tests.fuzz.trial import (
    STUDIES,
    compile_first,
    lay_beside,
    shipped_cases,
    shortened,
    study_case,
    tried,
)

MOST = 30_000
"""Most bytes of a case."""


class Trials:
    """Cases given to the command one after the other.

    Parameters
    ----------
    folder : pathlib.Path
        An empty folder.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._faults = folder, set[str]()
        for file, _ in shipped_cases():
            lay_beside(file, folder)

    def one(self, text: bytes) -> None:
        """Try a case, or a study of it if it contains one."""
        (self._folder / "found.json").unlink(missing_ok=True)
        (self._folder / "case.toml").write_bytes(text)
        data = _read(text) or {}
        case, studies = str(self._folder / "case.toml"), data.get("study")
        words = ("run", case, "--position", "1", "-o", str(self._folder / "found.json"))
        if isinstance(studies, dict) and studies:
            (self._folder / "case.toml").write_text(toml(shortened(data)), encoding="utf-8")
            words = ("study", case, *list(studies)[:1])
        _, fault = tried("case", words, self._folder)
        if fault and fault not in self._faults:
            self._faults.add(fault)
            kept = keep(f"guided-{crc32(fault.encode()):08x}", "case", words, self._folder)
            sys.stdout.write(f"{fault}\n    {kept}\n")


def _read(text: bytes) -> dict[str, object] | None:
    try:
        return tomllib.loads(text.decode())
    except (ValueError, RecursionError):
        return None


def changed(text: bytes, most: int, seed: int) -> bytes:
    """Return another case: with values changed if the text is a case."""
    random = np.random.default_rng(seed)
    data = _read(text)
    if not data or random.integers(8) == 0:
        return garbled(random, text)[:most]
    try:
        made = toml((rescaled if random.integers(4) == 0 else mutated)(random, data))
    except (ValueError, TypeError, RecursionError):
        # No number to rescale, or a value that TOML has but JSON does not.
        return garbled(random, text)[:most]
    return made.encode()[:most]


def _lay_seeds(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for number, (file, _) in enumerate(shipped_cases()):
        shutil.copyfile(file, folder / f"shipped-{number}")
    for name in STUDIES:
        (folder / f"study-{name}").write_text(toml(study_case(name)), encoding="utf-8")


def _run() -> None:
    compile_first()
    folder = Path(mkdtemp())
    _lay_seeds(Path(next(word for word in sys.argv[1:] if not word.startswith("-"))))
    trials = Trials(folder)
    own = (f"-max_len={MOST}", "-cross_over=0", "-len_control=0", "-rss_limit_mb=2048")
    atheris.Setup([*sys.argv, *own], trials.one, custom_mutator=changed)
    try:
        atheris.Fuzz()
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    _run()
