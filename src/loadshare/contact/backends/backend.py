"""The one small interface of all solvers."""

from __future__ import annotations

from importlib import import_module
from typing import Protocol

from loadshare.arguments import one_of
from loadshare.contact.programme import Point, Programme


class BackendFailure(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """A solver gave no usable answer; the message says what it reported."""


class Backend(Protocol):
    """A solver of programmes.

    What it returns is a proposal: the active set is read from it and solved exactly, and the
    certificate judges the outcome. A back-end's own status is never trusted.
    """

    name: str
    kinds: frozenset[str]

    def solve(self, programme: Programme) -> Point:
        """Solve a programme whose kind is among `kinds`.

        Raises
        ------
        BackendFailure
            If the solver gives no point at all.
        """


KINDS_QP = frozenset({"linear", "QP"})
KINDS_CONIC = KINDS_QP | {"SOCP", "power cone"}

SOLVERS = ("clarabel", "osqp", "cvxpy")
"""Each is a class of that name, in a module of its own."""


def backend(name: str) -> Backend:
    """Return the back-end called `name`, importing its solver only now.

    Raises
    ------
    ValueError
        If there is no such back-end.
    """
    one_of("solver", name, SOLVERS)
    found: Backend = getattr(import_module(f"{__package__}.{name}_"), name.capitalize())()
    return found
