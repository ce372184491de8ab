"""Where commands write: never over a device, a pipe, a link or a file that they read."""

import errno
import json
import os
import pickle
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from tests.support import CASES
from typer.testing import CliRunner, Result

import loadshare as ls
from loadshare import output
from loadshare.cli.main import app
from loadshare.output import STANDARD, NotWritten, clear, csv_of, make_folder, write_whole

CASE = CASES / "star" / "floating_sun_3.toml"


def call(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def test_a_file_stands_whole_or_not_at_all(tmp_path, monkeypatch):
    file = tmp_path / "new" / "file.txt"
    write_whole(file, "one")

    def breaks(to: Path, content: bytes) -> None:
        with to.open("wb") as stream:
            stream.write(content[:1])
        raise OSError(errno.ENOSPC, "the disk is full", str(to))

    monkeypatch.setattr(Path, "write_bytes", breaks)
    with pytest.raises(NotWritten, match="full") as caught:
        write_whole(file, "two")
    assert caught.value.filename == str(file)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (type(again), str(again)) == (NotWritten, str(caught.value))
    assert file.read_text() == "one"
    assert [f.name for f in file.parent.iterdir()] == ["file.txt"]


LEFT = ".file.txt.0123456789abcdef"


def test_what_a_killed_process_left_is_cleared(tmp_path):
    others = {".file.txt", ".other.txt.0123456789abcdef", ".file.txt.0123", "file.txt.~"}
    for name in {LEFT, *others}:
        (tmp_path / name).write_text("half")
    clear([tmp_path / "file.txt", tmp_path / "none" / "file.txt"])
    assert {f.name for f in tmp_path.iterdir()} == others


@pytest.mark.skipif(os.name != "posix", reason="no locks of folders on this system")
def test_a_name_of_wide_letters_may_be_as_long_as_the_file_system_has_it(tmp_path):
    # Each of these letters is three bytes, and file systems allow 255.
    file = tmp_path / f"{80 * '歯'}.toml"
    write_whole(file, "one")
    assert file.read_text() == "one"
    cut = 33 * "歯"
    (tmp_path / f".{cut}.0123456789abcdef").touch()
    clear([file])
    assert [one.name for one in tmp_path.iterdir()] == [file.name]


def test_a_name_of_a_file_commands_no_terminal(tmp_path):
    case = tmp_path / "red \x1b[31m.toml"
    case.write_text(ls.load_case(CASE).to_toml(), encoding="utf-8")
    for name, words in ((case, ("-o", tmp_path / "\x1b]0;.json")), (tmp_path / "\x1bc.toml", ())):
        done = call("run", name, *words)
        assert "\ufffd" in done.output
        assert "\x1b" not in done.output


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are texts there")
def test_a_case_whose_name_is_no_text_is_solved_and_written_with_question_marks(
    tmp_path, monkeypatch
):
    # Archives that were packed on a system with another encoding have such names.
    monkeypatch.chdir(tmp_path)
    name = os.fsdecode(b"pr\xfcfstand.toml")
    Path(name).write_bytes(CASE.read_bytes())
    files = [f"found.{form}" for form in ("json", "nc", "xlsx", "toml")]
    # Quiet, because the simulated screen does not show question marks.
    done = call("run", name, "-q", *(word for file in files for word in ("-o", file)))
    assert done.exit_code == 0
    for file in files[:2]:
        result = ls.load_result(file)
        assert result.stamp.case == "pr?fstand"
        assert result == ls.solve(name)
    for outcome in ("certified", "kept"):
        assert call("batch", name, "-o", "out", "-j", "1", "-q").exit_code == 0
        (of_case,) = json.loads(Path("out/summary.json").read_text(encoding="utf-8"))["cases"]
        assert (of_case["name"], of_case["outcome"]) == ("pr?fstand", outcome)
    assert {file.name for file in Path("out").iterdir()} == {f"{name[:-5]}.json", "summary.json"}


def test_what_another_is_writing_is_left_alone(tmp_path, monkeypatch):
    """Both write the same file: each has its own temporary file until it is complete."""
    file = tmp_path / "file.txt"
    started, going = threading.Event(), threading.Event()
    at_once = Path.write_bytes

    def slow(to: Path, content: bytes) -> None:
        at_once(to, content)
        if content == b"of one":
            started.set()
            assert going.wait(60)

    monkeypatch.setattr(Path, "write_bytes", slow)
    one = threading.Thread(target=write_whole, args=(file, "of one"))
    one.start()
    assert started.wait(60)
    write_whole(file, "of the other")
    clear([file])
    assert len(list(tmp_path.iterdir())) == 2
    going.set()
    one.join(60)
    assert {f.name: f.read_text() for f in tmp_path.iterdir()} == {"file.txt": "of one"}


@pytest.mark.skipif(os.name != "posix", reason="folders are not brought to the disk")
@pytest.mark.parametrize(("code", "reported"), [(errno.EIO, True), (errno.EINVAL, False)])
def test_a_folder_that_cannot_be_brought_to_the_disk_is_reported(
    tmp_path, monkeypatch, code, reported
):
    """It is not reported if the file system has no such operation."""
    real = os.fsync

    def failing(handle: int) -> None:
        if stat.S_ISDIR(os.fstat(handle).st_mode):
            raise OSError(code, os.strerror(code))
        real(handle)

    monkeypatch.setattr(output.os, "fsync", failing)
    file = tmp_path / "file.txt"
    if reported:
        with pytest.raises(OSError, match="Input/output"):
            write_whole(file, "one")
    else:
        write_whole(file, "one")
    assert file.read_text() == "one"


def test_folders_that_are_made_are_brought_to_the_disk(tmp_path, monkeypatch):
    brought = []
    monkeypatch.setattr(output, "_sync_folder", brought.append)
    make_folder(tmp_path / "a" / "b")
    assert brought == [tmp_path, tmp_path / "a"]
    make_folder(tmp_path / "a" / "b")
    assert len(brought) == 2


def test_a_link_is_followed(tmp_path):
    file, link, dangling = tmp_path / "file", tmp_path / "link", tmp_path / "dangling"
    file.write_text("old")
    link.symlink_to(file)
    dangling.symlink_to(tmp_path / "nowhere")
    write_whole(link, "new")
    write_whole(dangling, b"made")
    assert link.is_symlink()
    assert dangling.is_symlink()
    assert file.read_text() == "new"
    assert (tmp_path / "nowhere").read_text() == "made"


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_the_mode_of_a_file_is_kept(tmp_path, mode):
    file = tmp_path / "file"
    file.write_text("old")
    file.chmod(mode)
    write_whole(file, "new")
    assert stat.S_IMODE(file.stat().st_mode) == mode


def test_a_new_file_has_the_mode_of_any_other(tmp_path):
    write_whole(tmp_path / "ours", "x")
    (tmp_path / "theirs").write_text("x")
    modes = {stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("ours", "theirs")}
    assert len(modes) == 1


def test_a_pipe_is_written_to(tmp_path):
    pipe, found = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: found.append(pipe.read_text()))
    reader.start()
    done = call("run", CASE, "--json", pipe)
    reader.join(30)
    assert done.exit_code == 0
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert json.loads(found[0])["case"] == "floating_sun_3"


