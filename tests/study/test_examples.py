"""The examples in the docstrings are correct."""

import doctest
from importlib import import_module

import pytest
from tests.support import CASES, mostly_slow

ROOMS = (
    "compare",
    "critical",
    "fit",
    "march",
    "named",
    "sensitivity.study",
    "sweep",
    "tolerance.study",
)


@pytest.mark.parametrize("room", mostly_slow(ROOMS, set(ROOMS) - {"critical"}))
def test_examples(room, monkeypatch):
    monkeypatch.chdir(CASES.parent)
    module = import_module(f"loadshare.study.{room}")
    outcome = doctest.testmod(module)
    assert outcome.attempted > 0
    assert outcome.failed == 0
