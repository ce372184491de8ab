"""Runs: bit-identical whoever solves them, resumed after a kill, with no loss."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from contextlib import suppress
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from tests.support import CASES, mostly_slow, shipped

import loadshare as ls
from loadshare.lock import alone_in
from loadshare.results.digest import DIGEST, digest_of
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance import local, study
from loadshare.study.tolerance.folder import PART_DIGEST, digest

PATHS = "two_path/clocking_error"
INPUTS = {
    f'shafts."wheel{path}-pinion{path}".clocking': {
        "distribution": "normal",
        "mean": "0 mrad",
        "deviation": "1 mrad",
    }
    for path in "AB"
}
BLOCKS = 5
SETTINGS = {
    "samples": BLOCKS * 4096 - 96,
    "indices": 0,
    "seed": 3,
    "worst": False,
    "engine": "vectorised",
    "quantiles": [0.5],
}


@pytest.fixture
def processes(monkeypatch):
    """Use worker processes: studies as small as these would be solved in this one."""
    monkeypatch.setattr(study, "TOLERANCE", TOLERANCE._replace(small=0))


def run(out: Path, **settings):
    return ls.tolerance(shipped(PATHS), INPUTS, out=out, **{**SETTINGS, **settings})


def bits(out: Path) -> dict[str, bytes]:
    """Return every column of all parts as bytes."""
    files = sorted(out.glob("part-*.parquet"))
    whole = pa.concat_tables(parquet.read_table(f).replace_schema_metadata() for f in files)
    return {
        name: column.combine_chunks().dictionary_encode().indices.to_numpy(False).tobytes()
        if name == "message"
        else column.to_numpy().tobytes()
        for name, column in zip(whole.column_names, whole.columns, strict=True)
    }


@pytest.fixture(scope="module")
def reference(tmp_path_factory) -> Path:
    """Run in this process, one block at a time."""
    out = tmp_path_factory.mktemp("reference") / "study"
    run(out, chunk=1)
    return out


@pytest.mark.slow
def test_worker_processes_change_no_bit(reference, tmp_path, processes):
    reported = []
    found = run(tmp_path / "study", workers=2, chunk=2, progress=lambda *d: reported.append(d))
    assert len(found.parts) == -(-BLOCKS // 2)
    assert reported[0] == (0, found.samples)
    assert reported[-1] == (found.samples, found.samples)
    assert bits(tmp_path / "study") == bits(reference)


def test_one_part_for_all_changes_no_bit(reference, tmp_path):
    assert len(run(tmp_path / "study", chunk=7).parts) == 1
    assert bits(tmp_path / "study") == bits(reference)


SCRIPT = """
import sys
import loadshare as ls
from loadshare.study.tolerance import study
study.TOLERANCE = study.TOLERANCE._replace(small=0)
ls.tolerance(
    ls.load_case({case!r}), {inputs!r}, out={out!r}, workers=2, **{options!r}
)
"""


def text_of(out: Path, options: dict) -> str:
    return SCRIPT.format(
        case=str(CASES / f"{PATHS}.toml"), inputs=INPUTS, out=str(out), options=options
    )


def environment(**more: str) -> dict[str, str]:
    """Return the environment of a process that finds the same modules."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **more}


def script(out: Path) -> subprocess.Popen:
    text = text_of(out, {**SETTINGS, "chunk": 1})
    return subprocess.Popen([sys.executable, "-c", text], env=environment(), stderr=subprocess.PIPE)


def test_killed_and_resumed(reference, tmp_path):
    """SIGKILL arrives while parts are being solved: complete parts are kept as they are."""
    out = tmp_path / "study"
    process = script(out)
    try:
        until(lambda: len(list(out.glob("part-*.parquet"))) >= 2, process)
    finally:
        process.send_signal(signal.SIGKILL)
        # Workers end when their study is gone. The last of them closes the other end of this pipe.
        assert b"Traceback" not in process.stderr.read()
        process.stderr.close()
        process.wait()
    kept = {file: file.stat().st_mtime_ns for file in out.glob("part-*.parquet")}
    assert 2 <= len(kept) < BLOCKS
    # A kill in the middle of writing leaves this.
    (out / ".part-000004.parquet.0123456789abcdef").write_bytes(b"PAR1 half")
    found = run(out, chunk=1)
    assert {file: file.stat().st_mtime_ns for file in kept} == kept
    assert found.samples == SETTINGS["samples"]
    assert bits(out) == bits(reference)
    assert sorted(p.name for p in out.iterdir()) == [
        *(f"part-{k:06d}.parquet" for k in range(BLOCKS)),
        "study.json",
    ]


