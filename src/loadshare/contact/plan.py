"""Which parts of a contact problem are in play, and the programme that follows.

A plan starts from what a loaded train most likely does: drive flanks carry load, everything else is
idle. Elements that turn out otherwise are put in play, and the problem is solved again (*Leave out,
then check* in the design notes). Source: formulation, section 11.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.condense import Condensation, nothing_condensed
from loadshare.contact.law import PowerLaw
from loadshare.contact.problem import ContactProblem, Row
from loadshare.contact.programme import Cone, Programme
from loadshare.contact.radial import RadialLaw


class Role(Enum):
    """What a plan does with a row or a radial element."""

    OPEN = "removed: cannot touch here"
    CLOSED = "bilateral: carries load here"
    IN_PLAY = "in play"


@dataclass(frozen=True, slots=True)
class Plan:
    """Roles of all rows (arcs included) and radial elements, by name; condensed or not.

    A radial element that is not in play stays on its first piece: a linear spring (CLOSED), or
    nothing (OPEN).
    """

    rows: Mapping[str, Role]
    radials: Mapping[str, Role]
    condensed: bool = False

    @classmethod
    def full(cls, problem: ContactProblem) -> Plan:
        """Put everything in play."""
        radials = dict.fromkeys((r.name for r in problem.radials), Role.IN_PLAY)
        return cls(dict.fromkeys(problem.laws, Role.IN_PLAY), radials)

    @classmethod
    def lean(cls, problem: ContactProblem) -> Plan:
        """Take drive flanks as closed and everything else as idle."""
        closed = (r.name for r in problem.rows if r.kind == "drive flank")
        rows = dict.fromkeys(problem.laws, Role.OPEN) | dict.fromkeys(closed, Role.CLOSED)
        return cls(rows, {r.name: Role.CLOSED for r in problem.radials}, condensed=True)

    def with_in_play(self, names: set[str]) -> Plan:
        """Put the named rows and radial elements in play as well."""
        return replace(
            self,
            rows={n: Role.IN_PLAY if n in names else r for n, r in self.rows.items()},
            radials={n: Role.IN_PLAY if n in names else r for n, r in self.radials.items()},
        )


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    """Point at which the outer loop linearises.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Coordinates [m] at which arcs are replaced by faces.
    compliance : mapping of row name to (float, float)
        Linear compliance [m/N] and offset [m] that replace a nonlinear law.
    radial_laws : mapping of radial name to RadialLaw
        Laws at the current torques.
    wide : bool
        Whether faces of arcs are set back by their sagitta, as long as x is not yet an iterate.
    """

    x: Array
    compliance: Mapping[str, tuple[float, float]]
    radial_laws: Mapping[str, RadialLaw]
    wide: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Units:
    """Factors that turn a programme's numbers back into SI.

    Attributes
    ----------
    force, length : float
        [N], [m].
    row_norms : ndarray, shape (m,)
        Norms of the SI rows: a row's force is F̂ · force / norm.
    condensation : Condensation
        Gives all coordinates from those of the programme.
    """

    force: float
    length: float
    row_norms: Array
    condensation: Condensation


def programme(
    problem: ContactProblem, plan: Plan, at: Linearisation, exact_hertz: bool = False
) -> tuple[Programme, Units]:
    """Write the programme of a plan at a linearisation.

    Parameters
    ----------
    problem : ContactProblem
    plan : Plan
    at : Linearisation
    exact_hertz : bool
        Whether to keep b + c laws as they are (the power-cone form) instead of linearising them.

    Returns
    -------
    Programme
        Dimensionless, rows of unit norm.
    Units
    """
    force, length = problem.force_unit(), problem.length_unit()
    stiffness = problem.stiffness.copy()
    load = problem.load.copy()
    cones = []
    condensed = problem.condensation if plan.condensed else nothing_condensed(problem.size)
    for radial in problem.radials:
        law = at.radial_laws[radial.name]
        first = law.pieces[0]
        unbounded = len(law.pieces) == 1 and first.force == 0.0 and np.isinf(first.length)
        if plan.radials[radial.name] is Role.IN_PLAY and not unbounded:
            scaled = law.scaled(force, length)
            kept = radial.matrix[:, condensed.kept]
            cones.append(Cone(radial.name, kept, radial.centre / length, scaled))
        elif first.force == 0.0:
            stiffness += first.stiffness * radial.matrix.T @ radial.matrix
            load += first.stiffness * radial.matrix.T @ radial.centre
    rows = [
        r
        for r in problem.rows_at(at.x, at.wide)
        if plan.rows[r.name] is not Role.OPEN and r.vector.any()
    ]
    norms = np.array([float(np.linalg.norm(r.vector)) for r in rows])
    vectors = np.array([r.vector for r in rows]).reshape(len(rows), problem.size)
    expansion = condensed.expansion
    load -= stiffness @ condensed.constant
    linear, hertz, gaps = np.zeros(len(rows)), np.zeros(len(rows)), np.zeros(len(rows))
    for e, (row, norm) in enumerate(zip(rows, norms, strict=True)):
        b, c, offset = _compliance(row, at, exact_hertz)
        scaled_law = PowerLaw(b, c).scaled(force / norm, length * norm)
        linear[e], hertz[e] = scaled_law.b, scaled_law.c
        gaps[e] = (row.gap + offset) / (length * norm)
    return (
        Programme(
            coordinates=tuple(problem.coordinates[k] for k in condensed.kept),
            stiffness=expansion.T @ stiffness @ expansion * length / force,
            load=expansion.T @ load / force,
            names=tuple(r.name for r in rows),
            rows=vectors[:, condensed.kept] / norms[:, None],
            gaps=gaps,
            linear=linear,
            hertz=hertz,
            assumed_closed=np.array([plan.rows[r.name] is Role.CLOSED for r in rows], dtype=bool),
            cones=tuple(cones),
        ),
        Units(force, length, norms, condensed),
    )


def _compliance(row: Row, at: Linearisation, exact_hertz: bool) -> tuple[float, float, float]:
    """Return b [m/N], c [m/N^(2/3)] and the offset [m] of a row."""
    law = row.law
    if isinstance(law, PowerLaw) and (exact_hertz or law.is_linear):
        return law.b, law.c, 0.0
    b, offset = at.compliance[row.name]
    return b, 0.0, offset
