"""Solution of one position: plans from lean to full, each verified at its answer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.backends.backend import Backend, backend
from loadshare.contact.findings import StepBudget, Unsolved
from loadshare.contact.outer import Settled, settle
from loadshare.contact.plan import Plan, Role
from loadshare.contact.record import Options, Record
from loadshare.errors import Refused
from loadshare.later import Later
from loadshare.scene.scene import Scene
from loadshare.settings import CONTACT, PLACES
from loadshare.solver.undetermined import free_set, places
from loadshare.solver.undetermined.places import Places
from loadshare.train.equilibrium import Equilibrium, Range
from loadshare.train.memory import SlipFriction


@dataclass(slots=True)
class SceneResults:
    """Results of plans of a scene with a back-end, and the work that is left for further plans.

    Attributes
    ----------
    settled : dict of plan to Settled or Unsolved
    work : StepBudget
        Newton steps left to all plans together; each may take half of them.
    each : float
        Newton steps allowed to every plan, whatever the others took.
    """

    settled: dict[tuple[object, ...], Settled | Unsolved] = field(default_factory=dict)
    work: StepBudget = field(default_factory=StepBudget)
    each: float = math.inf


def solve_scene(
    scene: Scene, options: Options, known: SceneResults | None = None
) -> tuple[Equilibrium, Record]:
    """Find the equilibrium of a scene.

    Parameters
    ----------
    scene : Scene
    options : Options
    known : SceneResults, optional
        Results of plans of this scene with this back-end, to be added to: none is settled twice.

    Returns
    -------
    Equilibrium
        In SI units; not yet certified.
    Record

    Raises
    ------
    Refused
        If the scene has no equilibrium or none was found; the message names the elements.
    """
    solver = backend(options.solver)
    plan = Plan.lean(scene) if options.reduce else Plan.full(scene)
    known = known or SceneResults()
    rounds = 0
    while True:
        rounds += 1
        try:
            settled, method = _settle(scene, plan, solver, options, known)
        except Unsolved as failure:
            wider = _wider(scene, plan)
            if wider is None:
                raise Refused(f"position {scene.position}: {failure}") from failure
            plan = wider
            continue
        margins = _margins(scene, plan, settled)
        wrong = {name for name, (holds, _) in margins.items() if not holds}
        if not wrong:
            break
        plan = plan.with_in_play(wrong)
    coordinates = scene.coordinates
    removed = scene.removed
    if plan.condensed:
        kept = {coordinates[k] for k in scene.condensation.kept}
        removed += tuple((c, "only springs hold it") for c in coordinates if c not in kept)
        coordinates = tuple(c for c in coordinates if c in kept)
    removed += tuple((name, why) for name, (_, why) in margins.items())
    record = Record(
        options.solver,
        method,
        settled.kind,
        settled.iterations,
        plan,
        rounds,
        removed,
        coordinates,
    )
    return equilibrium_of(scene, settled), record


def _settle(
    scene: Scene, plan: Plan, solver: Backend, options: Options, known: SceneResults
) -> tuple[Settled, str]:
    """Run the outer loop, with the other method if the chosen one does not settle."""
    other = {"newton": "picard", "picard": "newton"}.get(options.method)
    try:
        return _once(scene, plan, solver, options, options.method, known), options.method
    except ValueError as error:
        raise Refused(f"position {scene.position}: {error}") from error
    except Unsolved:
        if other is None or all(r.law.is_linear for r in scene.rows):
            raise
    return _once(scene, plan, solver, options, other, known), other


def _once(
    scene: Scene, plan: Plan, solver: Backend, options: Options, method: str, known: SceneResults
) -> Settled:
    """Run the outer loop on a plan, unless that was done before."""
    key = (*plan.rows.values(), *plan.radials.values(), plan.condensed, method)
    if key not in known.settled:
        try:
            work = known.work.half() if math.isinf(known.each) else StepBudget(known.each)
            known.settled[key] = settle(scene, plan, solver, options, method, work)
        except Unsolved as failure:
            known.settled[key] = failure
    found = known.settled[key]
    if isinstance(found, Unsolved):
        raise found
    return found


def _wider(scene: Scene, plan: Plan) -> Plan | None:
    """Return the plan to try next: with all limits in play, then with everything."""
    limits = {r.name for r in scene.rows if r.kind == "stop"}
    limits |= {a.name for a in scene.arcs} | {r.name for r in scene.radials}
    for names in (limits, set(plan.rows) | set(plan.radials)):
        wider = plan.with_in_play(names)
        if wider != plan:
            return wider
    return None


def _margins(scene: Scene, plan: Plan, settled: Settled) -> dict[str, tuple[bool, str]]:
    """Return, for everything left out, whether that was right, and the figure that shows it."""
    largest = max((abs(f) for f in settled.forces.values()), default=0.0)
    force = PLACES.verified * scene.force_unit() + CONTACT.sign_of_size * largest
    furthest = float(np.abs(settled.x).max(initial=0.0))
    length = PLACES.verified * scene.length_unit() + CONTACT.sign_of_size * furthest
    found: dict[str, tuple[bool, str]] = {}
    for row in scene.rows_at(settled.x):
        role = plan.rows[row.name]
        if role is Role.OPEN:
            gap = row.gap - float(row.vector @ settled.x)
            found[row.name] = (gap >= -length, f"open by {gap * 1e6:.4g} µm")
        elif role is Role.CLOSED:
            carried = settled.forces[row.name]
            why = f"closed under {carried:.6g} N: a spring, not an inequality"
            found[row.name] = (carried >= -force, why)
    for radial in scene.radials:
        if plan.radials[radial.name] is Role.IN_PLAY:
            continue
        first = settled.laws[radial.name].pieces[0]
        radius = radial.radius(settled.x)
        holds = first.force == 0.0 and radius <= first.length + length
        room = (first.length - radius) * 1e6
        found[radial.name] = (holds, f"{first.name}: {room:.4g} µm before the next piece")
    return found


def equilibrium_of(scene: Scene, settled: Settled) -> Equilibrium:
    """Return an answer in physical terms, of least norm where displacements are undetermined."""
    train = scene.train
    settled = _without_noise(scene, settled)
    pulls = settled.pulls(scene)
    found = places(free_set(scene, settled.x, settled.forces, pulls, settled.laws))
    flanks = {r.name for r in scene.rows if r.kind.endswith("flank")}
    contacts = [r.name for r in scene.rows if r.kind == "stop"] + [a.name for a in scene.arcs]
    reactions = {r.name: -pulls[r.name] @ train.gears[r.gear].frame for r in scene.radials}
    placed = Equilibrium(
        index=scene.position,
        rotation={g: scene.angle(g, found.x) for g in train.gears},
        displacement={g: scene.moved(g, found.x) for g in train.gears},
        flank_force={n: max(settled.forces.get(n, 0.0), 0.0) for n in sorted(flanks)},
        ring_force={n: max(settled.forces.get(n, 0.0), 0.0) for n in contacts},
        radial_reaction=reactions,
        undetermined=found.ranges,
    )
    # With memory, the forces of slips are not separated from those of their stops yet.
    return placed if train.slip is not None else with_ranges(placed, scene)


def coordinates_of(scene: Scene, found: Equilibrium) -> Array:
    """Return the coordinates (n,) [m] of an equilibrium."""
    x = np.zeros(scene.size)
    for name, r in scene.rotation.items():
        if r.index is not None:
            x[r.index] = (found.rotation[name] - scene.turned[name]) / r.rate
    for name, where in scene.displacement.items():
        x[where] = scene.train.gears[name].frame @ found.displacement[name]
    for radial in scene.radials:
        if isinstance(radial.source, SlipFriction):
            spline, frame = radial.source.spline, scene.train.gears[radial.gear].frame
            pull = [found.radial_reaction[n] for n in (spline.name, spline.stop_name)]
            slip = found.displacement[radial.gear] + sum(pull) / spline.bending_stiffness
            x += radial.matrix.T @ frame @ slip
    return x


def _without_noise(scene: Scene, settled: Settled) -> Settled:
    """Set all forces to zero if there is no load and round-off of the gaps explains them.

    They would be the largest of the case otherwise, and everything would be measured by them.
    """
    if any(scene.torques.values()):
        return settled
    stiffest = [abs(r.gap) / b for r in scene.rows if (b := r.law.secant(1.0)) > 0.0]
    noise = PLACES.noise * max(stiffest, default=0.0)
    every = [
        *settled.forces.values(),
        *(float(np.linalg.norm(f)) for f in settled.radial_forces.values()),
    ]
    if max(map(abs, every), default=0.0) > noise:
        return settled
    return replace(
        settled,
        forces=dict.fromkeys(settled.forces, 0.0),
        radial_forces={n: np.zeros(2) for n in settled.radial_forces},
    )


def of_least_norm(scene: Scene, found: Equilibrium) -> Equilibrium:
    """Return the same equilibrium at its place of least norm, with ranges of what is undetermined.

    Torques and forces stay as they are.
    """
    gears, x = scene.train.gears, coordinates_of(scene, found)
    least = _places_of(scene, found, x)
    if least.x is x:
        return replace(found, undetermined=least.ranges)
    return replace(
        found,
        rotation={g: scene.angle(g, least.x) for g in gears},
        displacement={g: scene.moved(g, least.x) for g in gears},
        undetermined=least.ranges,
    )


def with_ranges(found: Equilibrium, scene: Scene) -> Equilibrium:
    """Return an equilibrium with the ranges of the coordinates that its forces leave open.

    They follow from its own place, however that was found, as in the check of a loaded result.
    """
    return replace(found, undetermined=Later(lambda: ranges_of(found, scene)))


def ranges_of(found: Equilibrium, scene: Scene) -> Mapping[str, Range]:
    """Return least and largest values of what the forces of an equilibrium leave undetermined."""
    return _places_of(scene, found, coordinates_of(scene, found)).ranges


def _places_of(scene: Scene, found: Equilibrium, x: Array) -> Places:
    gears, forces = scene.train.gears, {**found.flank_force, **found.ring_force}
    pulls = {r.name: -gears[r.gear].frame @ found.radial_reaction[r.name] for r in scene.radials}
    laws = {
        r.name: r.law(scene.train.transmitted(r.gear, found.flank_force), x) for r in scene.radials
    }
    return places(free_set(scene, x, forces, pulls, laws))
