"""A case's programme, for users who want to solve it themselves or to see what is solved."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from loadshare.array_types import shaped
from loadshare.case import Case
from loadshare.certify import certify
from loadshare.contact.backends.conic import ConicForm, conic_form
from loadshare.contact.findings import Unsolved
from loadshare.contact.forms import (
    ComplementarityForm,
    QuadraticForm,
    complementarity_form,
    quadratic_form,
)
from loadshare.contact.inner import solve_near
from loadshare.contact.outer import Settled, tangent_compliances
from loadshare.contact.plan import Linearisation, Plan, Units, programme
from loadshare.contact.programme import Point, Programme
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.ladder import uncertified
from loadshare.job.positions import explain
from loadshare.scene import Scene
from loadshare.settings import JOB
from loadshare.solver.position import coordinates_of, equilibrium_of
from loadshare.view import View, Viewed

if TYPE_CHECKING:
    from loadshare.contact.backends.cvxpy_ import CvxpyForm

READ = "read back"
"""Rung of an answer that a user's solver found."""


@dataclass(frozen=True, eq=False, repr=False)
class Formulation(Viewed):
    """The programme of a case at one position, and the way back from its answer.

    Attributes
    ----------
    programme : Programme
        Dimensionless: named unknowns, rows and cones.
    units : Units
        Its units in newtons and metres.
    removed : tuple of (str, str)
        Elements that are not in it, and why; each was verified at the equilibrium.
    scene : Scene
        The whole contact problem, in newtons and metres, nothing left out.
    plan : Plan
    at : Linearisation
        Tangents of nonlinear laws and faces of arcs: those of the equilibrium.
    answer : Answer
        The certified equilibrium.
    """

    programme: Programme
    units: Units
    removed: tuple[tuple[str, str], ...]
    scene: Scene = field(compare=False)
    plan: Plan
    at: Linearisation = field(compare=False)
    answer: Answer

    def qp(self) -> QuadraticForm:
        """Return min ½zᵀPz + qᵀz with l ≤ Az ≤ u.

        Raises
        ------
        ValueError
            If there are radial elements or exact Hertz laws, which a QP cannot express.
        """
        return quadratic_form(self.programme)

    def lcp(self) -> ComplementarityForm:
        """Return w = Mz + q ≥ 0 with z ≥ 0 and zᵀw = 0.

        Raises
        ------
        ValueError
            As `qp`.
        """
        return complementarity_form(self.programme)

    def conic(self) -> ConicForm:
        """Return min ½zᵀPz + qᵀz with Az + s = b and s in a product of cones."""
        return conic_form(self.programme)

    def cvxpy(self) -> CvxpyForm:
        """Return the programme as a CVXPY problem."""
        from loadshare.contact.backends.cvxpy_ import cvxpy_form

        return cvxpy_form(self.programme)

    def read(self, point: Point) -> Answer:
        """Turn an answer of the programme into a certified equilibrium.

        The active set is read from it and solved exactly, so that an answer of a few digits is
        enough.

        Parameters
        ----------
        point : Point
            As the `point` of any of the forms gives it.

        Raises
        ------
        TypeError, ValueError
            If it is no point of this programme.
        Refused
            If no consistent active set is found, or the certificate does not pass.
        """
        if not isinstance(point, Point):
            given = type(point).__name__
            raise TypeError(f"a point as the `point` of a form gives it is needed, not {given}")
        near = Point(
            shaped("x", point.x, self.programme.load.shape),
            shaped("forces", point.forces, self.programme.gaps.shape),
            shaped("cone_forces", point.cone_forces, (len(self.programme.cones), 2)),
        )
        try:
            found, _ = solve_near(self.programme, near)
        except Unsolved as failure:
            raise Refused(f"position {self.answer.equilibrium.index}: {failure}") from failure
        units = self.units
        forces = found.forces * units.force / units.row_norms
        pulls = found.cone_forces * units.force
        settled = Settled(
            units.condensation.expand(found.x * units.length),
            dict(zip(self.programme.names, forces.tolist(), strict=True)),
            {c.name: p for c, p in zip(self.programme.cones, pulls, strict=True)},
            dict(self.at.radial_laws),
            self.programme.kind,
            (),
        )
        train, equilibrium = self.scene.train, equilibrium_of(self.scene, settled)
        certificate = certify(train, equilibrium)
        if not certificate.passed:
            raise uncertified(equilibrium.index, certificate)
        return Answer.of(train, equilibrium, certificate, self.answer.record, READ)

    def _view(self) -> View:
        from loadshare.job.views import formulation_view

        return formulation_view(self)


def formulate(
    case: Case | str | Path,
    position: int = 1,
    *,
    reduce: bool = True,
    exact_hertz: bool = False,
) -> Formulation:
    """Write the programme whose answer is the equilibrium of a case.

    The case is solved first. The programme is convex: arcs of limit rings are replaced by their
    tangent faces at the equilibrium, nonlinear laws by their tangents (by the secant up to a tiny
    force where they carry none), friction that follows a torque by the bound at that torque. So its
    answer is the equilibrium itself.

    Parameters
    ----------
    case : Case, str or Path
    position : int
        1-based.
    reduce : bool
        Whether to leave out what cannot matter, with the reason in `removed`, or to write
        everything.
    exact_hertz : bool
        Whether to keep laws b F + c F^(2/3) as they are, as power cones.

    Returns
    -------
    Formulation

    Raises
    ------
    CaseError, Refused, ValueError
        As :func:`loadshare.solve`.
    """
    answer = explain(case, position, solver="clarabel", reduce=reduce)
    scene, found, record = answer.scene, answer.equilibrium, answer.record
    forces = {**found.flank_force, **found.ring_force}
    x = coordinates_of(scene, found)
    at = Linearisation(
        x,
        tangent_compliances(scene, forces, JOB.least * scene.force_unit()),
        {r.name: r.law(r.torque(forces), x) for r in scene.radials},
    )
    written, units = programme(scene, record.plan, at, exact_hertz=exact_hertz)
    return Formulation(written, units, record.removed, scene, record.plan, at, answer)
