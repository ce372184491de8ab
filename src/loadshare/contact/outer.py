"""The outer loop, in which mesh laws, ring faces and friction bounds settle together.

*Picard* replaces each law by its secant compliance at the last force, *Newton* by its tangent. Both
stop when, at the answer of a programme, the laws, the ring faces and the friction bounds that the
programme used differ from the true ones by no more than a stated misfit, measured in deflections
and loads of the case. Source: formulation, section 7.

A tangent at vanishing force has infinite compliance, so a Newton step is taken at the force that
belongs to the *displacement* (which is finite and positive for a compressed flank), and a step that
does not reduce the misfit is shortened until the true energy, which is convex, falls. This makes
light loads converge.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.backends.backend import Backend
from loadshare.contact.energy import potential
from loadshare.contact.findings import StepBudget, Unsolved
from loadshare.contact.inner import Inner, solve_programme
from loadshare.contact.law import PowerLaw
from loadshare.contact.plan import Linearisation, Plan, Role, Units, programme
from loadshare.contact.problem import ContactProblem
from loadshare.contact.programme import Point
from loadshare.contact.radial import RadialLaw, RollingLaw
from loadshare.contact.record import Iteration, Options
from loadshare.settings import CONTACT


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """Answer of the outer loop in SI units.

    Attributes
    ----------
    x : ndarray, shape (n,)
        [m].
    forces : dict of row name to float
        [N], of the rows of the plan.
    radial_forces : dict of radial name to ndarray, shape (2,)
        Force along its offset [N], of the radials in play.
    laws : dict of radial name to RadialLaw
        At the settled torques.
    kind : str
    iterations : tuple of Iteration
    """

    x: Array
    forces: dict[str, float]
    radial_forces: dict[str, Array]
    laws: dict[str, RadialLaw]
    kind: str
    iterations: tuple[Iteration, ...]

    def pulls(self, problem: ContactProblem) -> dict[str, Array]:
        """Return the force of every radial element along its offset, whether in play or not."""
        idle = [r for r in problem.radials if r.name not in self.radial_forces]
        first = {r.name: self.laws[r.name].pieces[0].stiffness for r in idle}
        return self.radial_forces | {r.name: first[r.name] * r.offset(self.x) for r in idle}


@dataclass(slots=True)
class _State:
    """Point at which the loop linearises next."""

    x: Array
    forces: dict[str, float]
    torques: dict[str, float]


def settle(
    problem: ContactProblem,
    plan: Plan,
    backend: Backend,
    options: Options,
    method: str,
    work: StepBudget | None = None,
) -> Settled:
    """Run the outer loop on a plan.

    Parameters
    ----------
    problem : ContactProblem
    plan : Plan
    backend : Backend
    options : Options
    method : str
    work : StepBudget, optional
        Newton steps allowed; unlimited by default.

    Raises
    ------
    Unsolved
        If a programme has no answer, or the loop does not settle within the allowed iterations.
    ValueError
        If a spline's force would drop at the torque that it carries.
    """
    # Begin with every contact under the force unit, every spline under the whole input torque.
    pushes = dict.fromkeys(problem.laws, problem.force_unit())
    state = _State(np.zeros(problem.size), pushes, problem.first_torques())
    warm: Inner | None = None
    history: list[Iteration] = []
    last: Array | None = None
    while len(history) < options.max_iterations and not _stuck(history):
        laws = {r.name: r.law(state.torques[r.name], state.x) for r in problem.radials}
        compliances = _compliances(problem, state.forces, method)
        at = Linearisation(state.x, compliances, laws, wide=not history)
        written, units = programme(problem, plan, at, exact_hertz=method == "power")
        warm = solve_programme(written, backend, warm, options.polish, work)
        x = units.condensation.expand(warm.point.x * units.length)
        forces = _forces(written.names, warm.point, units)
        torques = {r.name: r.torque(forces) for r in problem.radials}
        law_misfit = max(
            _law_misfit(problem, at, x, forces, method), _wall_misfit(problem, laws, x, state.x)
        )
        face_misfit = _face_misfit(problem, plan, at, x, forces)
        friction_misfit = _friction_misfit(problem, state.torques, torques)
        step = 1.0
        if method == "newton" and history and law_misfit > history[-1].law > options.stop:
            step = _step(problem, plan, laws, state.x, x)
        now = Iteration(written.kind, warm.via, law_misfit, face_misfit, friction_misfit, step)
        history.append(now)
        if now.misfit <= options.stop or (_stalled(history) and now.misfit <= CONTACT.stalled):
            return Settled(
                x,
                forces,
                {
                    c.name: f * units.force
                    for c, f in zip(written.cones, warm.point.cone_forces, strict=True)
                },
                {r.name: r.law(torques[r.name], x) for r in problem.radials},
                written.kind,
                tuple(history),
            )
        x = state.x + step * (x - state.x)
        if face_misfit >= max(law_misfit, friction_misfit):
            x, last = _extrapolated(problem, state.x, x, last)
        state = _State(x, _next_forces(problem, plan, state.forces, forces, x, method), torques)
    raise Unsolved(
        f"the {method} loop did not converge in {len(history)} passes "
        f"(last misfit {history[-1].misfit:.2e})"
    )


def _extrapolated(
    problem: ContactProblem, before: Array, x: Array, last: Array | None
) -> tuple[Array, Array | None]:
    """Return where faces are renewed next, and the move along the arcs for the pass after it.

    Where arcs take away nearly all stiffness across them, each pass moves along them by a fixed
    ratio, nearly 1, of the pass before: the remaining moves are a geometric series.
    """
    move = np.concatenate([[0.0], *(arc.relative @ (x - before) for arc in problem.arcs)])
    if last is None:
        return x, move
    lengths, along = float(np.linalg.norm(move) * np.linalg.norm(last)), float(move @ last)
    if along <= CONTACT.aligned * lengths:
        return x, move
    ratio = along / float(last @ last)
    if not CONTACT.slow < ratio < 1.0:
        return x, move
    ahead = min(ratio / (1.0 - ratio), CONTACT.ahead)
    return x + ahead * (x - before), None


def _compliances(
    problem: ContactProblem, forces: dict[str, float], method: str
) -> dict[str, tuple[float, float]]:
    """Return linear replacements of the laws: secants through 0 (Picard) or tangents (Newton)."""
    if method == "picard":
        return {n: (law.secant(forces[n]), 0.0) for n, law in problem.laws.items()}
    return {n: law.tangent(forces[n]) for n, law in problem.laws.items()}


def tangent_compliances(
    problem: ContactProblem, forces: Mapping[str, float], least: float
) -> dict[str, tuple[float, float]]:
    """Return compliances and offsets of the laws of all rows and arcs at some forces.

    They are those of tangents; contacts that carry nothing get the secant up to the least force,
    since a tangent there would let two bodies overlap that no force presses together.
    """
    return {
        n: law.tangent(forces[n]) if forces[n] else (law.secant(least), 0.0)
        for n, law in problem.laws.items()
    }


def _forces(names: tuple[str, ...], point: Point, units: Units) -> dict[str, float]:
    values = point.forces * units.force / units.row_norms
    return {n: float(f) for n, f in zip(names, values, strict=True)}


def _law_misfit(
    problem: ContactProblem, at: Linearisation, x: Array, forces: dict[str, float], method: str
) -> float:
    """Return the largest difference of laws from their replacements, at `forces` [deflections].

    A contact that carries nothing may overlap by the offset of its tangent.
    """
    worst = 0.0
    for row in problem.rows_at(x):
        exact = method == "power" and isinstance(row.law, PowerLaw)
        if row.name not in forces or row.law.is_linear or exact:
            continue
        force, (b, offset) = abs(forces[row.name]), at.compliance[row.name]
        if force == 0.0:
            worst = max(worst, float(row.vector @ x) - row.gap)
        else:
            worst = max(worst, abs(row.law.compression(force) - b * force - offset))
    return worst / problem.length_unit()


def _wall_misfit(
    problem: ContactProblem, laws: dict[str, RadialLaw], x: Array, before: Array
) -> float:
    """Return the largest difference of a bearing's law from its tangent, at x [deflections]."""
    worst = 0.0
    for radial in problem.radials:
        if isinstance(radial.source, RollingLaw):
            here, there = radial.radius(x), radial.radius(before)
            if here <= radial.source.clearance:
                continue
            wall, touched = laws[radial.name].pieces[-1], radial.law(0.0, x).pieces[-1]
            off = touched.stiffness / wall.stiffness - 1.0
            worst = max(worst, abs(off * (here - there)))
    return worst / problem.length_unit()