def until(reached, process: subprocess.Popen | None = None, limit: float = 60.0) -> None:
    end = time.monotonic() + limit
    while not reached():
        assert time.monotonic() < end, "waited too long"
        assert process is None or process.poll() is None, "the study ended too soon"
        time.sleep(0.002)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="ru_maxrss is in KiB on Linux only")
def test_memory_does_not_grow_with_the_samples(tmp_path):
    """With six times the samples, a worker still holds one part at a time, the study some columns.

    Each further part in memory would be 3 MB or more. Allocators keep some MB. A column of the
    study takes 8 bytes per sample; fifteen at once are allowed.
    """
    tail = "import json, resource as r\nprint(json.dumps([r.getrusage(w).ru_maxrss for w in {}]))"
    peaks = []
    for parts in (4, 24):
        options = {**SETTINGS, "samples": parts * 8 * 4096, "chunk": 8}
        text = text_of(tmp_path / f"{parts}", options) + tail.format(
            "(r.RUSAGE_SELF, r.RUSAGE_CHILDREN)"
        )
        done = subprocess.run(
            [sys.executable, "-c", text], env=environment(), capture_output=True, check=True
        )
        peaks.append(json.loads(done.stdout))
    (study_few, worker_few), (study_many, worker_many) = peaks
    assert worker_many - worker_few < 20 * 1024
    assert study_many - study_few < 20 * 8 * 4096 * 120 / 1024 + 20 * 1024


def test_a_damaged_part_is_solved_again(reference, tmp_path):
    out = tmp_path / "study"
    run(out, chunk=3)
    whole = bits(out)
    first, second = sorted(out.glob("part-*.parquet"))
    first.write_bytes(first.read_bytes()[:-200])
    # A part of another study, or with another number, under this one's name.
    second.unlink()
    parquet.write_table(parquet.read_table(sorted(reference.glob("*.parquet"))[0]), second)
    found = run(out, chunk=3)
    assert bits(out) == whole == bits(reference)
    assert found.samples == SETTINGS["samples"]


@pytest.mark.parametrize(
    ("column", "change"),
    [
        ("omega.system", lambda v: 1.5 * v),
        pytest.param(
            "torque.pinionA-out [N*m]", lambda v: v + 1e-3 * v.max(), marks=pytest.mark.slow
        ),
        pytest.param("omega.I", lambda v: np.full_like(v, np.nan), marks=pytest.mark.slow),
        pytest.param("certified", lambda v: ~v, marks=pytest.mark.slow),
        ("sample", lambda v: v[::-1].copy()),
        (None, lambda v: np.nextafter(v, 9.0)),
    ],
)
@pytest.mark.quick(1)
def test_a_doctored_part_is_refused_by_name(reference, tmp_path, column, change, caplog):
    """With a recomputed digest, its samples are solved again; without, all of the part is."""
    out = tmp_path / "study"
    shutil.copytree(reference, out)
    file = sorted(out.glob("part-*.parquet"))[1]
    table = parquet.read_table(file)
    if column is None:
        column = table.column_names[1]
    made = pa.array(change(table.column(column).to_numpy()))
    doctored = table.set_column(table.column_names.index(column), column, made)
    parquet.write_table(doctored, file)
    run(out, chunk=1)
    assert "part-000001.parquet: does not belong to this study or was changed" in caplog.text
    assert bits(out) == bits(reference)
    about = {**table.schema.metadata, PART_DIGEST: digest(doctored)}
    parquet.write_table(doctored.replace_schema_metadata(about), file)
    with pytest.raises(ls.ResultError, match=r"part-000001\.parquet: .*Delete this file") as caught:
        run(out, chunk=1)
    assert caught.value.problems[0].key == column
    file.unlink()
    run(out, chunk=1)
    assert bits(out) == bits(reference)


