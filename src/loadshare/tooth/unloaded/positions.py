"""Positions of the mesh cycle: where flanks first touch, and how far apart they are elsewhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.geometry.body import Array, ToothBody
from loadshare.tooth.geometry.flank import cross, dot, relative_curvature, unit
from loadshare.tooth.geometry.gap import FEWEST, Extents, Lines, NoContactError, Trace, least_gap
from loadshare.tooth.unloaded.contact import ContactLine, MeshPosition, PairGeometry

# The flanks touch when the least gap is below this [m]: a hundredth of the gap that a
# transmission error of 1e-9 rad makes at a base radius of 0.1 m.
TOUCHING = 1e-12


class Pair(Lines, PairGeometry, Protocol):
    """A pair of gears with its contact lines."""


def position(pair: Pair, phase: float, points_per_line: int) -> MeshPosition:
    """Unloaded contact at one phase; see :func:`positions`."""
    return positions(pair, [phase], points_per_line)[0]


def positions(
    pair: Pair, phases: int | Sequence[float], points_per_line: int
) -> tuple[MeshPosition, ...]:
    """Unloaded contact at several phases, all at once.

    Parameters
    ----------
    pair : Pair
        The two gears.
    phases : int or sequence of float
        Number of equal steps of the mesh cycle, or phases of it, 0 ≤ phase < 1.
    points_per_line : int
        Points on every contact line.

    Raises
    ------
    ValueError
        If a phase or `points_per_line` is out of range.
    NoContactError
        If no pair of teeth is within both active flanks at one of the phases.
    """
    if isinstance(phases, int):
        phases = [index / phases for index in range(phases)]
    wrong = [phase for phase in phases if not 0.0 <= phase < 1.0]
    if wrong:
        raise ValueError(f"phase = {wrong[0]} is not within the mesh cycle: give 0 ≤ phase < 1")
    if points_per_line < 1:
        raise ValueError(f"points_per_line = {points_per_line}: give at least 1")
    error, found, trace = touching(pair, phases, points_per_line)
    part = (found.end - found.start) / points_per_line
    along = unit(trace.tangent)
    across = cross(trace.driver.normal, along)
    length = part[:, None] * np.sqrt(dot(trace.tangent, trace.tangent))
    curvature = relative_curvature(trace.driver, trace.driven, across)
    curvature_along = relative_curvature(trace.driver, trace.driven, along)
    driver_uw = _located(pair.driver, trace.driver.point, found.driver)
    driven_uw = _located(pair.driven, trace.driven.point, found.driven)
    lines = [
        ContactLine(
            int(number),
            trace.driver.point[i],
            trace.driver.normal[i],
            length[i],
            trace.gap[i],
            curvature[i],
            curvature_along[i],
            driver_uw[i],
            driven_uw[i],
        )
        for i, number in enumerate(found.pairs)
    ]
    made = []
    for k, phase in enumerate(phases):
        own = np.flatnonzero(found.position == k)
        rotations = float(found.driver[own[0]]), float(found.driven[own[0]])
        own_lines = tuple(lines[i] for i in own)
        made.append(MeshPosition(k, phase, *rotations, float(error[k]), own_lines))
    return tuple(made)


def transmission_error(pair: Pair, phase: float) -> float:
    """Lead of the driver over the ideal pair when the first flanks touch [rad].

    Raises
    ------
    NoContactError
        If no pair of teeth is within both active flanks.
    """
    return float(touching(pair, [phase])[0][0])


def touching(
    pair: Pair, phases: Sequence[float], points: int = FEWEST
) -> tuple[Array, Extents, Trace]:
    """Where the first flanks touch.

    The driver turns until the least gap over all lines of a position is zero; each step is the
    least gap over the arm, and the lines move along.

    Returns
    -------
    error : array (k,)
        Transmission errors [rad].
    found : Extents
        The lines there.
    trace : Trace
        Both flanks in the middles of `points` equal parts of every line.

    Raises
    ------
    NoContactError
        If no pair of teeth is within both active flanks at one of the phases.
    """
    driver, driven = pair.ideal(np.array(phases))
    error = np.zeros(len(phases))
    for _ in range(20):
        found = pair.extents(driver + error, driven)
        for k, phase in enumerate(phases):
            if k not in found.position:
                here = (driver[k : k + 1] + error[k : k + 1], driven[k : k + 1])
                raise NoContactError(
                    f"no pair of teeth is in contact at phase {phase:.4g} of the mesh cycle: "
                    f"{_missed(pair.margins_about(*here), pair.arm)}"
                )
        least = np.full(len(phases), np.inf)
        gap, _, trace = least_gap(found, points)
        np.minimum.at(least, found.position, gap)
        apart = np.abs(least) >= TOUCHING
        if not apart.any():
            return error, found, trace
        error = error + np.where(apart, least / pair.arm, 0.0)
    found = pair.extents(driver + error, driven)
    return error, found, least_gap(found, points)[2]


def _missed(margins: Mapping[str, Array], far: float) -> str:
    """What ends the flanks short of one another, where they miss by the least; `far` is no miss."""
    names, values = list(margins), np.stack([np.ravel(part) for part in margins.values()])
    values = np.where(np.isfinite(values), values, -np.inf)
    worst = values.min(axis=0)
    nearest = int(np.argmax(worst))
    edge, short = names[int(np.argmin(values[:, nearest]))], -1e3 * float(worst[nearest])
    if not short < 1e3 * far:
        return "the flanks are nowhere near one another"
    return f"the nearest contact line misses the active flanks by {short:.3g} mm at the {edge}"


def between(first: Array, last: Array) -> tuple[NDArray[np.int64], Array]:
    """Whole numbers from `first` to `last` (k,): the place in them, and the number (m,)."""
    low, high = np.ceil(first), np.floor(last)
    numbers = np.arange(low.min(), high.max() + 1.0)
    place, at = np.nonzero((numbers >= low[:, None]) & (numbers <= high[:, None]))
    return place, numbers[at]


def _located(body: ToothBody, points: Array, rotation: Array) -> Array:
    return np.stack(body.locate(body.to_body(points, rotation[:, None])), axis=-1)
