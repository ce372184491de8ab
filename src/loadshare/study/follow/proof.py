r"""Proof that a set holds on a stretch of the parameter.

Between two solved points the unknowns are enclosed around their chord. With A the inverse of the
Jacobian in the middle, a true branch z(s) lies within d of the chord z̃(s) if

.. math:: |V A\,G(\tilde z(s), s)| + |V A U^T|\,\rho(d)\,d \le d

for the quantities V z that the nonlinear laws depend on, whose forces enter through U and whose
slopes stay within ρ of those in the middle (Krawczyk's test, written for the few quantities that
are nonlinear). The residual of the chord vanishes at both ends, so a quarter of the range of its
derivative bounds it. Gauges are bounded likewise: one is positive throughout if its chord clears
zero by more than the enclosure, or if it leaves zero at one end and its derivative keeps its sign.

Laws and directions are enclosed over whole ranges. What the parameter itself changes (errors,
loads, clearances, compliances) is sampled at five values of a stretch; its derivative is taken to
lie in the range of their differences, doubled about its middle. Round-off is bounded by the size of
the terms. Source: formulation, section 16; Neumaier, Interval Methods, chapter 5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.settings import FOLLOW
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.equations import balanced, free_moves
from loadshare.study.follow.forces import Force, forces
from loadshare.study.follow.gauges import gauges
from loadshare.study.follow.ranges import sampled
from loadshare.study.follow.stretches import Stretches


class Proof(NamedTuple):
    """The outcome of a proof on stretches.

    Attributes
    ----------
    holds : ndarray of bool, shape (B,)
        Whether the set holds from end to end.
    enclosed : ndarray of bool, shape (B,)
        Whether there is an enclosure at all.
    """

    holds: Flags
    enclosed: Flags


def prove(s: Stretches) -> Proof:
    """Try to prove that a set holds on stretches, from end to end."""
    with np.errstate(all="ignore"):
        inverse, fixed = _inverse(s)
        enclosed, dev, bend = _enclosed(s, inverse)
        enclosed &= fixed
        holds = enclosed.copy()
        for gauge in gauges(s, dev, bend):
            holds &= gauge.holds(FOLLOW.verge)
    return Proof(holds, enclosed)


def _inverse(s: Stretches) -> tuple[Array, Flags]:
    """Return the inverse of the middle Jacobian, free moves held, and if nothing feels them."""
    jacobian = s.equations.jacobian(s.flat[s.middle], s.at_middle)
    jacobian = np.where(np.isfinite(jacobian), jacobian, 0.0)
    factor, scaled = balanced(jacobian)
    right, null = free_moves(scaled)
    moves = np.where(null[:, :, None], right, 0.0)
    if null.any():
        moves = _unmixed(s, moves, factor)
    held = scaled + moves.transpose(0, 2, 1) @ moves
    inverse = np.linalg.inv(held + 0.0)
    inverse = factor[:, :, None] * inverse * factor[:, None, :]
    return inverse, _unfelt(s, moves * factor[:, None, :], np.asarray(null.any(axis=1)))


def _acting(s: Stretches) -> Array:
    """Return the directions (B, k, n) in which elements act."""
    e = s.equations
    acting = [s.vectors[:, : e.scalars][:, e.acts]]
    acting += [s.own(e.matrix(k, s.at_middle)) for k in e.polar_at]
    return np.concatenate(acting, axis=1)


def _unmixed(s: Stretches, moves: Array, factor: Array) -> Array:
    """Remove from moves (B, size, size) what round-off mixed into them of barely resisted ones."""
    n = s.equations.n
    rows = _acting(s) * factor[:, None, :n]
    free = np.zeros_like(moves)
    free[:, :, :n] = moves[:, :, :n]
    across = np.linalg.pinv(rows, rcond=FOLLOW.unfelt) @ rows
    free[:, :, :n] -= free[:, :, :n] @ across.transpose(0, 2, 1)
    close = np.abs(free - moves).max(axis=2, keepdims=True) <= FOLLOW.mixed
    return np.where(close, free, moves)


def _unfelt(s: Stretches, moves: Array, loose: Flags) -> Flags:
    """Return whether no acting element or load feels the moves (B, size, size) held fixed."""
    if not loose.any():
        return np.ones(s.count, dtype=bool)
    e = s.equations

    def along(rows: Array) -> Array:
        parts = moves[:, :, : e.n] @ rows.transpose(0, 2, 1)
        return np.asarray(np.abs(parts).max(axis=(1, 2), initial=0.0))

    size = np.abs(moves).max(axis=(1, 2))
    felt = np.abs(moves[:, :, e.n :]).max(axis=(1, 2), initial=0.0)
    felt = np.maximum(felt, along(_acting(s)))
    load = s.split(s.numbers.load)
    push = np.abs(load).max(axis=(1, 2), initial=0.0)
    return np.asarray(
        ~loose | ((felt <= FOLLOW.unfelt * size) & (along(load) <= FOLLOW.unfelt * size * push))
    )


def _enclosed(s: Stretches, inverse: Array) -> tuple[Flags, Array, Array]:
    """Return whether an enclosure was found, with deviations of quantities and derivatives."""
    residual = s.equations.residual(s.flat, s.numbers, s.state)
    reach = s.inputs @ inverse
    across = reach.transpose(0, 2, 1)
    ends = np.abs(s.split(residual)[:, [0, -1]] @ across).max(axis=1)
    noise = FOLLOW.round_off * _roundings(s, reach)
    straight = sampled(_linear(s, residual) @ across)
    drift = _drift(s, reach)
    dev = FOLLOW.least_deviation * np.ones((s.count, s.width))
    done = np.zeros(s.count, dtype=bool)
    found = bend = np.full((s.count, s.width), np.inf)
    base = None
    for _ in range(FOLLOW.enclosures):
        into, slack, rates, spreads = _stacked(s, dev)
        through = reach @ into.transpose(0, 2, 1)
        spread = straight.spread + (np.abs(through) @ spreads[:, :, None])[:, :, 0]
        matrix = np.abs(through) @ slack + drift
        # The base is that of the chord itself, which does not deviate.
        base = ends + noise + 0.5 * spread if base is None else base
        fresh = base + (matrix @ dev[:, :, None])[:, :, 0]
        fits = (fresh <= dev).all(axis=1) & np.isfinite(fresh).all(axis=1) & ~done
        if fits.any():
            rate = np.abs(straight.rate + (through @ rates[:, :, None])[:, :, 0]) + spread
            found = np.where(fits[:, None], fresh, found)
            bend = np.where(fits[:, None], _contracted(matrix, rate, fits), bend)
            done |= fits
        if done.all():
            break
        dev = np.where(done[:, None], dev, _wider(matrix, base, fresh))
    return done & np.isfinite(bend).all(axis=1), found, bend


def _roundings(s: Stretches, reach: Array) -> Array:
    """Return how far round-off moves the quantities, (B, width), in units of the last digit.

    Errors of a displacement change a force along its direction. Where that is the direction in
    which a body is held well, they do not count in the other, in which vanishing forces hold it.
    """
    e = s.equations
    follows = np.isnan(s.numbers.radial[:, :, 3]) & (s.numbers.radial[:, :, 4] > 0.0)
    alike = (s.numbers.vectors == s.numbers.vectors[:1]).all()
    apart = bool(alike and not follows.any())
    sizes = s.split(e.sizes(s.flat, s.numbers, s.state, yields=not apart)).max(axis=1)
    found = (np.abs(reach) @ sizes[:, :, None])[:, :, 0]
    if not apart:
        return np.asarray(found)
    x = np.abs(s.flat[:, : e.n])
    moved = s.state.slope * e.lengths(x, s.numbers)
    through = np.abs(reach[:, :, : e.n] @ s.vectors[:, : e.scalars].transpose(0, 2, 1))
    found += (through @ s.split(moved).max(axis=1)[:, :, None])[:, :, 0]
    still = np.zeros((s.count, s.width))
    for k in e.polar_at:
        polar, columns = s.state.polars[k], s.columns[k]
        if e.states[k] == at.PINNED:
            continue
        around = s.around(k, still)
        length = (np.abs(polar.matrix) @ x[:, :, None])[:, :, 0].max(axis=1) + polar.radius
        length = s.split(length).max(axis=1)
        push, slope = (s.split(np.abs(v)).max(axis=1) for v in (polar.size, polar.slope))
        across = slope if e.states[k] == at.STICK else push / around.least + slope * around.turn
        pulls = np.abs(reach @ s.inputs[:, columns].transpose(0, 2, 1))
        found += (slope * length)[:, None] * pulls[:, :, 0]
        found += (across * length)[:, None] * pulls[:, :, 1:].sum(axis=2)
    return np.asarray(found)


def _stacked(s: Stretches, dev: Array) -> tuple[Array, Array, Array, Array]:
    """Return U, ρ, and derivatives along the chord with their spreads, of all forces that vary."""
    still = np.zeros((2, s.count))
    none = Force(*(np.zeros((s.count, n)) for n in (s.equations.size, s.width)), *still)
    every = list(forces(s, dev)) or [none]
    into, slack, rate, spread = (np.stack(part, axis=1) for part in zip(*every, strict=True))
    return into, slack, rate, spread


def _wider(matrix: Array, base: Array, fresh: Array) -> Array:
    """Return the deviations to try next: a little more than the last slopes require."""
    usable = np.asarray(np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(base).all(axis=1))
    solved = _series(
        np.where(usable[:, None, None], matrix, 0.0), np.where(usable[:, None], base, 1.0)
    )
    good = usable & (solved >= 0.0).all(axis=1)
    wider = np.where(good[:, None], solved, fresh)
    return np.asarray(
        np.minimum(FOLLOW.wider * np.nan_to_num(wider, nan=FOLLOW.widest) + 1e-300, FOLLOW.widest)
    )


def _contracted(matrix: Array, base: Array, these: Flags) -> Array:
    """Solve d = base + M d for d, where M contracts."""
    found = np.full(base.shape, np.inf)
    rows = np.flatnonzero(these)
    solved = _series(matrix[rows], base[rows])
    # A solution that is nonnegative bounds the series; it is enlarged a little for round-off.
    good = (solved >= 0.0).all(axis=1)
    found[rows[good]] = (1.0 + FOLLOW.more) * solved[good]
    return found


def _series(matrix: Array, base: Array) -> Array:
    """Solve d = base + M d for (B, k, k) and (B, k); NaN where there is no unique solution."""
    try:
        return np.asarray(np.linalg.solve(np.eye(base.shape[1]) - matrix, base[:, :, None])[..., 0])
    except np.linalg.LinAlgError:
        if len(base) == 1:
            return np.full(base.shape, np.nan)
        return np.concatenate([_series(matrix[[k]], base[[k]]) for k in range(len(base))])


def _linear(s: Stretches, residual: Array) -> Array:
    """Return the residual at the nodes, (B, NODES, size), without the parts whose slopes vary."""
    e = s.equations
    found = residual.copy()
    curved = s.state.force[:, e.curved]
    found[:, : e.n] -= (curved[:, None, :] @ s.numbers.vectors[:, e.curved])[:, 0]
    for k, where in s.turning():
        polar = s.state.polars[k]
        found[:, : e.n] -= (polar.force[:, None, :] @ polar.matrix)[:, 0]
        if where is not None:
            found[:, where] = 0.0
    return s.split(found)


def _drift(s: Stretches, reach: Array) -> Array:
    """Return what varying directions add to the contraction, (B, width, width)."""
    e = s.equations
    found = np.zeros((s.count, s.width, s.width))
    if len(s.numbers.vectors) == 1:
        return found
    z = s.flat[s.middle]
    middle = e.jacobian(z, s.at_middle)
    most = np.zeros_like(middle)
    for k in range(FOLLOW.nodes):
        there = s.numbers.take(s.middle - FOLLOW.nodes // 2 + k)
        most = np.maximum(most, np.abs(e.jacobian(z, there) - middle))
    found[:, :, s.z_in :] = np.abs(reach) @ (2.0 * most)
    return found