@pytest.mark.parametrize(("added", "is_refused"), [(3e-8, False), (1.0, True)])
def test_rounding_of_a_force_is_no_difference(tmp_path, added, is_refused):
    """A stop that just touches carries 0 N in a block of thousands, and 3e-8 N among two samples.

    Forces are some 10 kN, known to 1e-9: a study of the shipped tolerances could not be resumed.
    """
    name = "boundary_force.4 [N]"
    floats = {"rings.*.float": {"distribution": "uniform", "low": "90 um", "high": "99 um"}}
    options = {**SETTINGS, "samples": 2, "positions": [1], "out": tmp_path / "study"}
    case = shipped("fgfbstts/limit_ring")
    ls.tolerance(case, floats, **options)
    (file,) = (tmp_path / "study").glob("part-*.parquet")
    table = parquet.read_table(file)
    forces = table.column(name).to_numpy()
    assert np.abs(forces).max() == 0.0
    made = table.set_column(table.column_names.index(name), name, pa.array(forces + added))
    about = {**table.schema.metadata, PART_DIGEST: digest(made)}
    parquet.write_table(made.replace_schema_metadata(about), file)
    if not is_refused:
        assert ls.tolerance(case, floats, **options).samples == 2
        return
    with pytest.raises(ls.ResultError, match="is not what sample") as caught:
        ls.tolerance(case, floats, **options)
    assert caught.value.problems[0].key == name


def test_a_study_that_was_killed_before_it_began_begins_anew(tmp_path):
    """Its folder contains half of study.json, under another name."""
    out = tmp_path / "study"
    out.mkdir()
    (out / ".study.json.0123456789abcdef").write_text('{"case"')
    run(out, chunk=1, samples=8)
    assert sorted(p.name for p in out.iterdir()) == ["part-000000.parquet", "study.json"]
    # Files of others remain a reason to refuse.
    other = tmp_path / "other"
    other.mkdir()
    (other / ".notes.txt.0123456789abcdef").write_text("mine")
    with pytest.raises(ls.LoadshareError, match="not empty and contains no tolerance study"):
        run(other, chunk=1, samples=8)


def test_a_worst_case_that_is_none_is_refused_by_name(tmp_path):
    options = {"samples": 64, "chunk": 1, "worst": True}
    found = run(tmp_path / "study", **options)
    assert run(tmp_path / "study", **options).worst == found.worst
    file = tmp_path / "study" / "worst.json"
    good = json.loads(file.read_text(encoding="utf-8"))
    omega = good["worst"][0]["omega"]
    some = next(iter(good["worst"][0]["inputs"]))
    for change in (
        {"omega": omega * 1.001},
        {"omega": float("nan")},
        {"inputs": {**good["worst"][0]["inputs"], some: 0.0}},
        {"changes": {}},
    ):
        altered = {**good, "worst": [{**good["worst"][0], **change}]}
        file.write_text(json.dumps({**altered, DIGEST: digest_of(altered)}), encoding="utf-8")
        with pytest.raises(ls.ResultError, match=r"worst\.json: worst\.stage\.omega"):
            run(tmp_path / "study", **options)
    # With its old digest it is not valid, and a worst case is sought again.
    file.write_text(json.dumps(altered), encoding="utf-8")
    assert run(tmp_path / "study", **options).worst == found.worst
    assert json.loads(file.read_text(encoding="utf-8")) == good


def test_other_settings_are_reported(tmp_path):
    out = tmp_path / "study"
    few = {"samples": 64, "chunk": 1}
    run(out, **few, limit=1.05)
    # Neither the limit nor quantiles nor workers affect the samples.
    assert run(out, **few, limit=1.1, workers=1, quantiles=[0.9]).limit == 1.1
    other = {**INPUTS, next(iter(INPUTS)): {"distribution": "uniform phase"}}
    with pytest.raises(ls.LoadshareError) as caught:
        ls.tolerance(
            shipped(PATHS).replace({"operating.torque": "300 N*m"}),
            other,
            out=out,
            **{**SETTINGS, **few, "seed": 4},
        )
    message = str(caught.value)
    for part in ("seed: 3 there, 4 requested", "case_hash", "normal mean 0 deviation 1 mrad there"):
        assert part in message, part
    assert '  operating.torque: "367 N*m" there, "300 N*m" requested' in message.splitlines()
    assert "samples:" not in message
    about = json.loads((out / "study.json").read_text(encoding="utf-8"))
    assert about["settings"]["seed"] == 3
    assert ls.Case(tomllib.loads(about["text"])).hash == about["settings"]["case_hash"]