def test_a_device_is_written_to():
    assert call("run", CASE, "--json", os.devnull).exit_code == 0
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device")
@pytest.mark.parametrize(
    "words",
    [
        ("run", CASE, "--json", "/dev/full"),
        ("run", CASE, "--csv", "/dev/full"),
        ("run", CASE, "--netcdf", "/dev/full"),
        ("schema", "-o", "/dev/full"),
    ],
)
def test_a_full_disk_is_reported_by_name(words):
    done = call(*words)
    assert done.exit_code == 2
    assert "/dev/full: cannot be written" in done.output
    assert "Traceback" not in done.output


def test_a_dash_is_stdout_and_messages_go_to_stderr():
    done = call("run", CASE, "--json", STANDARD)
    assert done.exit_code == 0
    assert json.loads(done.stdout)["case"] == "floating_sun_3"
    assert "PASSED" in done.stderr
    table = call("run", CASE, "--csv", STANDARD)
    assert table.stdout.startswith("position,")
    drawing = call("draw", CASE, "-o", STANDARD)
    assert drawing.stdout.startswith("<svg")
    assert not Path(STANDARD).exists()


def test_a_file_that_cannot_be_written_does_not_keep_others_from_being_written(tmp_path):
    (tmp_path / "taken").write_text("")
    lost = [tmp_path / "taken" / name for name in ("a.csv", "b.json")]
    kept = [tmp_path / name for name in ("c.csv", "d.json")]
    files = [word for file in (lost[0], kept[0], lost[1], kept[1]) for word in ("-o", file)]
    done = call("sweep", CASE, "--over", "operating.torque=1 N*m, 2 N*m", "--position", 1, *files)
    assert done.exit_code == 2
    assert all(file.stat().st_size for file in kept)
    said = [line for line in done.stderr.splitlines() if "cannot be written" in line]
    assert [line.partition(": ")[0] for line in said] == [str(file) for file in lost]


