"""Too little memory is reported by a message, with exit code 2."""

import subprocess
import sys

import pytest
from tests.cli.conftest import plain_environment
from tests.support import CASES

from loadshare.cli import main as entry
from loadshare.cli.batch import work as pool

RING = CASES / "fgfbstts" / "limit_ring.toml"
MESSAGE = "There is not enough memory"
UNDER_A_LIMIT = f"""
import resource
from contextlib import suppress
from loadshare.cli.main import main
words = ["run", {str(RING)!r}]
with suppress(SystemExit):
    main(words)
import numpy as np
held = int(open("/proc/self/status").read().split("VmSize:")[1].split()[0]) * 1024
resource.setrlimit(resource.RLIMIT_AS, (held + 2**24, held + 2**24))
import loadshare.job
loadshare.job.solve = lambda *_, **__: np.ones(2**30)
main(words)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="there are no such limits")
def test_a_limit_on_memory_is_reported():
    done = subprocess.run(
        [sys.executable, "-c", UNDER_A_LIMIT],
        capture_output=True,
        text=True,
        check=False,
        env=plain_environment(OPENBLAS_NUM_THREADS="1"),
    )
    assert done.returncode == 2
    assert done.stderr.startswith(f"{MESSAGE} (Unable to allocate 8.00 GiB")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (MemoryError(), f"{MESSAGE}."),
        (OSError(12, "Cannot allocate memory"), f"{MESSAGE} ([Errno 12] Cannot allocate memory)"),
        (
            ImportError("lib.so: failed to map segment from shared object"),
            f"{MESSAGE} (a library could not be loaded)",
        ),
    ],
)
def test_lack_of_memory_is_reported_however_it_shows(monkeypatch, capsys, error, message):
    def fails(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(entry, "_built", lambda: fails)
    with pytest.raises(SystemExit) as end:
        entry.main(["run"])
    assert end.value.code == 2
    assert capsys.readouterr().err.startswith(message)


@pytest.mark.parametrize("error", [ImportError("no module"), OSError(5, "Input/output error")])
def test_other_errors_are_not_taken_for_it(monkeypatch, error):
    def fails(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(entry, "_built", lambda: fails)
    with pytest.raises(type(error)):
        entry.main(["run"])


def test_a_case_too_large_for_memory_costs_the_others_nothing(monkeypatch, tmp_path):
    def fails(_: pool.Task) -> None:
        raise MemoryError("Unable to allocate 8.00 GiB")

    monkeypatch.setattr(pool, "_attempt", fails)
    how = {"solver": "auto", "method": "newton", "tolerance": 1e-9}
    task = pool.Task(RING, "ring", tmp_path / "ring.json", how, 1, False, {})
    found = pool.work(task)
    assert found.outcome == "crashed"
    assert found.messages[0].startswith(f"{MESSAGE} (Unable to allocate 8.00 GiB)")
