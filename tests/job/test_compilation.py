"""Compiled code is an advantage, never a condition: any fault of it costs time only."""

import importlib.util
import itertools
import logging
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numba.core.caching import IndexDataCacheFile
from tests.support import CASES, mostly_slow, shipped

import loadshare as ls
from loadshare import compilation, compile_watch
from loadshare.code_cache import _Files, fingerprint
from loadshare.compile_watch import Watch, watch
from loadshare.job import engines
from loadshare.job.engines import available_engine, engine_named
from loadshare.job.machine import Machine
from loadshare.job.warm import warm
from loadshare.lock import one_after_another
from loadshare.settings import JOB
from loadshare.solver.hot import vectorised
from loadshare.train import build_train

KINDS = ("base", "limit_ring", "spline_clearance", "load")
PACKAGE = Path(ls.__file__).parent
CASE = CASES / "fgfbstts" / "limit_ring.toml"
FLOATS = np.linspace(0.0, 12.0, 9)
SOLVE = f"""
import numpy as np, loadshare as ls
floats = {{f"rings.{{g}}.float [um]": np.linspace(0.0, 12.0, 9) for g in "45"}}
found = ls.solve_many({str(CASE)!r}, floats, positions=[1], engine="compiled")
print(found["torque"].values.ravel().tolist())
"""


@pytest.fixture(autouse=True)
def fresh(monkeypatch):
    monkeypatch.setattr(compilation, "usable", compilation.Usable())


@pytest.fixture(scope="module")
def torques() -> list[float]:
    floats = {f"rings.{g}.float [um]": FLOATS for g in "45"}
    found = ls.solve_many(CASE, floats, positions=[1], engine="vectorised")
    return found["torque"].values.ravel().tolist()


# --- Nothing can be kept, or nothing can be compiled ---


