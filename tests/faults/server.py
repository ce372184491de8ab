"""A process that has imported everything, and forks for every command that it runs.

A command in a process of its own takes seconds, most of them for imports; a fork takes some
milliseconds. Answers of the solver are kept from the undisturbed run: this harness tests files, and
other tests check that a sample has the same answer whoever solves it.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

SECONDS = 600
"""Seconds after which a command counts as hanging."""


@dataclass(frozen=True, slots=True)
class Ended:
    """The end of a command.

    Attributes
    ----------
    code : int
        Exit code; negative for the signal that killed it.
    out, err : str
        Its printed output.
    """

    code: int
    out: str
    err: str

    @property
    def output(self) -> str:
        """All printed output."""
        return self.out + self.err


class Server:
    """Runs commands of `loadshare`, each in a fork of one process.

    Parameters
    ----------
    folder : pathlib.Path
        Folder for the output of commands.
    environment : dict
        Further environment variables.
    *modules : str
        Further modules that it imports.
    """

    def __init__(self, folder: Path, environment: dict[str, str], *modules: str) -> None:
        self._folder = folder
        python = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "PYTHONUTF8": "1"}
        plain = {k: v for k, v in os.environ.items() if k not in ("FORCE_COLOR", "COLUMNS")}
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.faults.server", str(folder), *modules],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**plain, **python, "OPENBLAS_NUM_THREADS": "1", **environment},
        )

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def run(self, words: Sequence[str], *, fork: bool = True, apart: bool = False) -> Ended:
        """Run a command.

        Parameters
        ----------
        words : sequence of str
        fork : bool
            If not, its answers are kept for later commands.
        apart : bool
            Whether large work is left to its workers, which do not have the kept answers.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps([list(words), fork, apart]) + "\n")
        self._process.stdin.flush()
        code = json.loads(self._process.stdout.readline())
        out, err = ((self._folder / name).read_text(errors="replace") for name in ("out", "err"))
        return Ended(code, out, err)


def _serve(folder: Path, modules: Sequence[str]) -> None:
    """Read commands from standard input until it ends."""
    for module in ("loadshare.cli.main", *modules):
        import_module(module)
    _keep_answers()
    answers = os.fdopen(os.dup(1), "w")
    for line in sys.stdin:
        words, fork, apart = json.loads(line)
        if fork:
            child = os.fork()
            if not child:
                signal.alarm(SECONDS)
                _solve_here(not apart)
                os._exit(_run(words, folder))
            _, status = os.waitpid(child, 0)
            code = os.waitstatus_to_exitcode(status)
        else:
            _solve_here(True)
            code = _run(words, folder)
        answers.write(f"{code}\n")
        answers.flush()


def _run(words: Sequence[str], folder: Path) -> int:
    """Run a command with its output in files; return its exit code."""
    from loadshare.cli.main import main

    for number, name in ((1, "out"), (2, "err")):
        file = os.open(folder / name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, number)
        os.close(file)
    code = 1
    try:
        main(words)
    except SystemExit as left:
        code = left.code if isinstance(left.code, int) else int(left.code is not None)
    except BaseException:  # noqa: BLE001 -- as the interpreter does with any exception that escapes
        traceback.print_exc()
    with suppress(OSError):
        sys.stdout.flush()
        sys.stderr.flush()
    return code


def _keep_answers() -> None:
    """Cache solved answers for later commands."""
    import loadshare.job
    from loadshare.report import converter
    from loadshare.results import document, files, result
    from loadshare.study.tolerance import design, job, statistics, study, worst

    def case_key(case: Any, **how: Any) -> str:
        options = {name: value for name, value in how.items() if name != "progress"}
        return f"{case.name} {case.hash} {sorted(options.items())}"

    kept = _keeping(loadshare.job.solve, case_key)
    loadshare.job.solve = worst.solve = kept  # type: ignore[attr-defined]

    # A solved result is one object, which always writes the same document.
    converter.start = lambda: None
    converter.begin = _keeping(_drawn, lambda *given, **how: json.dumps([*given, how]))
    document.to_document = result.to_document = _keeping(document.to_document, id)
    files.read_document = _keeping(files.read_document, lambda text, file: (text, file))

    def samples_key(job: Any, values: Any) -> tuple[object, ...]:
        return job.hash, values.tobytes()

    def array_key(values: Any, *given: Any) -> tuple[object, ...]:
        return values.tobytes(), values.shape, repr(given)

    def inputs_key(case: Any, name: str) -> str:
        return f"{case.hash} {name} {case.study[name]!r}"

    job.Job.solve = _keeping(job.Job.solve, samples_key)  # type: ignore[method-assign]
    design.uniforms = _keeping(design.uniforms, lambda *given: repr(given))
    study.read_inputs = _keeping(study.read_inputs, inputs_key)
    # Statistics resample a thousand times.
    for module, names in ((study, ("summary", "shares")), (statistics, ("summary", "exceedance"))):
        for name in names:
            setattr(module, name, _keeping(getattr(module, name), array_key))


def _drawn(conversion: str, what: object, **how: Any) -> Future[str | bytes]:
    """Draw in another process: a fork of one that has drawn would wait for threads it lacks."""
    drawn = subprocess.run(
        [sys.executable, "-m", "tests.faults.drawing"],
        input=json.dumps([conversion, what, how]).encode(),
        stdout=subprocess.PIPE,
        check=True,
    ).stdout
    found: Future[str | bytes] = Future()
    found.set_result(drawn.decode() if conversion.endswith("svg") else drawn)
    return found


def _solve_here(here: bool) -> None:
    """Choose whether large studies are also solved in this process, which has the answers."""
    from loadshare.settings import TOLERANCE
    from loadshare.study.tolerance import study

    study.TOLERANCE = TOLERANCE._replace(small=sys.maxsize) if here else TOLERANCE


def _keeping(function: Callable[..., Any], key: Callable[..., Any]) -> Callable[..., Any]:
    known: dict[Any, Any] = {}

    def kept(*given: Any, **named: Any) -> Any:
        name = key(*given, **named)
        if name not in known:
            known[name] = function(*given, **named)
        return known[name]

    return kept


if __name__ == "__main__":
    _serve(Path(sys.argv[1]), sys.argv[2:])