def test_numbers_and_arrays_of_numpy_are_settings(tmp_path):
    """They are written to study.json as plain numbers, so that the same study can continue."""
    few = {"samples": 64, "seed": 4, "quantiles": [0.5, 0.9], "positions": [1], "chunk": 1}
    found = run(tmp_path, **few)
    given = {"samples": np.int64(64), "seed": np.int32(4), "chunk": np.int8(1)}
    given |= {"quantiles": (level for level in (0.5, 0.9)), "positions": np.array([1])}
    again = run(tmp_path, **given)
    assert again.settings == found.settings
    assert again.of("system").summary.quantiles == found.of("system").summary.quantiles


@pytest.mark.parametrize("name", ["workers", "chunk"])
@pytest.mark.parametrize("value", [0, -1, 1.5])
def test_workers_and_blocks_are_counted(tmp_path, name, value):
    with pytest.raises(ValueError, match=f"{name} {value}; allowed: a whole number from 1 on"):
        run(tmp_path / "study", **{name: value})


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(ls.LoadshareError, match="contains no tolerance study"):
        run(tmp_path, samples=64)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]


@pytest.mark.parametrize("held", ["", '{"case"', "[]"])
def test_a_damaged_study_file_is_refused_with_what_to_do(tmp_path, held):
    file = tmp_path / "study.json"
    file.write_text(held, encoding="utf-8")
    with pytest.raises(
        ls.LoadshareError, match=r"is damaged .*give a new or empty folder"
    ) as caught:
        run(tmp_path, samples=8)
    assert str(caught.value).startswith(f"{file}: ")
    assert file.read_text(encoding="utf-8") == held


@pytest.mark.slow
def test_a_worker_that_dies_is_replaced(reference, tmp_path, monkeypatch, processes):
    """The process of the first part is killed; the next one solves it."""
    solve, killed = local.solve_there, tmp_path / "killed"

    def dying(path, job, part):
        if not killed.exists():
            killed.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return solve(path, job, part)

    monkeypatch.setattr(local, "solve_there", dying)
    found = run(tmp_path / "study", samples=4096, workers=1)
    assert killed.exists()
    assert found.samples == 4096
    first = found.parts[0]
    assert parquet.read_table(first).equals(parquet.read_table(reference / first.name))


@pytest.mark.slow
def test_a_worker_that_dies_again_ends_the_study(tmp_path, monkeypatch, processes):
    def dying(path, job, part):
        os.kill(os.getpid(), signal.SIGKILL)

    monkeypatch.setattr(local, "solve_there", dying)
    with pytest.raises(ls.LoadshareError, match="part 0 of samples: its worker process died twice"):
        run(tmp_path / "study", samples=64, workers=2)


@pytest.mark.slow
def test_what_a_worker_cannot_write_is_reported(tmp_path, processes):
    out = tmp_path / "study"
    (part,) = run(out, samples=64).parts
    part.unlink()
    part.mkdir()
    message = (
        r"part 0 of samples: .*part-000000\.parquet cannot be written: Is a directory\. 0 of 1"
    )
    with pytest.raises(ls.LoadshareError, match=message):
        run(out, samples=64)


def test_a_refused_sample_names_each_position_once():
    far = {"distribution": "uniform", "low": "60 mm", "high": "80 mm"}
    found = ls.tolerance(
        shipped("fgfbstts/limit_ring"),
        {"errors.6.installation[0]": far},
        samples=1,
        indices=0,
        worst=False,
        positions=[2, 3],
    )
    (message,) = found.to_frame()["message"]
    lines = message.splitlines()
    assert [line.partition(": ")[0] for line in lines] == ["position 2", "position 3"]
    assert all(line.count("position") == 1 for line in lines)


