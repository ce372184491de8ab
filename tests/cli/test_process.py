"""The command as the user runs it: what it imports, and its output to a pipe."""

import re
import subprocess
import sys

import pytest
from tests.cli.conftest import CASES, START
from tests.explore.asking import ask

HEAVY = (
    *("numpy", "scipy", "pint", "numba", "clarabel", "osqp", "cvxpy", "skfem"),
    *("xarray", "pandas", "pyarrow", "distributed", "altair", "vl_convert", "loky"),
)


def imported(words, environment, *others):
    """Return the heavy packages that a command, and others after it, have imported at the end."""
    script = f"""
import sys
from loadshare.cli.main import main
try:
    for words in {[[str(word) for word in one] for one in (words, *others)]!r}:
        try:
            main(words)
        except SystemExit as end:
            assert not end.code
finally:
    print("IMPORTED", *[name for name in {HEAVY!r} if name in sys.modules])
"""
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=True,
        env=environment,
    )
    return set(done.stdout.splitlines()[-1].split()[1:])


@pytest.mark.parametrize(
    "words",
    [
        *(["--help"], ["run", "--help"], ["batch", "-h"], ["--version"]),
        *(["draw", "-h"], ["report", "-h"], ["sweep", "-h"], ["tolerance", "-h"], ["schema"]),
    ],
)
@pytest.mark.quick(2)
def test_the_help_imports_nothing_heavy(environment, words):
    assert imported(words, environment) == set()


def test_a_check_and_a_run_import_only_what_they_use(environment, cases):
    case = cases / "fgfbstts/limit_ring.toml"
    assert imported(["check", case], environment, ["run", case]) == {"numpy"}


@pytest.mark.slow
def test_a_drawing_solves_nothing(environment, cases, tmp_path):
    words = ["draw", cases / "fgfbstts/limit_ring.toml", "-o", tmp_path / "drawing.svg"]
    assert imported(words, environment) == {"numpy", "vl_convert"}


def test_a_pipe_gets_plain_text(process, cases):
    done = process("run", cases / "fgfbstts/base.toml", "--explain")
    assert (done.returncode, done.stderr) == (0, "")
    assert "\x1b" not in done.stdout
    assert "Ω stage" in done.stdout


