"""`loadshare batch`: no case stops the others, certified results are kept, files are complete."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import loadshare as ls
from loadshare.cli.batch import work as pool
from loadshare.cli.batch.work import engine_for, result_names
from loadshare.job import engines
from loadshare.lock import alone_in
from loadshare.settings import JOB
from loadshare.solver.hot import compiled, vectorised


@pytest.fixture
def star(cases):
    return cases / "star"


def summary(folder):
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def outcomes(folder):
    return {case["name"]: case["outcome"] for case in summary(folder)["cases"]}


def test_no_digit_of_a_result_hangs_on_what_its_process_has_solved_before(
    command, star, tmp_path, monkeypatch
):
    # Engines round differently, and a process that has loaded compiled code prefers it. Which cases
    # come before a given one depends on the number of processes and on interruptions.
    used = []

    def settle(*given, **more):
        used.append(given)
        return vectorised.settle(*given, **more)

    monkeypatch.setattr(engines, "loaded", lambda: True)
    monkeypatch.setattr(compiled, "settle", settle)
    ls.solve(star / "floating_sun_3.toml")
    assert used
    used.clear()
    assert command("batch", star, "-o", tmp_path, "-j", "1").exit_code == 0
    assert not used
    # Compiled code is used for a case with enough positions to be worth loading it, then for all.
    monkeypatch.setattr(engines, "is_available", lambda: True)
    case = ls.load_case(star / "floating_sun_3.toml").replace({"operating.positions": 10})
    assert engine_for(case, JOB.few // 10) == "vectorised"
    assert engine_for(case, JOB.few // 10 + 1) == "compiled"


def test_a_folder_of_cases_gives_a_result_each(command, star, tmp_path):
    out = tmp_path / "out"
    result = command("batch", star, "-o", out, "--jobs", "1")
    assert result.exit_code == 0
    assert "4 cases: 4 certified" in result.stdout
    files = {file.name for file in out.iterdir()}
    assert files == {f"floating_sun_{n}.json" for n in (3, 4, 5, 6)} | {"summary.json"}
    for case in summary(out)["cases"]:
        kept = ls.load_result(out / f"{case['name']}.json")
        assert kept == ls.solve(case["case"])
        assert case["omega"] == kept.omega["system"]
        assert case["worst"] == kept.certificate.worst
    assert summary(out)["passed"] is True
    assert summary(out)["counts"] == {"certified": 4}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device")
def test_a_result_that_cannot_be_written_is_reported_and_stops_no_other(command, star, tmp_path):
    (tmp_path / "out").mkdir()
    target = tmp_path / "out" / "floating_sun_4.json"
    target.symlink_to("/dev/full")
    result = command("batch", star, "-o", tmp_path / "out", "-j", "1")
    assert result.exit_code == 2
    assert f"{target}: cannot be written: No space left on device" in result.output
    found = outcomes(tmp_path / "out")
    assert found.pop("floating_sun_4") == "unwritten"
    assert set(found.values()) == {"certified"}
    target.unlink()
    again = command("batch", star, "-o", tmp_path / "out", "-j", "1")
    assert again.exit_code == 0
    assert outcomes(tmp_path / "out")["floating_sun_4"] == "certified"


def test_processes_give_the_same_results(process, command, star, tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    assert command("batch", star, "-o", one, "--jobs", "1").exit_code == 0
    done = process("batch", star, "-o", two, "--jobs", "2")
    assert (done.returncode, done.stderr) == (0, "")
    for file in one.glob("floating*.json"):
        assert file.read_bytes() == (two / file.name).read_bytes()


def test_failing_cases_do_not_stop_the_others(command, star, unheld, half_held, broken, tmp_path):
    out = tmp_path / "out"
    words = ("batch", unheld, broken, tmp_path / "none.toml", half_held, star, "-o", out, "-j", "1")
    result = command(*words)
    assert result.exit_code == 1
    found = outcomes(out)
    assert [found[n] for n in ("unheld", "broken", "none", "half_held")] == [
        *("refused", "invalid", "invalid", "refused")
    ]
    assert list(found.values()).count("certified") == 4
    assert result.stdout.count("broken: invalid: ") == 3
    assert "no such file" in result.stdout
    partial = json.loads((out / "half_held.json").read_text(encoding="utf-8"))
    assert [p["position"] for p in partial["positions"]] == [1]
    assert "refused" in partial
    assert not (out / "broken.json").exists()


def test_a_case_that_is_none_any_more_names_the_result_that_it_had(command, star, tmp_path):
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text((star / "floating_sun_3.toml").read_text(encoding="utf-8"), encoding="utf-8")
    command("batch", case, "-o", out, "--jobs", "1")
    before = (out / "case.json").read_bytes()
    case.write_text("nonsense = 1\n", encoding="utf-8")
    result = command("batch", case, "-o", out, "--jobs", "1")
    assert result.exit_code == 1
    assert "case.json: left by an earlier run, does not belong to the present case" in result.stdout
    assert (out / "case.json").read_bytes() == before


def test_a_bug_met_in_one_case_is_an_outcome(command, star, tmp_path, monkeypatch):
    solve = ls.solve

    def buggy(case, **options):
        if case.name == "floating_sun_4":
            raise ZeroDivisionError("a bug")
        return solve(case, **options)

    monkeypatch.setattr("loadshare.job.solve", buggy)
    result = command("batch", star, "-o", tmp_path, "--jobs", "1")
    assert result.exit_code == 1
    assert "floating_sun_4: crashed: ZeroDivisionError: a bug" in result.stdout
    assert list(outcomes(tmp_path).values()).count("certified") == 3


def test_what_is_certified_is_kept(command, star, tmp_path):
    words = ("batch", star, "-o", tmp_path, "--jobs", "1")
    command(*words)
    before = {f: f.stat().st_mtime_ns for f in tmp_path.glob("floating*")}
    result = command(*words)
    assert result.exit_code == 0
    assert set(outcomes(tmp_path).values()) == {"kept"}
    assert {f: f.stat().st_mtime_ns for f in tmp_path.glob("floating*")} == before


def test_a_result_says_what_its_case_says_now(command, star, tmp_path):
    """A title does not change the mechanics, but the result shows it."""
    case, out = tmp_path / "case.toml", tmp_path / "out"
    text = (star / "floating_sun_3.toml").read_text(encoding="utf-8")
    title = ls.load_case(star / "floating_sun_3.toml").title
    for shown in (title, "Another title"):
        case.write_text(text.replace(title, shown), encoding="utf-8")
        command("batch", case, "-o", out, "--jobs", "1")
        assert outcomes(out) == {"case": "certified"}
        assert ls.load_result(out / "case.json").case.title == shown


@pytest.mark.parametrize(
    "words", [("--force",), ("--solver", "osqp"), ("--method", "picard"), ("--tolerance", "1e-8")]
)
def test_another_question_is_answered_anew(command, star, tmp_path, words):
    case = star / "floating_sun_3.toml"
    command("batch", case, "-o", tmp_path, "--jobs", "1")
    command("batch", case, "-o", tmp_path, "--jobs", "1", *words)
    assert outcomes(tmp_path) == {"floating_sun_3": "certified"}


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text[: len(text) // 2],
        lambda text: "[]",
        lambda text: text.replace('"version": "', '"version": "0'),
        lambda text: json.dumps(json.loads(text) | {"positions": []}),
    ],
)
def test_a_file_that_is_not_the_answer_is_replaced(command, star, tmp_path, damage):
    case, file = star / "floating_sun_3.toml", tmp_path / "floating_sun_3.json"
    command("batch", case, "-o", tmp_path, "--jobs", "1")
    good = file.read_text(encoding="utf-8")
    file.write_text(damage(good), encoding="utf-8")
    command("batch", case, "-o", tmp_path, "--jobs", "1")
    assert outcomes(tmp_path) == {"floating_sun_3": "certified"}
    assert file.read_text(encoding="utf-8") == good


@pytest.mark.parametrize(
    ("doctor", "message"),
    [
        (lambda d: d["omega"].update(system=1.5), "omega.system = 1.5: does not follow"),
        (lambda d: d["positions"][0]["torque"].update({"sun-planet1": 1e3}), "positions[0].torque"),
        (
            lambda d: d["positions"][0]["claim"]["rotation"].update(sun=1e-3),
            "is not an equilibrium",
        ),
        (lambda d: d.update(positions=[]), "position 1 is missing"),
        (lambda d: d.update(format=1), "was written by loadshare"),
    ],
)
@pytest.mark.quick(2)
def test_a_doctored_file_is_not_kept_and_the_summary_says_why(
    command, star, tmp_path, doctor, message
):
    case, file = star / "floating_sun_3.toml", tmp_path / "floating_sun_3.json"
    command("batch", case, "-o", tmp_path, "--jobs", "1")
    good = file.read_text(encoding="utf-8")
    document = json.loads(good)
    doctor(document)
    file.write_text(json.dumps(document), encoding="utf-8")
    result = command("batch", case, "-o", tmp_path, "--jobs", "1")
    assert result.exit_code == 0
    (found,) = summary(tmp_path)["cases"]
    assert found["outcome"] == "certified"
    assert found["message"].startswith("the existing file was not kept: ")
    assert message in found["message"]
    assert "floating_sun_3: certified: the existing file was not kept" in result.stdout
    assert file.read_text(encoding="utf-8") == good


def test_a_changed_case_and_a_refused_one_are_tried_again(command, star, half_held, tmp_path):
    case = tmp_path / "case.toml"
    text = (star / "floating_sun_3.toml").read_text(encoding="utf-8")
    case.write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    command("batch", case, half_held, "-o", out, "--jobs", "1")
    case.write_text(text.replace("1000 N*m", "1100 N*m"), encoding="utf-8")
    command("batch", case, half_held, "-o", out, "--jobs", "1")
    assert outcomes(out) == {"case": "certified", "half_held": "refused"}
    assert not any("not kept" in case["message"] for case in summary(out)["cases"])


def test_a_batch_that_is_interrupted_before_its_first_case_has_no_table(
    command, star, tmp_path, monkeypatch
):
    def interrupted(task):
        raise KeyboardInterrupt

    monkeypatch.setattr(pool, "work", interrupted)
    result = command("batch", star, "-o", tmp_path, "--jobs", "1")
    assert (result.exit_code, result.stdout) == (130, "")
    assert "Interrupted: 0 of 4 cases done." in result.stderr


def test_an_interrupted_batch_leaves_whole_files_and_goes_on(command, star, tmp_path, monkeypatch):
    work, seen = pool.work, []

    def interrupted(task):
        seen.append(task.name)
        if len(seen) == 3:
            raise KeyboardInterrupt
        return work(task)

    words = ("batch", star, "-o", tmp_path, "--jobs", "1")
    with monkeypatch.context() as patch:
        patch.setattr(pool, "work", interrupted)
        result = command(*words)
    assert result.exit_code == 130
    assert "Interrupted: 2 of 4 cases done." in result.stderr
    assert len(summary(tmp_path)["not_done"]) == 2
    assert summary(tmp_path)["passed"] is False
    assert len(list(tmp_path.iterdir())) == 3
    assert command(*words).exit_code == 0
    assert sorted(outcomes(tmp_path).values()) == ["certified", "certified", "kept", "kept"]


GATED = """
import signal, sys, time
from pathlib import Path
from loadshare.cli.batch import work as pool
from loadshare.cli.batch.work import work

