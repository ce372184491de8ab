"""The interface of a peer: set up once for a workload, then called once per sample."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Protocol

from benchmarks.peers.form import Form
from benchmarks.peers.loop import Claim


class Peer(Protocol):
    """A way to solve the common problem.

    A peer that spends its time in compiled calls also has an attribute `clock`, which measures that
    time.
    """

    def prepare(self, form: Form) -> None:
        """Do the work that is common to all samples like this one."""

    def solve(self, form: Form) -> Claim:
        """Answer a sample.

        Raises
        ------
        Failure
            If the peer says that it has no answer.
        """


@dataclass(frozen=True, slots=True)
class Entry:
    """A peer in the list of peers.

    Attributes
    ----------
    name : str
    package : str
        Package that it needs, as imported.
    room : str
        Module with a function ``make(tolerance)``.
    tolerances : tuple of float
        Tolerances that are charted, loosest first; the last is best practice.
    kinds : frozenset of str
        "QP", "SOCP".
    note : str
        How it is used.
    slow : bool
        Whether it takes milliseconds, so that it gets fewer samples.
    reduced : bool
        Whether it is given only the contacts that act in some answer of the workload.
    """

    name: str
    package: str
    room: str
    tolerances: tuple[float, ...]
    kinds: frozenset[str]
    note: str
    slow: bool = False
    reduced: bool = False

    @property
    def missing(self) -> bool:
        """Whether its package is not installed."""
        from importlib.util import find_spec

        return find_spec(self.package) is None

    def make(self, tolerance: float) -> Peer:
        """Return the peer at a tolerance."""
        make: Callable[[float], Peer] = import_module(f"benchmarks.peers.{self.room}").make
        return make(tolerance)
