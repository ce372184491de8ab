"""A full disk: every command that writes names the file, ends with 2 and leaves no partial file."""

import subprocess
import sys
from pathlib import Path

import pytest
from tests.cli.conftest import plain_environment
from tests.support import CASES, mostly_slow
from tests.surroundings.disk import PAGE, files, fill, mounted
from tests.tooth.use.pairs import SPUR

from loadshare.cli.main import main

SUN = CASES / "star" / "floating_sun_3.toml"
RING = CASES / "fgfbstts" / "limit_ring.toml"
BENCH = """extends = '{base}'
[measured.bench]
position = 1
pair_share = {{ "6-10" = 0.8 }}
uncertainty = 0.01
[study.scatter]
kind = "tolerance"
samples = 64
indices = 0
seed = 1
[study.scatter.inputs]
"errors.6.installation[0]" = {{ distribution = "normal", mean = "0 um", deviation = "15 um" }}
"""

# Arguments; DISK, BENCH and PAIR stand for paths of the test.
SWEEP = ("sweep", RING, "--set", "rings.4.float=1 um, 2 um", "--position", 1, "-o")
SENSITIVITY = ("sensitivity", RING, "errors.6.*", "--position", 1, "-o")
MARCH = ("march", RING, "--gear", 4, "--revolutions", 1, "--steps", 1, "-o")
FIT = ("fit", "BENCH", "--unknown", "errors.6.installation[0]=0 um:100 um", "-o")
TOLERANCE = ("tolerance", "BENCH", "--workers", 1, "--no-worst", "-o", "DISK/study")
WRITING = [
    ("run", SUN, "-o", "DISK/a.json"),
    ("run", SUN, "-o", "DISK/a.csv"),
    ("run", SUN, "-o", "DISK/a.nc"),
    ("report", SUN, "-o", "DISK/a.html"),
    *(("draw", SUN, "-o", f"DISK/a.{ending}") for ending in ("svg", "png", "pdf", "html", "json")),
    ("schema", "-o", "DISK/a.json"),
    ("new", "own", "-o", "DISK/own.toml"),
    (*SWEEP, "DISK/a.csv"),
    (*SWEEP, "DISK/a.nc"),
    (*SENSITIVITY, "DISK/a.csv"),
    (*SENSITIVITY, "DISK/a.nc"),
    ("critical", RING, "rings.4.float", "--from", "8 um", "--to", "9 um", "-o", "DISK/a.csv"),
    (*MARCH, "DISK/a.csv"),
    (*MARCH, "DISK/a.nc"),
    ("compare", "BENCH", "-o", "DISK/a.csv"),
    (*FIT, "DISK/a.toml"),
]


def name_of(words: tuple[object, ...]) -> str:
    return f"{words[0]} {Path(str(words[-1])).suffix}"


@pytest.fixture
def disk(tmp_path: Path):
    with mounted(tmp_path / "disk") as place:
        yield place