def gated(task):
    gate = task.target.parent.parent / "gate"
    while task.name != "floating_sun_3" and not gate.exists():
        time.sleep(0.01)
    return work(task)

if __name__ == "__main__":
    # Whoever runs the tests in the background has interrupts ignored, and children inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    pool.work = gated
    from loadshare.cli.main import main
    main()
"""
"""A batch whose first case is solved immediately, while the others wait for a file."""


def gated(script, words, environment):
    """Start such a batch in a session of its own."""
    return subprocess.Popen(
        [sys.executable, script, "batch", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        start_new_session=True,
    )


def await_first(out, batch):
    """Wait for the result of the first case."""
    while not (out / "floating_sun_3.json").exists():
        assert batch.poll() is None
        time.sleep(0.01)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_an_interrupt_from_the_keyboard_stops_a_batch_in_processes(cases, tmp_path, environment):
    """Cases in progress are finished, others left; all get the signal, as from a terminal."""
    out, script = tmp_path / "out", tmp_path / "script.py"
    script.write_text(GATED, encoding="utf-8")
    words = (cases / "star", cases / "two_path", "-o", out, "--jobs", "2")
    batch = gated(script, words, environment)
    # A batch that ignores the signal would wait for its gate, and the test for the batch.
    guard = threading.Timer(60.0, os.killpg, (batch.pid, signal.SIGKILL))
    guard.start()
    try:
        await_first(out, batch)
        os.killpg(batch.pid, signal.SIGINT)
        assert batch.stderr.readline().startswith("Stopping")
        (tmp_path / "gate").touch()
        _, stderr = batch.communicate()
    finally:
        guard.cancel()
    assert batch.returncode == 130
    assert "The same command continues" in stderr
    assert "Traceback" not in stderr
    # Each process has one case in progress, and one more may wait in the pipe between them.
    assert summary(out)["not_done"]
    assert set(outcomes(out).values()) <= {"certified"}
    for file in set(out.glob("*.json")) - {out / "summary.json"}:
        assert ls.load_result(file).passed
    assert not list(out.glob(".*"))


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize(
    ("sent", "code", "jobs"),
    [
        ((signal.SIGINT, signal.SIGINT), 130, "2"),
        ((signal.SIGTERM,), 143, "1"),
        pytest.param((signal.SIGINT, signal.SIGINT), 130, "1", marks=pytest.mark.slow),
        pytest.param((signal.SIGTERM,), 143, "2", marks=pytest.mark.slow),
    ],
)
@pytest.mark.quick(1)
def test_a_batch_ends_where_it_stands(cases, tmp_path, environment, sent, code, jobs):
    """The second Ctrl-C and SIGTERM abandon the cases in progress; kept results are reported."""
    out, script = tmp_path / "out", tmp_path / "script.py"
    script.write_text(GATED, encoding="utf-8")
    words = (cases / "star", "-o", out, "--jobs", jobs)
    batch = gated(script, words, environment)
    # The gate stays closed: a batch that waits for the case in progress never ends.
    guard = threading.Timer(120.0, os.killpg, (batch.pid, signal.SIGKILL))
    guard.start()
    try:
        await_first(out, batch)
        # The first signal does not affect workers; the second may kill them, which is not a crash
        # of a case.
        os.killpg(batch.pid, sent[0])
        if sent[0] == signal.SIGINT:
            assert batch.stderr.readline().startswith("Stopping")
            os.killpg(batch.pid, signal.SIGINT)
        # Workers hold the other end of this pipe: once it is read to its end, they have ended.
        _, stderr = batch.communicate()
    finally:
        guard.cancel()
    assert batch.returncode == code
    # The file of a case exists a moment before its process reports it.
    assert re.search(r"Interrupted: [01] of 4 cases done\.\nThe same command continues", stderr)
    assert "Traceback" not in stderr
    assert set(outcomes(out).items()) <= {("floating_sun_3", "certified")}
    assert len(summary(out)["not_done"]) + len(outcomes(out)) == 4
    assert sorted(file.name for file in out.iterdir()) == ["floating_sun_3.json", "summary.json"]


def test_a_second_batch_in_a_folder_does_nothing(command, star, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    with alone_in(out):
        there = sorted(out.iterdir())
        result = command("batch", star, "-o", out, "--jobs", "1")
        assert sorted(out.iterdir()) == there
    assert result.exit_code == 2
    assert f"in use by process {os.getpid()} on " in " ".join(result.stderr.split())


def test_what_a_killed_batch_left_is_removed(command, star, tmp_path):
    half, other = (tmp_path / f".{name}.json.0123456789abcdef" for name in ("floating_sun_3", "x"))
    half.write_text("{", encoding="utf-8")
    other.write_text("{", encoding="utf-8")
    command("batch", star, "-o", tmp_path, "--jobs", "1")
    assert not half.exists()
    assert other.exists()


@pytest.mark.slow
def test_a_process_that_dies_costs_only_its_own_case(star, tmp_path, environment):
    script = tmp_path / "script.py"
    script.write_text(
        """