EVERY = ("base.toml", "case.toml", "link.html")


@pytest.fixture
def copied(tmp_path):
    """Write a case that extends another one; return both."""
    base, case = tmp_path / "base.toml", tmp_path / "case.toml"
    base.write_text(CASE.read_text())
    case.write_text('extends = "base.toml"\n')
    return base, case


WRITING = [
    *(("run", "CASE", option, which) for option in ("--json", "--netcdf") for which in EVERY),
    ("draw", "CASE", "-o", "link.html"),
    ("report", "CASE", "-o", "link.html"),
]


@pytest.mark.parametrize("words", WRITING, ids=" ".join)
def test_what_is_read_is_not_written_over(copied, words):
    base, case = copied
    base.with_name("link.html").symlink_to(case)
    before = base.read_text(), case.read_text()
    command, _, option, out = words
    done = call(command, case, option, base.with_name(out))
    assert done.exit_code == 2
    assert "is read by this command" in " ".join(done.output.split())
    assert (base.read_text(), case.read_text()) == before


def test_a_law_is_not_written_over_its_pair(tmp_path):
    pair = CASES / "fgfbstts" / "pairs" / "p12.toml"
    own = tmp_path / "law.toml"
    own.write_text(pair.read_text())
    done = call("ltca", own, "-o", tmp_path)
    assert done.exit_code == 2
    assert "is read by this command" in " ".join(done.output.split())
    assert own.read_text() == pair.read_text()


def test_no_cell_of_a_table_is_a_formula():
    """Names are chosen by users; quantities stay as they are."""
    import pandas as pd

    names = ["=1+1", "+a", "-a", "@a", "\t=1", "a", "-0.5 um", "+.5", None]
    frame = pd.DataFrame({"mesh": names, "=value": [-1.5] * len(names)})
    rows = csv_of(frame).split("\n")
    assert rows[0] == "mesh,'=value"
    cells = [row.split(",")[0].strip('"') for row in rows[1:-1]]
    assert cells == ["'=1+1", "'+a", "'-a", "'@a", "'\t=1", "a", "-0.5 um", "+.5", ""]
    assert all(row.endswith(",-1.5") for row in rows[1:-1])