def test_a_stream_that_knows_no_omega_goes_on(process, cases):
    settings = {"PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    done = process("run", cases / "fgfbstts/base.toml", **settings)
    assert done.returncode == 0
    assert "? stage" in done.stdout
    assert "PASSED" in done.stdout


@pytest.mark.parametrize(
    ("words", "code"),
    [(("run", "none.toml"), 2), (("run",), 2), ((), 2), (("--version",), 0)],
)
@pytest.mark.quick(2)
def test_exit_codes_reach_the_shell(process, words, code):
    done = process(*words)
    assert done.returncode == code
    assert "Traceback" not in done.stderr


BASE = CASES / "fgfbstts/base.toml"
CLOSED = {
    ("run", BASE, "-o", "{}/out.json"): 0,
    ("run", "{}/none.toml"): 2,
    ("batch", CASES / "star", "-o", "{}/out", "-j", "2"): 0,
    ("batch", BASE, "{}/none.toml", "-o", "{}/out", "-j", "1"): 1,
    ("run", BASE, "-o", "-"): {1: 2},
    ("run", BASE, "--json"): {1: 2},
    ("new", "drive", "-o", "-"): {1: 2},
}
"""Exit codes of commands whose output goes to stdout, when it is closed."""


@pytest.mark.skipif(sys.platform == "win32", reason="streams that are closed by a shell")
@pytest.mark.parametrize("closed", [(1,), (2,), (0, 1, 2)], ids=str)
@pytest.mark.parametrize(("words", "code"), CLOSED.items(), ids=str)
@pytest.mark.quick(3)
def test_streams_may_be_closed(environment, tmp_path, words, code, closed):
    """This happens with `2>&-`, in cron and in some services."""
    given = [str(word).replace("{}", str(tmp_path)) for word in words]
    redirections = "".join(f" {number}>&-" for number in closed)
    done = subprocess.run(
        ["sh", "-c", f'exec "$@"{redirections}', "sh", sys.executable, "-c", START, *given],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
        env=environment,
    )
    wanted = code if isinstance(code, int) else code[1] if 1 in closed else 0
    assert (done.returncode, "Traceback" in done.stderr) == (wanted, False)
    if isinstance(code, int):
        assert (tmp_path / "out.json").exists() == ("{}/out.json" in words)
    elif closed == (1,):
        assert "cannot be written: standard output is closed" in done.stderr
    elif closed == (2,):
        assert len(done.stdout) > 1000


def test_a_refusal_reaches_the_shell(process, half_held):
    done = process("run", half_held)
    assert done.returncode == 1
    assert "REFUSED  1 of 2 positions certified" in done.stdout
    assert done.stderr.startswith("REFUSED  position 2")


def test_a_bug_shows_a_plain_traceback(environment, cases):
    script = f"""
import loadshare.job
def buggy(*_, **__):
    raise ZeroDivisionError("a bug")
loadshare.job.solve = buggy
from loadshare.cli.main import main
main(["run", {str(cases / "fgfbstts/base.toml")!r}])
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 1
    assert done.stderr.startswith("Traceback")
    assert done.stderr.endswith("ZeroDivisionError: a bug\n")


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("code", [130, 143])
@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM"])
def test_a_signal_at_the_very_end_of_a_stopped_command_leaves_its_code(code, number):
    # Python restores signal handlers before it deletes the contents of modules.
    script = f"""
import os, signal, sys
from loadshare import __main__
from loadshare.cli import main
class Last:
    def __del__(self, kill=os.kill, own=os.getpid(), number=signal.{number}):
        kill(own, number)
kept = Last()
main.main = lambda: sys.exit({code})
__main__.main()
"""
    done = subprocess.run([sys.executable, "-c", script], check=False)
    assert done.returncode == code


INTERRUPTED = """
import sys
from loadshare.cli.stop import Stop

MET = "import os, signal, time; os.kill(os.getpid(), signal.SIGTERM); time.sleep(60)"
stop = Stop()
try:
    with stop:
{}
except KeyboardInterrupt:
    sys.exit(stop.code)
"""
MODULES = {
    "dataclasses": """
        exec(MET)
""",
    "a compiled module": """
        try:
            exec(MET)
        except KeyboardInterrupt as met:
            raise SystemError("a class returned a result with an exception set") from met
""",
    "what drops it": """
        try:
            exec(MET)
        except KeyboardInterrupt:
            pass
""",
}


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("loading", MODULES)
def test_a_command_that_is_stopped_while_it_loads_ends_with_its_code(
    tmp_path, environment, loading
):
    """Dataclasses use exec(): CPython would end the process by SIGINT after that.

    Compiled modules that are creating classes turn an interruption into an error of their own.
    """
    text = INTERRUPTED.format(MODULES[loading])
    (tmp_path / "interrupted.py").write_text(text, encoding="utf-8")
    words = [sys.executable, "-m", "interrupted"]
    assert subprocess.run(words, cwd=tmp_path, env=environment, check=False).returncode == 143


def test_what_is_interrupted_before_there_is_a_command_ends_in_silence(environment):
    script = """
import sys

class Interrupted:
    def find_spec(self, name, *_):
        if name == "loadshare.cli.main":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupted())
from loadshare.__main__ import main
main()
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False, env=environment
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_an_explorer_can_be_reached_at_once_and_stops_without_a_warning(environment, cases):
    """A browser may connect before the server has started, and nothing is lost when it stops."""
    case = str(cases / "star/floating_sun_3.toml")
    words = [sys.executable, "-c", START, "explore", case, "--no-browser"]
    with subprocess.Popen(
        words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        try:
            address = re.search(r"http://\S+", process.stdout.readline())[0]
            assert ask(address, "/case")[0] == 200
        finally:
            process.terminate()
        assert process.communicate()[1] == "Stopped.\n"
    assert process.returncode == 143
