"""Fallbacks for a step with memory, where programmes with and without held slips fail.

All of them are for friction with fixed bounds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from loadshare.contact.outer import Settled
from loadshare.contact.plan import Plan
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.hot import SEARCHED
from loadshare.scene import assemble
from loadshare.scene.assemble import scene_of
from loadshare.scene.loading import loading_of
from loadshare.scene.structure import structure_of
from loadshare.settings import MARCH
from loadshare.solver import Record, solve_scene
from loadshare.solver.hot.proximal import search
from loadshare.solver.position import equilibrium_of
from loadshare.study.memory.held import (
    if_certified,
    least_stop_force,
    slips_before,
    split_force,
    without_slips,
)
from loadshare.study.positions import BACKEND, certified
from loadshare.train.elements import Spline
from loadshare.train.gear import Vector
from loadshare.train.memory import SlipStop, slip_of
from loadshare.train.situations import situation_of
from loadshare.train.train import Train


def searched(train: Train, index: int) -> Answer | None:
    """Return a certified answer by the proximal search, if there is one.

    It handles only friction with fixed bounds, as elements of their own beside the bending shaft.
    """
    structure, situation = structure_of(train), situation_of(train, index)
    scene, loading = scene_of(structure, situation), loading_of(structure, situation)
    iterate, found = search(structure, loading)
    if not found.solved[0]:
        return None
    x = iterate.x[0] * structure.length
    try:
        laws = {r.name: r.law(0.0, x) for r in scene.radials}
    except ValueError:
        # A spline has no law with memory; the general programme reports why.
        return None
    force, row = iterate.force[0] * structure.force, structure.springs
    forces = dict(zip(structure.row_names, force[row:].tolist(), strict=False))
    columns = {r.name: structure.radial_column(j) for j, r in enumerate(scene.radials)}
    settled = Settled(
        x=x,
        forces=forces,
        radial_forces={name: force[k : k + 2] for name, k in columns.items()},
        laws=laws,
        kind="force method",
        iterations=(),
    )
    plan = Plan.full(scene)
    record = Record(
        SEARCHED, "force", settled.kind, (), plan, int(found.turns[0]), scene.removed,
        scene.coordinates,
    )  # fmt: skip
    return if_certified(train, equilibrium_of(scene, settled), record, SEARCHED)


def negligible_friction(train: Train, index: int) -> Answer | None:
    """Return a certified answer for negligible friction, if there is one.

    The step is solved without friction, which is then added against the change of each slip.
    """
    load = assemble(train, index).force_unit()
    bounds = [s.bound(0.0) for s in train.splines.values()]
    if not all(0.0 < b <= MARCH.negligible * load for b in bounds):
        return None
    free = {
        g: replace(s, friction_force=0.0, clearance=SlipStop(s).law(0.0).reach, stick_limit=None)
        for g, s in train.splines.items()
    }
    try:
        answer = certified(replace(train, splines=free), index)
    except Refused:
        return None
    found, reactions = answer.equilibrium, {}
    for gear, spline in train.splines.items():
        stop = found.radial_reaction[spline.stop_name]
        way = slip_of(free[gear], found) - slips_before(train)[gear]
        far = float(np.linalg.norm(way)) or 1.0
        friction = -spline.bound(0.0) / far * way
        pushes = float(np.linalg.norm(stop)) > spline.bound(0.0)
        reactions[spline.stop_name] = stop - friction if pushes else np.zeros(3)
        reactions[spline.name] = friction
    equilibrium = replace(found, radial_reaction={**found.radial_reaction, **reactions})
    return if_certified(train, equilibrium, answer.record, f"{answer.rung}, friction added")


def alternating(train: Train, index: int) -> Answer | None:
    """Return a certified answer by solving for displacements and slips in turn, if that converges.

    Each turn lowers a convex energy. Convergence is fast where the slips have little room, which is
    where active sets fail: the slip turns about a centre that is nearer than one step.
    """
    gears, slips = tuple(train.splines), dict(slips_before(train))
    for _ in range(MARCH.turns):
        scene = without_slips(assemble(train, index), gears, slips)
        try:
            found, record = solve_scene(scene, BACKEND)
        except Refused:
            return None
        other = {
            g: _slip_at(s, found.displacement[g], slips_before(train)[g])
            for g, s in train.splines.items()
        }
        change = max(float(np.linalg.norm(other[g] - slips[g])) for g in gears)
        far = max(float(np.linalg.norm(found.displacement[g])) for g in gears)
        if change <= MARCH.round_off * far:
            return if_certified(
                train, split_force(train, found, gears, slips), record, "slips in turn"
            )
        slips = other
    return None


def _slip_at(spline: Spline, place: Vector, before: Vector) -> Vector:
    """Return the s within its room that minimises ½ K_w |p − s|² + F_m |s − s₀|, given p and s₀."""
    stiffness, bound = spline.bending_stiffness, spline.bound(0.0)
    room = SlipStop(spline).law(0.0).reach
    force = stiffness * (place - before)
    size = float(np.linalg.norm(force))
    free = before + max(1.0 - bound / size, 0.0) * (place - before) if size > 0.0 else before
    if float(np.linalg.norm(free)) <= room or room == 0.0:
        return free if room > 0.0 else np.zeros(3)
    start = np.asarray(before)
    if float(np.linalg.norm(start)) >= room * (1.0 - MARCH.at_end):
        left = force - least_stop_force(force, start, bound)
        if float(np.linalg.norm(left)) <= bound * (1.0 + MARCH.round_off):
            return start
    # The slip is on the edge of its room, at an angle between those of s₀ and of p.
    out = place / float(np.linalg.norm(place))
    across = start - (start @ out) * out
    width = float(np.linalg.norm(across))
    if width == 0.0:
        return np.asarray(room * out)
    across /= width
    low, high = 0.0, float(np.arctan2(start @ across, start @ out))
    for _ in range(MARCH.halvings):
        angle = 0.5 * (low + high)
        slip = room * (np.cos(angle) * out + np.sin(angle) * across)
        along = np.cos(angle) * across - np.sin(angle) * out
        way = float(np.linalg.norm(slip - start))
        pull = bound / way * (slip - start) if way > 0.0 else np.zeros(3)
        if float((pull - stiffness * (place - slip)) @ along) > 0.0:
            high = angle
        else:
            low = angle
    return np.asarray(slip)