@pytest.mark.slow
def test_refused_samples_are_counted_and_reported():
    """At low torque, the law of a spline with stick limit drops: no unique equilibrium."""
    case = shipped("fgfbstts/full_float").replace(
        {
            "splines.4.normal_force": None,
            "splines.4.friction": 0.1,
            "splines.4.radius": "35 mm",
            "splines.4.stick_limit": "100 um",
        }
    )
    inputs = {"operating.power": {"distribution": "uniform", "low": "20 kW", "high": "800 kW"}}
    found = ls.tolerance(case, inputs, samples=24, indices=8, worst=False, positions=[1])
    frame = found.to_frame()
    refused = ~frame["certified"]
    assert 0 < found.refused < 24
    assert found.refused == refused.sum() == sum(found.messages.values())
    power = frame["operating.power [kW]"]
    assert power[refused].max() < power[~refused].min()
    assert all("would drop" in text for text in frame.loc[refused, "message"])
    assert frame.loc[~refused, "message"].isna().all()
    assert np.isnan(frame.loc[refused, "omega.system"]).all()
    assert found.of("system").summary.count == 24 - found.refused
    assert found.design_refused > 0


def test_a_sample_that_makes_no_case_does_not_take_others_with_it(monkeypatch):
    """Far out, a normal value may be outside a case's limits; here no trial prevents that."""
    from loadshare.study.tolerance import inputs as room

    monkeypatch.setattr(room, "TOLERANCE", TOLERANCE._replace(far=0.4))
    inputs = {"rings.4.float": {"distribution": "normal", "mean": "2 um", "deviation": "1 um"}}
    found = ls.tolerance(
        shipped("fgfbstts/limit_ring"), inputs, samples=100, indices=0, worst=False, positions=[1]
    )
    frame = found.to_frame()
    negative = frame["rings.4.float [um]"] < 0.0
    assert found.refused == negative.sum() > 0
    assert frame.loc[~negative, "certified"].all()
    assert any("does not give a valid case" in text for text in found.messages)


@pytest.mark.parametrize("worst", mostly_slow((False, True), {False}))
def test_a_clearance_that_warmth_uses_up_refuses_its_samples_alone(worst):
    """Only the train built from a sample shows it; the worst case is still sought."""
    bearing = {"clearance": "30 um", "stiffness": "1e9 N/m", "diameter": "50 mm"}
    case = shipped("planetary/four_planets").replace(
        {"gears.planet1.support": None, "bearings.planet1": bearing}
    )
    inputs = {
        "bearings.planet1.clearance": {"distribution": "uniform", "low": "10 um", "high": "60 um"},
        "gears.carrier.temperature": {"distribution": "uniform", "low": "0 K", "high": "80 K"},
    }
    found = ls.tolerance(case, inputs, samples=8, indices=0, worst=worst)
    frame = found.to_frame()
    # The pin grows by 11.5e-6 of its 50 mm in diameter per kelvin.
    left = frame["bearings.planet1.clearance [um]"]
    left = left - 0.5 * 11.5e-6 * 50e3 * frame["gears.carrier.temperature [K]"]
    assert (frame["certified"] == (left > 0.0)).all()
    assert 0 < found.refused < 8
    assert all("is used up" in text for text in found.messages)
    samples = {
        "bearings.planet1.clearance [um]": [10.0, 60.0, 10.0],
        "gears.carrier.temperature [K]": [0.0, 80.0, 80.0],
    }
    with pytest.raises(ls.CaseError, match=r'"10\.0 um": is used up'):
        ls.solve_many(case, samples)


COMMAND = """
import signal
from loadshare.cli.main import main
from loadshare.study.tolerance import study
if __name__ == "__main__":
    # Whoever runs the tests in the background has interrupts ignored, and children inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    study.TOLERANCE = study.TOLERANCE._replace(small=0)
    study.tolerance.__kwdefaults__.update(chunk=1, engine="vectorised")
    main()
"""


