"""A sample of kills; ``python -m tests.kills --count 200`` tries any number of them."""

import pytest
from tests.kills.cluster import await_workers, cluster
from tests.kills.trial import KINDS, TARGETS, Bench, differences, trial


@pytest.fixture
def patient(monkeypatch):
    """Allow more time, because other tests run beside it; leftovers that stay are still found."""
    monkeypatch.setattr("tests.kills.trial.GONE", 60.0)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(TARGETS)))
def test_what_is_killed_leaves_nothing_and_goes_on(tmp_path, patient, number):
    """The parent, the group or a worker of a batch is killed."""
    bench = Bench.of(tmp_path, ("batch",))
    found = trial(bench, 1, number, ("batch",))
    assert (found.orphans, found.faults) == ((), ()), found


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning:distributed", "ignore::ResourceWarning")
def test_studies_that_are_killed_leave_nothing_and_go_on(tmp_path, patient):
    """The same with studies, here and on a cluster, twice."""
    pytest.importorskip("distributed")
    with cluster(tmp_path, 2) as started:
        await_workers(started.address, 2)
        bench = Bench.of(tmp_path, KINDS, started)
        for number in range(2 * len(KINDS) * len(TARGETS)):
            found = trial(bench, 2, number)
            assert (found.orphans, found.faults) == ((), ()), found


def test_a_difference_is_found(tmp_path):
    """A check that cannot fail would prove nothing."""
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "part.parquet").write_bytes(b"PAR1")
    one, other = tmp_path / "one", tmp_path / "other"
    assert differences("local", one, other) == []
    (other / "part.parquet").write_bytes(b"PAR2")
    (other / ".part.parquet.0123456789abcdef").touch()
    assert differences("local", one, other) == [
        "local: .part.parquet.0123456789abcdef is there in one only",
        "local: part.parquet differs",
    ]
