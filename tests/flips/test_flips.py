"""A sample of flipped bits; ``python -m tests.flips --count 10000`` tries more."""

import logging

import pytest
from tests.flips.flip import places, subjects
from tests.reproducible import examples
from tests.support import mostly_slow


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    return list(subjects(tmp_path_factory.mktemp("written")))


@pytest.mark.parametrize(
    "kind",
    mostly_slow(
        ("result.json", "result.nc", "part", "worst.json", "study.json"), ("result.json", "part")
    ),
)
def test_every_flipped_bit_that_changes_data_is_found(written, kind, caplog):
    """A flip in white space or in unused bytes changes no data; all others are detected."""
    caplog.set_level(logging.CRITICAL)
    (subject,) = (s for s in written if s.kind == kind)
    found = [subject.flip(place) for place in places(subject, examples(40, 100), seed=1)]
    assert sum(found) > 0.6 * len(found)