@pytest.fixture
def scatter(tmp_path) -> Path:
    """Write a case with a study that takes some seconds."""
    case = shipped(PATHS).replace(
        {"study.scatter": {"kind": "tolerance", "inputs": INPUTS, "indices": 0, "samples": 400_000}}
    )
    file = tmp_path / "case.toml"
    file.write_text(case.to_toml(), encoding="utf-8")
    return file


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize(
    ("sent", "code", "workers"),
    [
        (signal.SIGINT, 130, "1"),
        pytest.param(signal.SIGTERM, 143, "2", marks=pytest.mark.slow),
        pytest.param(signal.SIGINT, 130, "2", marks=pytest.mark.slow),
        pytest.param(signal.SIGTERM, 143, "1", marks=pytest.mark.slow),
    ],
)
def test_a_study_that_is_stopped_says_what_is_kept(scatter, tmp_path, sent, code, workers):
    out = tmp_path / "study"
    words = ("tolerance", scatter, "-o", out, "--workers", workers)
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, *words],
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        until(lambda: (out / "part-000000.parquet").exists(), process)
        for _ in range(3):
            process.send_signal(sent)
        # Workers hold the other end of this pipe: once it is read to its end, they have ended.
        _, err = process.communicate(timeout=120.0)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    assert process.returncode == code
    assert "Traceback" not in err
    found = re.search(r"Interrupted: ([\d,]+) of 400,000 samples are kept in .*study\.", err)
    assert found is not None, err
    kept = len(list(out.glob("part-*.parquet")))
    assert int(found[1].replace(",", "")) <= 4096 * kept < 400_000
    assert "The same command continues from there." in err


def test_a_second_study_in_a_folder_does_nothing(tmp_path):
    out = tmp_path / "study"
    out.mkdir()
    with alone_in(out), pytest.raises(ls.LoadshareError, match=f"in use by process {os.getpid()} "):
        run(out, samples=64)
    assert list(out.iterdir()) == []
    run(out, samples=64)


def test_what_has_no_folder_is_not_kept(monkeypatch, processes):
    def dying(path, job, part):
        os.kill(os.getpid(), signal.SIGKILL)

    monkeypatch.setattr(local, "solve_there", dying)
    with pytest.raises(ls.LoadshareError, match="Nothing is kept: the study has no folder"):
        run(None, samples=64)


def test_torques_of_a_drive_that_brakes_are_the_largest(tmp_path):
    """Three planets on a floating sun take a third each of -900 N·m, the most negative load."""
    torque = ["-800 N*m", "-500 N*m", "-900 N*m"]
    case = shipped("star/floating_sun_3").replace(
        {"operating.torque": torque, "operating.positions": 3}
    )
    gap = {"distribution": "uniform", "low": "0 urad", "high": "20 urad"}
    inputs = {'meshes."sun-planet1".gap': gap}
    ls.tolerance(case, inputs, samples=16, indices=0, worst=False, seed=1, out=tmp_path / "study")
    (part,) = (tmp_path / "study").glob("part-*.parquet")
    found = parquet.read_table(part)["torque.sun-planet2 [N*m]"].to_numpy()
    np.testing.assert_allclose(found, -300.0, rtol=1e-9)


def test_a_case_without_stages_has_torques_but_no_shares():
    pair = ls.Case(
        {
            "operating": {"input": "a", "output": "b", "torque": "1000 N*m"},
            "gears": {
                "a": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]},
                "b": {"base_radius": "100 mm", "centre": ["160 mm", "0 mm"]},
            },
            "meshes": {"a-b": {"stiffness": "5e5 N*m/rad"}},
        }
    )
    spread = {"distribution": "uniform", "low": "900 N*m", "high": "1100 N*m"}
    found = ls.tolerance(pair, {"operating.torque": spread}, samples=8, indices=4, workers=1)
    table = found.to_frame()
    assert found.omega == ()
    torque, given = (
        table[f"{name} [N*m]"].to_numpy() for name in ("torque.a-b", "operating.torque")
    )
    assert torque == pytest.approx(given, rel=1e-12)
    with pytest.raises(ls.LoadshareError, match="without stages"):
        found.plot()