@pytest.fixture
def run(disk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Run a command as its own process does; return its exit code and its messages."""
    bench, pair = tmp_path / "bench.toml", tmp_path / "pair.toml"
    base = (CASES / "fgfbstts" / "installation_error.toml").as_posix()
    bench.write_text(BENCH.format(base=base), encoding="utf-8")
    pair.write_text(SPUR, encoding="utf-8")
    places = {"BENCH": str(bench), "PAIR": str(pair)}

    def ran(*words: object) -> tuple[object, str]:
        given = [places.get(str(w), str(w)).replace("DISK", str(disk)) for w in words]
        with pytest.raises(SystemExit) as end:
            main(given)
        return end.value.code, capsys.readouterr().err

    return ran


@pytest.mark.parametrize("words", mostly_slow([(w,) for w in WRITING], WRITING[:5]), ids=name_of)
@pytest.mark.quick(2)
def test_a_full_disk_is_reported_and_nothing_is_left(run, disk, words):
    fill(disk, 0)
    code, output = run(*words)
    file = str(words[-1]).replace("DISK", str(disk))
    assert code == 2
    assert output.strip().splitlines()[-1] == f"{file}: cannot be written: No space left on device"
    assert "Traceback" not in output
    assert files(disk) == {}


@pytest.mark.parametrize("pages", mostly_slow((1, 2, 4), (2,)))
@pytest.mark.parametrize(
    "words", [w for w in WRITING if Path(str(w[-1])).suffix in {".nc", ".html"}], ids=name_of
)
@pytest.mark.quick(2)
def test_a_disk_that_fills_up_while_it_is_written_leaves_what_was_there(run, disk, words, pages):
    file = Path(str(words[-1]).replace("DISK", str(disk)))
    file.write_text("old", encoding="utf-8")
    fill(disk, pages * PAGE)
    code, output = run(*words)
    assert code == 2
    assert f"{file}: cannot be written" in output
    assert files(disk) == {file.name: b"old"}


def test_each_file_of_an_analysis_is_whole_or_not_there(run, disk, monkeypatch, tmp_path):
    monkeypatch.setenv("LOADSHARE_CACHE", str(tmp_path / "laws"))
    whole = run("ltca", "PAIR", "--positions", 1, "-o", tmp_path / "whole")
    assert whole[0] == 0
    fill(disk, 2 * PAGE)
    code, output = run("ltca", "PAIR", "--positions", 1, "-o", "DISK/pair")
    assert code == 2
    assert f"{disk / 'pair'}" in output
    assert "cannot be written: No space left on device" in output
    left = files(disk / "pair")
    assert 0 < len(left) < len(files(tmp_path / "whole"))
    for name, content in left.items():
        assert content == (tmp_path / "whole" / name).read_bytes()


def test_a_batch_names_each_file_that_has_no_room(run, disk):
    fill(disk, 4 * PAGE)
    code, _ = run("batch", CASES / "star", "-o", "DISK/out", "-j", 1)
    assert code == 2
    whole = {name for name in files(disk) if "summary" not in name}
    assert len(whole) == 1
    (disk / "ballast").unlink()
    fill(disk, 0)
    code, output = run("batch", CASES / "star", "-o", "DISK/more", "-j", 1)
    assert code == 2
    assert f"{disk / 'more' / 'summary.json'}: cannot be written" in output


def test_a_batch_without_room_goes_on_when_there_is_some(run, disk):
    fill(disk, 4 * PAGE)
    assert run("batch", CASES / "star", "-o", "DISK/out", "-j", 1)[0] == 2
    (disk / "ballast").unlink()
    assert run("batch", CASES / "star", "-o", "DISK/out", "-j", 1)[0] == 0
    assert len(files(disk)) == 5


@pytest.mark.parametrize("pages", [0, 2])
def test_a_tolerance_study_names_its_part_and_goes_on_when_there_is_room(run, disk, pages):
    fill(disk, pages * PAGE)
    code, output = run(*TOLERANCE)
    assert code == 2
    assert output.strip().splitlines()[-1].startswith(str(disk / "study"))
    assert "cannot be written: No space left on device" in output
    assert not [name for name in files(disk) if "part-" in name]
    (disk / "ballast").unlink()
    assert run(*TOLERANCE)[0] == 0
    assert "study/part-000000.parquet" in files(disk)


def test_compiled_code_that_finds_no_room_is_used_all_the_same(disk, tmp_path):
    module = "from loadshare.compilation import jit\n@jit()\ndef twice(x):\n    return 2.0 * x\n"
    (tmp_path / "kept.py").write_text(module, encoding="utf-8")
    fill(disk, PAGE)
    script = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import kept; print(kept.twice(2))"
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        env=plain_environment(NUMBA_CACHE_DIR=str(disk / "code")),
    )
    assert done.stdout == "4.0\n"
    assert done.stderr.count("No space left on device") == 1
    assert "could not be kept" in done.stderr or "not used" in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device")
@pytest.mark.parametrize("words", [("run", SUN), ("schema",), ("--help",), ("--version",)])
@pytest.mark.quick(1)
def test_a_full_disk_behind_standard_output_is_reported(words):
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "loadshare", *map(str, words)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            env=plain_environment(),
        )
    assert done.returncode == 2
    assert done.stderr == "standard output: cannot be written: No space left on device\n"


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such limits")
def test_a_limit_on_the_size_of_files_is_reported(tmp_path):
    script = f"""
import resource, signal
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
from loadshare.cli.main import main
main(["run", {str(SUN)!r}, "-o", {str(tmp_path / "a.json")!r}])
"""
    done = subprocess.run(
        [sys.executable, "-B", "-c", script],
        capture_output=True,
        text=True,
        check=False,
        env=plain_environment(),
    )
    assert done.returncode == 2
    assert done.stderr == f"{tmp_path / 'a.json'}: cannot be written: File too large\n"
    assert list(tmp_path.iterdir()) == []
