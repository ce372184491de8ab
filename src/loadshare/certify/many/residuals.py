"""The residuals of many claimed equilibria (formulation, section 8), each the train's worst."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.certificate import BAND
from loadshare.certify.many.bench import Bench
from loadshare.certify.many.graphs import complementary, energy, interval
from loadshare.certify.many.layout import size, times
from loadshare.certify.state import EPS, turned

Array = NDArray[np.float64]


def scaled_residuals(bench: Bench) -> Array:
    """All residuals (S, 7), in the order of `RESIDUALS`; infinite where none can be judged."""
    load, deflection = bench.load, bench.deflection
    work = load * deflection
    figures = np.stack(
        [
            force_balance(bench) / load,
            moment_balance(bench) / load,
            penetration(bench) / deflection,
            complementarity(bench) / work,
            deformation_law(bench, BAND * load) / deflection,
            cone_membership(bench, BAND * deflection) / load,
            energy_gap(bench) / work,
        ]
    ).T
    bad = bench.fault | np.isnan(figures).any(axis=1)
    for claimed in bench.answers.arrays:
        bad |= ~np.isfinite(claimed.sum(axis=tuple(range(1, claimed.ndim))))
    return np.where(bad[:, None], np.inf, figures)


def force_balance(bench: Bench) -> Array:
    """Largest unbalanced force [N] on a gear that can be displaced."""
    pushes = bench.of.flat_pushing @ bench.force.T
    total = bench.ring_push - np.moveaxis(pushes.reshape(-1, 3, bench.count), -1, 0)
    for pull in bench.pulls:
        total[:, pull.gear] += pull.reaction
    worst = np.zeros(bench.count)
    for bearing in bench.bearings:
        balance = times(total[:, bearing.gear], bearing.frame.T) - bearing.force
        worst = np.fmax(worst, size(balance))
    return np.asarray(worst)


def moment_balance(bench: Bench) -> Array:
    """Largest unbalanced moment over base radius [N] on gears that turn as one."""
    worst = np.zeros(bench.count)
    held = bench.of.order[bench.train.output]
    for group in bench.of.groups:
        if held not in group:
            total = bench.moment[:, group].sum(axis=1)
            worst = np.fmax(worst, np.abs(total) / bench.of.radius[group].max())
    return worst


def penetration(bench: Bench) -> Array:
    """Deepest overlap [m] that a force of the claimed size does not explain."""
    worst = (bench.approach - bench.compression).max(axis=1, initial=0.0)
    allowed = bench.ring_wall * np.maximum(bench.ring_force, 0.0)
    worst = np.maximum(worst, (bench.ring_approach - allowed).max(axis=1, initial=0.0))
    for pull in bench.pulls:
        beyond = size(pull.offset) - pull.graph.reach
        worst = np.maximum(worst, np.where(np.isinf(pull.graph.last), beyond, 0.0))
    return np.asarray(worst)


def complementarity(bench: Bench) -> Array:
    """Largest work [J] of a force over an open gap."""
    work = bench.force * (bench.compression - bench.approach)
    forces = bench.ring_force
    rings = forces * (bench.ring_wall * np.maximum(forces, 0.0) - bench.ring_approach)
    return np.asarray(np.maximum(work.max(axis=1, initial=0.0), rings.max(axis=1, initial=0.0)))


def deformation_law(bench: Bench, band: Array) -> Array:
    """Largest misfit [m] of a compressed contact, shaft or bearing with its law.

    Parameters
    ----------
    bench : Bench
    band : ndarray, shape (S,)
        Force [N] below which a contact counts as open; complementarity judges it then.
    """
    least = band[:, None]
    misfit = np.where(bench.force > least, np.abs(bench.approach - bench.compression), 0.0)
    worst = misfit.max(axis=1, initial=0.0)
    off = np.abs(bench.ring_approach - bench.ring_wall * bench.ring_force)
    misfit = np.where(bench.ring_force > least, off, 0.0)
    worst = np.maximum(worst, misfit.max(axis=1, initial=0.0))
    for wind in bench.winds:
        off = np.abs(wind.angle - wind.torque / wind.stiffness)
        worst = np.maximum(worst, off * bench.of.radius[wind.first])
    for bearing in bench.bearings:
        held = bearing.stiffness > 0.0
        lag = bearing.moved - bearing.force / np.where(held, bearing.stiffness, 1.0)
        worst = np.maximum(worst, size(np.where(held, lag, 0.0)))
    moved = bench.answers.displacement
    for k, gear in enumerate(bench.train.gears.values()):
        off = moved[:, k]
        if gear.moves:
            off = off - times(off, gear.frame.T @ gear.frame)
        worst = np.maximum(worst, size(off))
    output = bench.of.order[bench.train.output]
    turned_to = np.abs(bench.answers.rotation[:, output]) * bench.of.radius[output]
    return np.asarray(np.maximum(worst, turned_to))


def cone_membership(bench: Bench, band: Array) -> Array:
    """Largest excess [N] of a force over what its contact or graph admits.

    Parameters
    ----------
    bench : Bench
    band : ndarray, shape (S,)
        Radius [m] within which a graph's corner admits its whole step.
    """
    worst = np.maximum(
        (-bench.force).max(axis=1, initial=0.0), (-bench.ring_force).max(axis=1, initial=0.0)
    )
    for bearing in bench.bearings:
        free = np.where(bearing.stiffness > 0.0, 0.0, bearing.force)
        worst = np.maximum(worst, size(free))
    worst = np.maximum(worst, _squeezes(bench, band))
    for pull in bench.pulls:
        radius, force = size(pull.offset), size(pull.reaction)
        low, high = interval(pull.graph, radius, band)
        outward = pull.offset / np.where(radius > 0.0, radius, 1.0)[:, None]
        leaning = -(pull.reaction * outward).sum(axis=1)
        along = np.where(radius > band, leaning, force)
        sideways = size(pull.reaction + leaning[:, None] * outward)
        sideways = np.where(radius > band, sideways - force * band / radius, 0.0)
        worst = np.maximum(worst, np.maximum(np.maximum(low - along, along - high), sideways))
    return np.asarray(worst)


def _squeezes(bench: Bench, band: Array) -> Array:
    """What the squeeze of opposed rigid arcs leaves open [N] (see `State.squeezes`)."""
    worst = np.zeros(bench.count)
    drums = bench.train.drums
    for d, ring in enumerate(drums):
        if not bench.of.squeezed(ring):
            continue
        nominal = bench.of.nominal[d]
        start = nominal + bench.situations.arc_shift[:, d]
        unit = start / np.sqrt((start**2).sum(axis=2))[:, :, None]
        wedge = size(unit.sum(axis=1))
        first = 2 * len(drums) + 2 * d
        squeeze = bench.ring_force[:, first : first + 2].min(axis=1)
        distance = float(size(nominal).min())
        apart = np.abs(bench.ring_approach[:, first : first + 2]).max(axis=1)
        apart = apart + EPS * size(bench.answers.displacement[:, bench.of.order[ring.gear]])
        known = np.where(wedge**2 * distance > 8.0 * band, apart, band)
        worst = np.maximum(worst, squeeze * turned(wedge, known, distance))
    return worst


def energy_gap(bench: Bench) -> Array:
    """Potential less complementary energy [J]: zero at an equilibrium."""
    gap = -(bench.situations.torque * bench.answers.rotation).sum(axis=1)
    gap = gap + (bench.primal + bench.dual - bench.force * bench.at_rest).sum(axis=1)
    forces, wall = np.maximum(bench.ring_force, 0.0), bench.ring_wall
    stored = np.where(
        (wall > 0.0) & (bench.ring_approach > 0.0),
        0.5 * bench.ring_approach**2 / np.where(wall > 0.0, wall, 1.0),
        0.0,
    )
    rings = stored + 0.5 * wall * forces**2 - bench.ring_force * bench.ring_at_rest
    gap += rings.sum(axis=1)
    for wind in bench.winds:
        if wind.is_elastic:
            stiffness, torque = wind.stiffness, wind.torque
            gap += 0.5 * stiffness * wind.angle**2 + 0.5 * torque**2 / stiffness
        gap += wind.torque * wind.clocking
    for bearing in bench.bearings:
        stiffness, held = bearing.stiffness, bearing.stiffness > 0.0
        dual = np.where(held, bearing.force**2 / np.where(held, stiffness, 1.0), 0.0)
        gap += 0.5 * (stiffness * bearing.moved**2 + dual).sum(axis=1)
    for pull in bench.pulls:
        gap += energy(pull.graph, size(pull.offset))
        gap += complementary(pull.graph, size(pull.reaction))
        gap -= pull.reaction @ pull.centre
    return np.asarray(np.abs(gap))
