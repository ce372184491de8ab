"""Options of a solve, and the record of how it went."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.arguments import one_of
from loadshare.contact.plan import Plan
from loadshare.settings import CONTACT

METHODS = ("newton", "picard", "power")


@dataclass(frozen=True, slots=True)
class Options:
    """How to solve.

    Attributes
    ----------
    solver : str
        Back-end: "clarabel", "osqp" or "cvxpy".
    method : str
        "newton" (tangent compliances), "picard" (secant compliances) or "power" (one power-cone
        programme).
    reduce : bool
        Whether to leave out what cannot matter (and verify it), or to put everything in play.
    polish : bool
        Whether to solve exactly on the identified active set. Otherwise the back-end's bare answer
        is taken, which hardly ever passes the certificate; it serves comparisons.
    stop : float
        Outer loop: largest misfit of laws, faces and friction bounds, in units of deflection and
        load.
    max_iterations : int
        Passes of the outer loop before the other method is tried.
    """

    solver: str = "clarabel"
    method: str = "newton"
    reduce: bool = True
    polish: bool = True
    stop: float = CONTACT.stop
    max_iterations: int = CONTACT.iterations

    def __post_init__(self) -> None:
        one_of("method", self.method, METHODS)


@dataclass(frozen=True, slots=True)
class Iteration:
    """One pass of the outer loop.

    Attributes
    ----------
    kind : str
        Class of the programme.
    via : str
        How it was solved: "linear solve", "active set kept", "<solver> + exact", with "proximal" if
        no active set could be read, "in place" if coordinates that forces leave open stay where the
        solver has them, "as shared" if forces that they leave open do so too.
    law, face, friction : float
        Misfits after the pass: compliance laws and ring faces [deflections], friction bounds
        [loads].
    step : float
        Fraction of the step that was taken.
    """

    kind: str
    via: str
    law: float
    face: float
    friction: float
    step: float

    @property
    def misfit(self) -> float:
        """Largest of the misfits."""
        return max(self.law, self.face, self.friction)


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """How an equilibrium was found.

    Attributes
    ----------
    solver, method : str
        The ones used in the end.
    kind : str
        Class of the last programme.
    iterations : tuple of Iteration
        Passes of the last plan.
    plan : Plan
    rounds : int
        Number of plans tried.
    removed : tuple of (str, str)
        What was left out of the last plan, and why.
    coordinates : tuple of str
        Coordinates of the programme.
    """

    solver: str
    method: str
    kind: str
    iterations: tuple[Iteration, ...]
    plan: Plan
    rounds: int
    removed: tuple[tuple[str, str], ...]
    coordinates: tuple[str, ...]
