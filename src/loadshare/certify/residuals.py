"""The residuals of claimed equilibria (formulation, section 8), element by element.

Each is a list of blocks: figures, one row per element and one column per claim, and the names of
their elements. The worst of them counts; its element is looked up for single claims only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import TypeVar

import numpy as np

from loadshare.array_types import Array
from loadshare.certify.graphs import complementary, energy, interval, strength
from loadshare.certify.state import ClaimedState, size, times, total
from loadshare.settings import CERTIFY, EPS


@dataclass(frozen=True, slots=True)
class Residual:
    """One figure of a certificate.

    Attributes
    ----------
    value : float
        In `unit`.
    unit : str
    scaled : float
        Over the case's load, deflection, or both; dimensionless.
    where : str
        Element that shows the value.
    """

    value: float
    unit: str
    scaled: float
    where: str


Blocks = list[tuple[Array, tuple[str, ...]]]
Scalars = TypeVar("Scalars", float, Array)


def force_balance(state: ClaimedState) -> Blocks:
    """Return the unbalanced force [N] on gears that can be displaced."""
    of = state.of
    if not len(of.moving):
        return []
    balance = -times(of.bearing_pushing, state.claim.flank_force).reshape(-1, 2, state.count)
    balance -= state.support[1]
    if state.pushed is not None:
        balance += times(of.frames, state.pushed[1][of.moving])
    if len(of.drum) or of.pulls:
        balance += times(of.frames, pushed_by_rings(state)[of.moving])
    return [(size(balance), of.bearings)]


def pushed_by_rings(state: ClaimedState) -> Array:
    """Return forces [N] of rings, bearings with clearance and splines on gears, (gears, 3, S)."""
    of = state.of
    pushed = np.zeros((len(of.order), 3, state.count))
    for gear, force in zip(of.pulled, state.reaction if of.pulls else (), strict=True):
        pushed[gear] += force
    for d, gear in enumerate(of.drum):
        pushed[gear] += state.stop_push[d]
        for push, neighbour in zip(state.arc_push[d], of.neighbours[d], strict=True):
            pushed[gear] += push
            pushed[neighbour] -= push
    return pushed


def moment_balance(state: ClaimedState) -> Blocks:
    """Return unbalanced moments, over the largest base radius [N], of gears that turn as one."""
    of = state.of
    return [(np.abs(times(of.group_moment, state.moment)), of.turning_gears)]


def penetration(state: ClaimedState) -> Blocks:
    """Return the overlap [m] that a force of the claimed size does not explain."""
    blocks = [(state.overlap, state.of.contacts)]
    if state.of.pulls:
        beyond = np.where(np.isinf(state.graph.last), state.radius - state.graph.reach, 0.0)
        blocks.append((beyond, state.of.pulls))
    return _less_rounding(state, blocks)


def _less_rounding(state: ClaimedState, blocks: Blocks) -> Blocks:
    """Return lengths less their round-off."""
    return [(np.maximum(lengths - state.resolution, 0.0), names) for lengths, names in blocks]


def complementarity(state: ClaimedState) -> Blocks:
    """Return the work [J] of a force over an open gap."""
    rounding = np.abs(state.force) * state.resolution
    return [(-state.force * state.overlap - rounding, state.of.contacts)]


def deformation_law(state: ClaimedState) -> Blocks:
    """Return the misfit [m] of a compressed contact, a shaft or a bearing with its law.

    A contact with less force than the band counts as open and is judged by complementarity.
    """
    of = state.of
    misfit = np.where(state.force > CERTIFY.band * state.load, np.abs(state.overlap), 0.0)
    blocks = [(misfit, of.contacts)]
    if len(of.shaft):
        lag = np.abs(state.wind - state.torque / state.here.torsion)
        blocks.append((lag * of.radius[of.shaft[:, :1]], tuple(of.train.shafts)))
    if len(of.moving):
        stiffness, force = state.support
        held = stiffness > 0.0
        lag = np.where(held, state.moved - force / np.where(held, stiffness, 1.0), 0.0)
        blocks.append((size(lag), of.bearing_names))
    blocks.append((size(times(of.lift, state.claim.displacement)), of.gear_names))
    turned_to = np.abs(state.claim.rotation[of.held]) * of.radius[of.held][:, None]
    blocks.append((turned_to, tuple(f"gear {gear} rotation" for gear in of.train.held)))
    return _less_rounding(state, blocks)


def cone_membership(state: ClaimedState) -> Blocks:
    """Return the excess [N] of a force over what its contact or graph admits.

    Within a band about its radius, a corner of a graph admits the whole step of the force.
    """
    of, band = state.of, CERTIFY.band * state.deflection + state.resolution
    blocks = [(-state.force, of.contacts)]
    if len(of.moving):
        stiffness, force = state.support
        blocks.append((size(np.where(stiffness > 0.0, 0.0, force)), of.bearing_names))
    if len(of.squeezed):
        blocks.append((_squeezes(state, band), of.squeezed_names))
    if of.pulls:
        blocks.append((_beside_graphs(state, band), of.pulls))
    return blocks


def _beside_graphs(state: ClaimedState, band: Array) -> Array:
    """Return the excess [N] of the reactions of radial elements over what their graphs admit.

    Within the band about its centre an element has no direction; along the axis it never pulls.
    """
    radius, reaction = state.radius, state.reaction
    force = size(reaction)
    low, high = interval(state.graph, radius, band)
    outward = state.offset / np.where(radius > 0.0, radius, 1.0)[:, None]
    leaning = -(reaction * outward).sum(axis=1)
    out = radius > band
    along = np.where(out, leaning, force)
    sideways = size(reaction + leaning[:, None] * outward) - force * band / radius
    excess = np.maximum(low - along, along - high)
    lifting = size(times(state.of.lift[state.of.pulled], reaction))
    return np.asarray(np.maximum(np.maximum(excess, lifting), np.where(out, sideways, 0.0)))


def _squeezes(state: ClaimedState, band: Array) -> Array:
    """Return the force [N] across the two rigid arcs of a ring that a squeeze leaves open.

    A centre that touches both arcs, to within a length, may lie anywhere within y across them,
    where ε y + y²/2a is that length and ε the angle of the wedge; the directions of the two forces
    are known no better than y/a. The length is the overlap or opening of the two arcs; where the
    narrowest place of the wedge, ε²a/8 past its mouth, overlaps by less than the band [m], it is
    the band: a float that a large squeeze seems to hold would roll away through there. Neighbours
    that give way follow the float instead.
    """
    of = state.of
    drums = of.squeezed
    start = of.nominal[drums][..., None] + state.here.arc_shift[drums]
    wedge = size((start / size(start, axis=2)[:, :, None]).sum(axis=1))
    distance = of.distance[drums].min(axis=1)[:, None]
    squeeze = state.ring_force[drums, :2].min(axis=1)
    gaps = state.approach[len(of.flanks) :].reshape(-1, 4, state.count)[drums, :2]
    apart = np.abs(gaps).max(axis=1) + EPS * size(state.claim.displacement[of.drum[drums]])
    known = np.where(wedge**2 * distance > 8.0 * band, apart, band)
    return np.asarray(squeeze * turned(wedge, known, distance))


def turned(wedge: Scalars, band: Scalars, distance: Scalars) -> Scalars:
    """Return the angle [rad] to within which a band [m] fixes directions (see `_squeezes`).

    Parameters
    ----------
    wedge : float or ndarray
        ε [rad].
    band : float or ndarray
        [m].
    distance : float or ndarray
        a [m].
    """
    across = 2.0 * band / distance
    return across / (wedge + (wedge * wedge + across) ** 0.5)  # type: ignore[no-any-return]


def energy_gap(state: ClaimedState) -> Blocks:
    """Return potential plus complementary energy less work [J], beyond rounding: 0 at equilibrium.

    Bearings and rings may store far more energy against one another than the load brings in.
    """
    of, here, claim = state.of, state.here, state.claim
    stored = [*state.energies]
    work = [here.torque * claim.rotation, state.force * state.at_rest]
    if state.pushed is not None:
        moment, force = state.pushed
        work += [moment * claim.rotation, (force * claim.displacement).sum(axis=1)]
    if len(of.shaft):
        torsion = here.torsion[of.elastic]
        stored.append(0.5 * torsion * state.wind[of.elastic] ** 2)
        stored.append(0.5 * claim.shaft_torque[of.elastic] ** 2 / torsion)
        work.append(-state.torque * here.clocking)
    if len(of.moving):
        stiffness, force = state.support
        held = stiffness > 0.0
        dual = np.where(held, force**2 / np.where(held, stiffness, 1.0), 0.0)
        stored.append(0.5 * (stiffness * state.moved**2 + dual).sum(axis=1))
    if of.pulls:
        # A force beyond the strength of its graph is judged by cone membership.
        force = np.minimum(size(state.reaction), strength(state.graph))
        stored.append(energy(state.graph, state.radius))
        stored.append(complementary(state.graph, force))
        work.append((state.reaction * state.centres).sum(axis=1))
    if of.train.slip:
        stored.append(here.spline[:, 0] * (state.bend**2).sum(axis=1))
    held_in = sum(map(total, stored))
    gap = np.abs(held_in - sum(map(total, work)))
    sizes = held_in + sum(total(np.abs(part)) for part in work)
    forces = total(np.abs(state.force))
    if of.pulls:
        forces = forces + total(size(state.reaction))
    rounding = CERTIFY.rounded * sizes + state.resolution * forces + _unresolved(state)
    return [(np.maximum(gap - rounding, 0.0)[None], ("the whole train",))]


def _unresolved(state: ClaimedState) -> Array:
    """Return the energy [J] in the rounding of lengths, shape (S,).

    A nearly rigid element stores any amount of energy in a negligible length: K s (|d| + s) with
    the resolution s and the misfit d between a length and its force.
    """
    of, here, step = state.of, state.here, state.resolution
    near = state.approach > -step
    yields = state.tangent
    stiffness = np.where(near & (yields > 0.0), 1.0 / np.where(yields > 0.0, yields, 1.0), 0.0)
    found = total(stiffness * (np.abs(state.overlap) + step)) * step
    if len(of.shaft):
        torsion, turn = here.torsion[of.elastic], step / of.radius[of.shaft[of.elastic, :1]]
        lag = np.abs(state.wind[of.elastic] - state.claim.shaft_torque[of.elastic] / torsion)
        found = found + total(torsion * turn * (lag + turn))
    if len(of.moving):
        stiffness, force = state.support
        held = np.where(stiffness > 0.0, stiffness, 1.0)
        lag = np.where(stiffness > 0.0, np.abs(state.moved - force / held) + step, 0.0)
        found = found + total((stiffness * lag).reshape(-1, state.count)) * step
    if of.pulls:
        within = np.maximum(state.radius - step, 0.0)
        change = energy(state.graph, state.radius + step) - energy(state.graph, within)
        found = found + total(change)
    return np.asarray(found)


FIGURES: dict[str, tuple[Callable[[ClaimedState], Blocks], str]] = {
    "force_balance": (force_balance, "N"),
    "moment_balance": (moment_balance, "N"),
    "penetration": (penetration, "m"),
    "complementarity": (complementarity, "J"),
    "deformation_law": (deformation_law, "m"),
    "cone_membership": (cone_membership, "N"),
    "energy_gap": (energy_gap, "J"),
}
"""Function and unit of every residual."""
RESIDUALS = tuple(FIGURES)
"""Names of the residuals, in order."""


def scales(state: ClaimedState) -> dict[str, Array]:
    """Return the scale of every unit, shape (S,)."""
    return {"N": state.load, "m": state.deflection, "J": state.load * state.deflection}


def scaled_residuals(state: ClaimedState) -> Array:
    """Return all residuals (S, 7), in the order of `RESIDUALS`; infinite for faulty claims."""
    scale = scales(state)
    figures = np.stack([_worst(of(state)) / scale[unit] for of, unit in FIGURES.values()])
    bad = state.faulty | np.isnan(figures).any(axis=0)
    return np.where(bad, np.inf, figures).T


def _worst(blocks: Blocks) -> Array:
    """Return the largest figure of every claim (S or 1,), not below zero; NaN is worst of all."""
    largest = (figures.max(axis=0, initial=0.0) for figures, _ in blocks)
    return reduce(np.maximum, largest, np.zeros(1))


def worst_of_each(blocks: Blocks, claims: int) -> list[tuple[float, str]]:
    """Return the largest figure of every claim, not below zero, and the element that shows it.

    NaN is the worst of all.
    """
    worst = [(0.0, "")] * claims
    for figures, names in blocks:
        if len(names):
            largest = np.broadcast_to(figures.max(axis=0), claims).tolist()
            for row, figure in enumerate(largest):
                if not figure <= worst[row][0] and worst[row][0] < math.inf:
                    one = figures[:, row % figures.shape[1]]
                    at = int(one.argmax()) if math.isnan(figure) else first_of_largest(one)
                    worst[row] = math.inf if math.isnan(figure) else figure, names[at]
    return worst


def first_of_largest(figures: Array) -> int:
    """Return the index of the first largest figure; like elements may differ by round-off."""
    return int(np.argmax(figures >= (1.0 - CERTIFY.alike) * figures.max()))