def test_a_column_of_parquet_has_one_type_whatever_is_in_it(tmp_path):
    """Files of one study are read together; figures may happen to be whole, or be missing."""
    import numpy as np
    import pandas as pd
    from pyarrow import parquet

    from loadshare.cli.forms import tables_of

    def schema(figures: list[object], number: object) -> list[str]:
        frame = pd.DataFrame({"swept": [1.0, 2.0], "load": pd.Series(figures), "at": [1, number]})
        (tmp_path / "one.parquet").write_bytes(tables_of("one", lambda: frame)["parquet"]())
        return [str(column.type) for column in parquet.read_schema(tmp_path / "one.parquet")]

    assert schema([0.5, 1.5], 2) == ["double", "double", "int64"]
    assert schema([0.0, 0.0], pd.NA) == ["double", "double", "int64"]
    assert schema([np.nan, None], 2) == ["double", "double", "int64"]
    assert schema([3.0, None], pd.NA) == ["double", "double", "int64"]


def test_a_slash_in_a_name_is_written_to_netcdf(tmp_path):
    """In netCDF it would mean a group; names of elements are chosen by users."""
    import xarray as xr

    keys = ('gears."a/b".x', 'gears."a|b".x')
    grid = {key: ("um", [1.0 + k, 2.0]) for k, key in enumerate(keys)}
    coords = {key: (key, values, {"units": unit}) for key, (unit, values) in grid.items()}
    arrays = xr.Dataset({"load/max": (keys, [[1.0, 2.0], [3.0, 4.0]])}, coords=coords)
    (tmp_path / "one.nc").write_bytes(output.netcdf_of(arrays))
    found = xr.load_dataset(tmp_path / "one.nc", engine="h5netcdf")
    names = {found[name].attrs.get("long_name", name): name for name in map(str, found.variables)}
    assert set(names) == {"load/max", *keys}
    assert names[keys[1]] == keys[1]
    for name in names:
        assert found[names[name]].values.tolist() == arrays[name].values.tolist()
    assert found[names[keys[0]]].attrs["units"] == "um"
    # The given data set is not changed.
    assert set(arrays.variables) == {"load/max", *keys}


def test_a_sweep_over_a_name_with_a_slash_is_written(tmp_path):
    import xarray as xr

    text = json.dumps(ls.load_case(CASE).to_dict()).replace("planet1", "planet/1")
    file = tmp_path / "case.toml"
    file.write_text(ls.Case(json.loads(text)).to_toml(), encoding="utf-8")
    key = 'meshes."sun-planet/1".gap'
    over = f"{key}=0 urad:50 urad:2"
    assert call("sweep", file, "--over", over, "-o", tmp_path / "one.nc").exit_code == 0
    found = xr.load_dataset(tmp_path / "one.nc", engine="h5netcdf")
    assert found["torque"].dims[0] == key.replace("/", "|")
    assert found[found["torque"].dims[0]].attrs["long_name"] == key
    assert "sun-planet/1" in found["mesh"].values


@pytest.mark.parametrize("name", ["", "json:"])
def test_an_empty_name_is_no_file(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    done = call("run", CASE, "-o", name)
    assert done.exit_code == 2
    assert "names no file" in done.stderr
    assert not [*tmp_path.iterdir()]


def test_files_are_written_though_nobody_reads_the_screen(tmp_path):
    """This happens with ``| head -1``."""
    file = tmp_path / "result.json"
    words = [sys.executable, "-m", "loadshare", "run", str(CASE), "-o", str(file)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        process.stdout.close()
        assert process.wait() == 0
    assert ls.load_result(file).passed


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (["run", "--set", "operating.torque=4e9 N*m"], "x.json"),
        (["report", "--set", "operating.torque=4e9 N*m"], "x.html"),
        (["sweep", "--over", "operating.torque=100 N*m, 4e9 N*m"], "x.csv"),
    ],
    ids=lambda words: words[0] if isinstance(words, list) else "",
)
def test_refusals_are_told_even_if_a_file_cannot_be_written(words, file, tmp_path):
    (tmp_path / "no folder").touch()
    lost = tmp_path / "no folder" / file
    result = call(words[0], CASE, *words[1:], "-o", lost)
    assert result.exit_code == 2
    said = " ".join(result.stderr.split())
    assert f"{lost}: cannot be written" in said
    assert "the displacements are too large" in said