def run(script: str, command: tuple[str, ...] = (), **environment: str):
    """Run a script in its own process; return its output and its messages."""
    done = subprocess.run(
        [*command, sys.executable, "-c", script],
        env={**os.environ, **environment},
        text=True,
        capture_output=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return eval(done.stdout), done.stderr


def as_a_user() -> tuple[str, ...]:
    """Return a command prefix that makes root obey write permissions."""
    if os.geteuid() != 0:
        return ()
    if shutil.which("setpriv") is None:
        pytest.skip("root may write everywhere, and there is no setpriv to take that away")
    return ("setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-all")


@pytest.fixture
def read_only(tmp_path: Path):
    """Put the package and a home into folders that cannot be written."""
    package, home = tmp_path / "package", tmp_path / "home"
    # Bytecode is copied as well, but not files that another process is writing.
    ignored = shutil.ignore_patterns("*.nb?*", "*.lock", "*.pyc.*")
    shutil.copytree(PACKAGE, package / "loadshare", ignore=ignored)
    home.mkdir()
    folders = [home, package, *(p for p in package.rglob("*") if p.is_dir())]
    for folder in folders:
        folder.chmod(0o555)
    yield {"PYTHONPATH": str(package), "HOME": str(home), "XDG_CACHE_HOME": str(home / "cache")}
    for folder in folders:
        folder.chmod(0o755)


@pytest.mark.parametrize(
    "named", mostly_slow((False, True), (True,)), ids=["no folder", "an unwritable NUMBA_CACHE_DIR"]
)
def test_with_nowhere_to_write_the_vectorised_kernel_answers(read_only, torques, named):
    environment = {**read_only, "NUMBA_CACHE_DIR": read_only["HOME"] if named else ""}
    found, output = run(SOLVE, as_a_user(), **environment)
    assert found == torques
    assert output.count("The compiled kernel is not used") == 1
    assert "set NUMBA_CACHE_DIR to one that can be written" in output
    assert "Traceback" not in output


@pytest.mark.parametrize(
    "spoil",
    [
        "import sys; sys.modules['numba'] = None",
        pytest.param("import numba; numba.njit = None", marks=pytest.mark.slow),
    ],
    ids=["no numba", "another numba"],
)
def test_without_a_usable_numba_the_vectorised_kernel_answers(torques, spoil):
    found, output = run(spoil + SOLVE)
    assert found == torques
    assert output.count("The compiled kernel is not used: Numba cannot be used") == 1


def test_without_numba_the_contact_programme_runs_as_it_is_written():
    script = """
import sys; sys.modules["numba"] = None
from loadshare.tooth.contact.compiled import settle
print(type(settle).__name__ == "function")
"""
    assert run(script)[0]


def situations(machine: Machine):
    return machine.situations([1])


def test_a_kernel_that_does_not_compile_is_replaced(caplog):
    from numba import njit

    @njit
    def broken(x):  # type: ignore[no-untyped-def]
        return x.no_such_thing

    def engine(*_: object, **__: object):
        return broken(1.0)

    machine = Machine(build_train(shipped("fgfbstts/base")))
    with caplog.at_level(logging.WARNING, logger="loadshare"):
        found = machine.answer(situations(machine), 1e-9, engine)
    wanted = machine.answer(situations(machine), 1e-9, vectorised.settle)
    np.testing.assert_array_equal(found.equilibria.flank_force, wanted.equilibria.flank_force)
    assert found.passed.all()
    messages = [r.message for r in caplog.records if not r.message.startswith("Compiling:")]
    assert [words.count("it does not compile (TypingError") for words in messages] == [1]
    assert engine_named("compiled", 10**6) is vectorised.settle


def test_other_errors_are_not_taken_for_the_compilers():
    def engine(*_: object, **__: object):
        raise ZeroDivisionError("a mistake of ours")

    machine = Machine(build_train(shipped("fgfbstts/base")))
    with pytest.raises(ZeroDivisionError):
        machine.answer(situations(machine), 1e-9, engine)
    assert compilation.why_not() is None


# --- What is kept may be damaged ---

MODULE = """
from loadshare.compilation import jit

@jit(nogil=True)
def twice(x):
    return 2.0 * x
"""
_number = itertools.count()


def loaded(file: Path):
    """Return the function of a module file, as a new process would see it."""
    spec = importlib.util.spec_from_file_location(f"kept_{next(_number)}", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.twice


def halved(data: bytes) -> bytes:
    return data[: len(data) // 2]


def flipped(data: bytes) -> bytes:
    at = len(data) // 2
    return data[:at] + bytes([data[at] ^ 0xFF]) + data[at + 1 :]


DAMAGES = {
    "empty": lambda data: b"",
    "halved": halved,
    "one byte": flipped,
    "rubbish": lambda data: b"\x80\x05rubbish" * 50,
}


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_what_was_kept_and_is_damaged_is_compiled_again(tmp_path, monkeypatch, ending, damage):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    assert loaded(file)(2.0) == 4.0
    again = loaded(file)
    assert again(2.0) == 4.0
    assert sum(again.stats.cache_hits.values()) == 1
    kept = list((tmp_path / "__pycache__").glob(f"*.{ending}"))
    assert len(kept) == 1
    kept[0].write_bytes(DAMAGES[damage](kept[0].read_bytes()))
    replaced = loaded(file)
    assert replaced(2.0) == 4.0
    assert sum(replaced.stats.cache_hits.values()) == 0
    mended = loaded(file)
    assert mended(2.0) == 4.0
    assert sum(mended.stats.cache_hits.values()) == 1


def test_code_of_an_older_version_is_not_run_where_the_new_could_not_be_kept(tmp_path, monkeypatch):
    """The index is written before the code: a full disk, or a kill in between, leaves it alone."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    assert loaded(file)(2.0) == 4.0
    file.write_text(MODULE.replace("2.0 * x", "3.0 * x  # now"), encoding="utf-8")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(_Files, "_save_data", full)
        assert loaded(file)(2.0) == 6.0
    assert not compilation.is_available(loaded(file))
    assert loaded(file)(2.0) == 6.0
    assert compilation.is_available(loaded(file))


def test_of_processes_that_miss_the_same_code_one_compiles_it(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    (tmp_path / "kept.py").write_text(MODULE, encoding="utf-8")
    go = tmp_path / "go"
    script = f"""
import sys, time; sys.path.insert(0, {str(tmp_path)!r})
from pathlib import Path
from kept import twice
print("ready", flush=True)
while not Path({str(go)!r}).exists(): time.sleep(1e-3)
assert twice(2.0) == 4.0
print(sum(twice.stats.cache_misses.values()))
"""
    words = [sys.executable, "-c", script]
    both = [subprocess.Popen(words, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    assert [process.stdout.readline() for process in both] == ["ready\n"] * 2
    go.touch()
    assert sorted(int(process.communicate(timeout=60)[0]) for process in both) == [0, 1]
    assert not list((tmp_path / "__pycache__").glob("*.lock"))


def test_what_another_process_has_just_compiled_is_not_compiled_again(tmp_path, monkeypatch):
    """It may end between the look for kept code and the lock."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    twice, other = loaded(file), loaded(file)

    def late(*words: Any) -> Any:
        with monkeypatch.context() as patch:
            patch.setattr("loadshare.code_cache.one_after_another", one_after_another)
            assert other(2.0) == 4.0
        return one_after_another(*words)

    monkeypatch.setattr("loadshare.code_cache.one_after_another", late)
    assert twice(2.0) == 4.0
    assert other.stats.cache_misses
    assert not twice.stats.cache_misses


def test_what_another_process_compiles_is_waited_for(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    twice = loaded(file)
    (tmp_path / "__pycache__").mkdir(exist_ok=True)
    index = Path(twice._cache._cache_file._index_path)
    waits, waiting = threading.Event(), watch.waiting
    monkeypatch.setattr(watch, "waiting", lambda: (waits.set(), waiting())[1])
    thread = threading.Thread(target=twice, args=(2.0,))
    with one_after_another(index.with_suffix(".lock")):
        thread.start()
        assert waits.wait(10.0)
        assert not twice.overloads
    thread.join(60.0)
    assert twice.overloads
    assert twice(3.0) == 6.0


def test_what_cannot_be_written_any_more_is_reported_once(tmp_path, monkeypatch, caplog):
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    twice = loaded(file)
    monkeypatch.setattr(watch, "complained", False)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(IndexDataCacheFile, "save", full)
    with caplog.at_level(logging.WARNING, logger="loadshare"):
        assert (twice(2.0), twice(2)) == (4.0, 4.0)
    messages = [r.message for r in caplog.records if "could not be kept" in r.message]
    assert len(messages) == 1
    assert "No space left on device" in messages[0]


# --- What is at hand ---


def test_available_is_what_was_compiled_or_kept(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    first = loaded(file)
    assert not compilation.is_available(first)
    assert first(2.0) == 4.0
    assert compilation.is_available(first)
    again = loaded(file)
    assert compilation.is_available(again)
    assert again(2.0) == 4.0
    assert not again.stats.cache_misses
    compilation.give_up("of a test")
    assert not compilation.is_available(again)


KEPT = """
from loadshare.certify.bound.kernel.bounds import _bound_all
from loadshare.certify.bound.kernel.claims import _find_all
from loadshare.code_cache import fingerprint
from loadshare.solver.hot.compiled import _settle_all
found = hash("one"), [fingerprint(f.py_func) for f in (_settle_all, _find_all, _bound_all)]
"""


def test_code_is_known_again_in_another_process():
    """This holds for any hashing of strings, and if warnings are errors."""
    names: dict[str, Any] = {}
    exec(KEPT, names)
    strict = "import warnings; warnings.simplefilter('error')"
    seed = "2" if os.environ.get("PYTHONHASHSEED") == "1" else "1"
    hashed, kept = run(f"{strict}{KEPT}print(found)", PYTHONHASHSEED=seed)[0]
    assert hashed != names["found"][0]
    assert kept == names["found"][1]


def test_a_function_within_another_counts_for_the_code_that_is_kept():
    source = "def outer(x):\n    return [inner + {} for inner in x] if x else (lambda: {})()\n"
    found = set()
    for numbers in ((1, 2), (3, 2), (1, 4)):
        names: dict[str, Any] = {}
        exec(source.format(*numbers), names)
        found.add(fingerprint(names["outer"]))
    assert len(found) == 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("imported", "most"),
    [("from numbers_of import N", "N.most"), ("import numbers_of as of", "of.MOST")],
    ids=["of a table", "of a module"],
)
def test_numbers_of_another_file_that_change_are_compiled_anew(
    tmp_path, monkeypatch, imported, most
):
    """Numba itself checks only the function's own file."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))
    (tmp_path / "numbers_of.py").write_text(
        "from typing import NamedTuple\nclass N(NamedTuple):\n    most: float = 1.0\nN = N()\n"
        "MOST = 1.0\n"
    )
    (tmp_path / "called_by.py").write_text(
        f"from loadshare.compilation import jit\n{imported}\n"
        "@jit()\ndef outer(x):\n    return inner(x)\n"
        f"@jit()\ndef inner(x):\n    return x > {most}\n"
    )
    script = f"""
import sys; sys.path.insert(0, {str(tmp_path)!r})
import called_by
from loadshare.compilation import is_available
print((is_available(called_by.outer), called_by.outer(2.0)))
"""
    assert run(script)[0] == (False, True)
    assert run(script)[0] == (True, True)
    numbers = tmp_path / "numbers_of.py"
    numbers.write_text(numbers.read_text().replace("1.0", "9.0"))
    assert run(script)[0] == (False, False)


def test_what_is_damaged_is_not_available(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    assert loaded(file)(2.0) == 4.0
    (kept,) = (tmp_path / "__pycache__").glob("*.nbc")
    kept.write_bytes(flipped(kept.read_bytes()))
    assert not compilation.is_available(loaded(file))


def test_case_by_case_nothing_is_loaded_before_it_is_worth_while_nor_compiled(monkeypatch):
    from loadshare.solver.hot import compiled

    needed: list[int] = []
    monkeypatch.setattr(engines, "tally", engines.Tally())
    monkeypatch.setattr(
        compilation, "is_available", lambda *functions: needed.append(len(functions))
    )
    assert available_engine("auto", JOB.few) is vectorised.settle
    assert not needed
    assert available_engine("auto", 1) is vectorised.settle
    assert needed == [len(engines.KERNELS)]
    monkeypatch.setattr(compilation, "is_available", lambda *_: True)
    assert available_engine("auto", 1) is compiled.settle
    assert available_engine("vectorised", 1) is vectorised.settle


@pytest.mark.parametrize(
    ("count", "kept", "engine"),
    [
        (JOB.few, True, "vectorised"),
        (JOB.few + 1, True, "compiled"),
        (JOB.compiling, False, "vectorised"),
        (JOB.compiling + 1, False, "compiled"),
    ],
)
def test_a_batch_takes_the_engine_that_is_done_first(monkeypatch, count, kept, engine):
    monkeypatch.setattr(compilation, "is_available", lambda *_: kept)
    assert engines.chosen(count) == engine


def test_what_is_loaded_is_used_for_the_smallest_batch():
    script = f"""
import loadshare as ls
from loadshare.job import engines
from loadshare.solver.hot import compiled, vectorised
found = [engines.loaded(), engines.engine_named("auto", 1) is vectorised.settle]
ls.solve({str(CASE)!r}, engine="compiled", positions=[1])
for engine in (engines.engine_named, engines.available_engine):
    found.append(engine("auto", 1) is compiled.settle)
print([*found, engines.loaded(), engines.chosen(1) == "vectorised"])
"""
    assert run(script)[0] == [False, True, True, True, True, True]


def test_what_another_thread_imports_is_not_loaded_yet(monkeypatch):
    name, _ = engines.KERNELS[0]
    monkeypatch.setitem(sys.modules, name, ModuleType(name))
    assert not engines.loaded()


def test_what_is_warm_is_at_hand():
    """The kernels of one case are those of all."""
    assert warm() is None
    assert engines.is_available()


@pytest.mark.slow
def test_what_is_warm_is_all_that_batches_call():
    """A process that finds it on disk compiles nothing else, whatever the elements."""
    assert warm() is None
    script = f"""
import loadshare as ls
from numba.core import event
with event.install_recorder("numba:compile") as compiled:
    for name in {KINDS!r}:
        case = ls.load_case({str(CASES)!r} + f"/fgfbstts/{{name}}.toml")
        key = "torque [N*m]" if case.operating.power is None else "power [W]"
        ls.solve_many(case, {{"operating." + key: [2e4, 1e4, 5e3]}}, engine="compiled")
print([str(e.data["dispatcher"]) for _, e in compiled.buffer])
"""
    assert run(script)[0] == []


@pytest.mark.slow
def test_what_is_at_hand_is_all_that_cases_call():
    """A process that finds on disk what this one compiled compiles nothing else."""
    for name in KINDS:
        ls.solve(CASES / "fgfbstts" / f"{name}.toml", engine="compiled")
    script = f"""
import loadshare as ls
from loadshare.job import engines
from loadshare.solver.hot import compiled as engine
from numba.core import event
engines.tally.equilibria = {JOB.few}
assert engines.available_engine("auto", 1) is engine.settle
with event.install_recorder("numba:compile") as compiled:
    for name in {KINDS!r}:
        ls.solve({str(CASES)!r} + f"/fgfbstts/{{name}}.toml")
print([str(e.data["dispatcher"]) for _, e in compiled.buffer])
"""
    assert run(script)[0] == []


# --- Compiling is reported ---


@pytest.fixture
def nothing_compiles():
    """Wait until reports on earlier compilations are finished."""
    watch.wait(60.0)


@pytest.mark.usefixtures("nothing_compiles")
def test_compiling_is_reported_while_it_lasts(monkeypatch, caplog):
    monkeypatch.setattr(compile_watch, "PATIENCE", 0.05)
    monkeypatch.setattr(compile_watch, "AGAIN", 0.1)
    mine = Watch()
    with caplog.at_level(logging.WARNING, logger="loadshare"):
        mine.started()
        mine.started()
        time.sleep(0.5)
        mine.ended()
        mine.ended()
        mine.wait(10.0)
    messages = [r.message for r in caplog.records]
    assert messages[0].startswith("Compiling: the first use of this version here")
    assert any(m.endswith("s so far") for m in messages[1:-1])
    assert messages[-1].startswith("Compiling: done after")


@pytest.mark.usefixtures("nothing_compiles")
def test_what_takes_no_time_is_not_reported(monkeypatch, caplog):
    monkeypatch.setattr(compile_watch, "PATIENCE", 0.2)
    mine = Watch()
    with caplog.at_level(logging.WARNING, logger="loadshare"):
        mine.started()
        mine.ended()
        mine.wait(10.0)
    assert caplog.records == []


def test_numba_tells_the_watch(tmp_path, monkeypatch):
    file = tmp_path / "kept.py"
    file.write_text(MODULE, encoding="utf-8")
    twice = loaded(file)
    calls: list[str] = []
    monkeypatch.setattr(watch, "started", lambda: calls.append("started"))
    monkeypatch.setattr(watch, "ended", lambda: calls.append("ended"))
    assert twice(2.0) == 4.0
    assert calls == ["started", "ended"]
    assert twice(3.0) == 6.0
    assert len(calls) == 2
