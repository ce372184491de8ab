"""Contact problems without any gear: laws, radial graphs, arcs; programmes and their solvers.

A :class:`ContactProblem` is a set of springs, loads and contacts; :func:`solve_contact` finds and
judges its equilibrium. A :class:`~loadshare.contact.plan.Plan` says which contacts are in play, a
:class:`~loadshare.contact.programme.Programme` is what a solver sees, and
:func:`~loadshare.contact.outer.settle` goes from one to the next until laws and faces agree.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from loadshare.contact.arc import Arc
from loadshare.contact.law import RIGID, PowerLaw, TableLaw
from loadshare.contact.problem import ArcRow, ContactProblem, Radial, Row
from loadshare.contact.radial import Piece, RadialLaw

if TYPE_CHECKING:
    from loadshare.contact.answer import ContactAnswer, residuals, solve_contact

__all__ = [
    "RIGID",
    "Arc",
    "ArcRow",
    "ContactAnswer",
    "ContactProblem",
    "Piece",
    "PowerLaw",
    "Radial",
    "RadialLaw",
    "Row",
    "TableLaw",
    "residuals",
    "solve_contact",
]


def __getattr__(name: str) -> Any:
    """Import what solves only on demand: trains need the laws alone."""
    if name in ("ContactAnswer", "residuals", "solve_contact"):
        return getattr(import_module("loadshare.contact.answer"), name)
    raise AttributeError(f"module 'loadshare.contact' has no attribute {name!r}")