def _face_misfit(
    problem: ContactProblem, plan: Plan, at: Linearisation, x: Array, forces: dict[str, float]
) -> float:
    """Return the largest difference of arcs from the faces replacing them [deflections, loads]."""
    worst = 0.0
    for arc in problem.arcs:
        if plan.rows[arc.name] is Role.OPEN:
            continue
        relative = arc.relative @ x
        margin = arc.arc.margin(relative)
        force = forces[arc.name]
        if force == 0.0 and margin >= 0.0:
            continue
        normal, bound = arc.arc.face(arc.relative @ at.x)
        bound += arc.sagitta if at.wide else 0.0
        worst = max(worst, abs(margin - bound - float(normal @ relative)) / problem.length_unit())
        turned = float(np.linalg.norm(arc.arc.normal(relative) - normal))
        worst = max(worst, turned * abs(force) / problem.force_unit())
    return worst


def _friction_misfit(
    problem: ContactProblem, used: dict[str, float], found: dict[str, float]
) -> float:
    """Return the largest change of a friction bound that follows the torque [loads]."""
    changes = [abs(r.friction_change(used[r.name], found[r.name])) for r in problem.radials]
    return max(changes, default=0.0) / problem.force_unit()


def _step(
    problem: ContactProblem, plan: Plan, laws: dict[str, RadialLaw], before: Array, after: Array
) -> float:
    """Halve the step until the true energy falls."""
    here = potential(problem, plan, laws, before)
    step = 1.0
    while (
        step > CONTACT.least_step
        and potential(problem, plan, laws, before + step * (after - before)) > here
    ):
        step *= 0.5
    return step


