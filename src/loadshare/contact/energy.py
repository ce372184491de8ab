"""The true potential energy of a plan, which the Newton form of the outer loop lowers."""

from __future__ import annotations

from loadshare.array_types import Array
from loadshare.contact.plan import Plan, Role
from loadshare.contact.problem import ContactProblem
from loadshare.contact.radial import RadialLaw


def potential(problem: ContactProblem, plan: Plan, laws: dict[str, RadialLaw], x: Array) -> float:
    """Return ½xᵀHx − fᵀx + Σ U + Σ W [J] of all in play, rigid contacts taken as satisfied."""
    total = float(0.5 * x @ problem.stiffness @ x - problem.load @ x)
    for row in problem.rows_at(x):
        role = plan.rows[row.name]
        if role is Role.OPEN:
            continue
        approach = float(row.vector @ x) - row.gap
        total += row.law.energy(abs(approach) if role is Role.CLOSED else approach)
    for radial in problem.radials:
        radius = radial.radius(x)
        law = laws[radial.name]
        if plan.radials[radial.name] is Role.IN_PLAY:
            total += law.energy(radius)
        elif law.pieces[0].force == 0.0:
            total += 0.5 * law.pieces[0].stiffness * radius**2
    return total