import os
from loadshare.cli.batch import work as pool
from loadshare.cli.batch.work import work

def dying(task):
    if task.name == "floating_sun_5":
        os._exit(3)
    return work(task)

if __name__ == "__main__":
    pool.work = dying
    from loadshare.cli.main import main
    main()
""",
        encoding="utf-8",
    )
    out = tmp_path / "out"
    done = subprocess.run(
        [sys.executable, script, "batch", star, "-o", out, "--jobs", "2"],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    assert done.returncode == 1, done.stderr
    found = outcomes(out)
    assert found.pop("floating_sun_5") == "crashed"
    assert set(found.values()) <= {"certified", "kept"}
    assert len(found) == 3


def test_patterns_are_understood_where_the_shell_leaves_them(command, star, tmp_path):
    result = command("batch", star / "*_[34].toml", "-o", tmp_path, "--jobs", "1")
    assert result.exit_code == 0
    assert set(outcomes(tmp_path)) == {"floating_sun_3", "floating_sun_4"}


def test_a_case_named_twice_is_solved_once(command, star, tmp_path):
    words = (star / "floating_sun_3.toml", star / "../star/floating_sun_3.toml")
    command("batch", *words, "-o", tmp_path, "--jobs", "1")
    assert len(outcomes(tmp_path)) == 1


def test_no_case_is_wrong_usage(command, tmp_path):
    result = command("batch", tmp_path, "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert "No case found" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("cases", "names"),
    [
        (["a/x.toml", "b/y.toml"], ["x", "y"]),
        (["a/x.toml", "b/x.toml", "b/y.toml"], ["a/x", "b/x", "y"]),
        (["a/X.toml", "b/x.toml"], ["a/X", "b/x"]),
        (["x.toml", "b/x.toml"], ["x", "b/x"]),
        (["summary.toml"], ["summary_"]),
        (["x.toml", "x.txt"], ["x", "x_"]),
    ],
)
def test_names_of_results_are_unique(cases, names):
    assert result_names([Path(case) for case in cases]) == names


def test_no_result_leaves_the_folder(command, star, tmp_path, monkeypatch):
    """Not even that of a case whose path leads out of the folder in which the command runs."""
    for folder in ("here/b", "a"):
        (tmp_path / folder).mkdir(parents=True)
        shutil.copy(star / "floating_sun_3.toml", tmp_path / folder / "x.toml")
    monkeypatch.chdir(tmp_path / "here")
    command("batch", "../a/x.toml", "b/x.toml", "-o", "out", "--jobs", "1")
    assert outcomes(Path("out")) == {"a/x": "certified", "here/b/x": "certified"}
    assert all(Path("out") in file.parents for file in Path().rglob("*.json"))


def test_a_quiet_batch_names_the_cases_that_failed_and_no_others(command, star, tmp_path):
    bad = tmp_path / "bad.toml"
    bad.write_text("x =", encoding="utf-8")
    words = ("batch", star / "floating_sun_3.toml", bad, "-o", tmp_path / "out", "-j", "1", "-q")
    done = command(*words)
    assert (done.exit_code, done.stdout) == (1, "")
    said = f"bad: invalid: {bad}: is not valid TOML at end of document: invalid value.\n"
    assert done.stderr == said
    assert command(*words, "--json").stderr == ""


@pytest.mark.parametrize("kind", ['kind = "law"', ' "kind"="law"', '\ufeffkind = "helicoid"'])
def test_pairs_and_laws_in_a_folder_are_no_cases_however_they_say_so(command, tmp_path, kind):
    (tmp_path / "other.toml").write_text(kind, encoding="utf-8")
    assert "No case found" in command("check", tmp_path).stderr


def test_a_case_that_quotes_a_law_is_a_case(command, star, tmp_path):
    text = (star / "floating_sun_3.toml").read_text(encoding="utf-8")
    notes = 'notes = """\nkind = "law"\n"""\n'
    (tmp_path / "case.toml").write_text(notes + text.replace("notes =", "#"), encoding="utf-8")
    assert command("check", tmp_path).stdout == f"OK  {tmp_path / 'case.toml'}\n"