def _next_forces(
    problem: ContactProblem,
    plan: Plan,
    before: dict[str, float],
    found: dict[str, float],
    x: Array,
    method: str,
) -> dict[str, float]:
    """Return the forces at which the laws are linearised next."""
    unit = problem.force_unit()
    forces = dict(before)
    for row in problem.rows_at(x):
        role = plan.rows[row.name]
        if role is Role.OPEN or row.law.is_linear:
            continue
        if method == "picard":
            forces[row.name] = max(abs(found[row.name]), CONTACT.faint * unit)
            continue
        approach = float(row.vector @ x) - row.gap
        if role is Role.CLOSED:
            approach = abs(approach)
        if approach > 0.0:
            forces[row.name] = max(row.law.force(approach), CONTACT.faint * unit)
        else:
            forces[row.name] = max(CONTACT.shrink * before[row.name], CONTACT.faint * unit)
    return forces


def _stalled(history: list[Iteration]) -> bool:
    """Return whether the misfit has stopped falling."""
    return len(history) > 3 and history[-1].misfit >= 0.5 * min(h.misfit for h in history[-4:-1])


def _stuck(history: list[Iteration]) -> bool:
    """Return whether the misfit has not been halved for many passes."""
    if len(history) <= CONTACT.stuck:
        return False
    least = min(h.misfit for h in history[: -CONTACT.stuck])
    return min(h.misfit for h in history[-CONTACT.stuck :]) > 0.5 * least
