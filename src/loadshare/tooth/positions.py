"""Positions of the mesh cycle: where flanks first touch, and how far apart they are elsewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from loadshare.errors import LoadshareError
from loadshare.tooth.body import Array
from loadshare.tooth.contact import ContactLine, MeshPosition, PairGeometry
from loadshare.tooth.flank import dot, relative_curvature, unit
from loadshare.tooth.gap import Lines, least_gap

# The flanks touch when the least gap is below this [m]: a thousandth of the gap that a
# transmission error of 1e-9 rad makes at a base radius of 0.1 m.
TOUCHING = 1e-13


class Pair(Lines, PairGeometry, Protocol):
    """A pair of gears with its contact lines."""


class NoContactError(LoadshareError):
    """At some position of the mesh cycle no pair of teeth is within both active flanks."""


def position(pair: Pair, phase: float, points_per_line: int) -> MeshPosition:
    """Unloaded contact at one phase.

    Parameters
    ----------
    pair : Pair
        The two gears.
    phase : float
        0 ≤ phase < 1 of the mesh cycle.
    points_per_line : int
        Points on every contact line.

    Returns
    -------
    MeshPosition
        With index 0.

    Raises
    ------
    ValueError
        If `phase` or `points_per_line` is out of range.
    NoContactError
        If no pair of teeth is within both active flanks.
    """
    if not 0.0 <= phase < 1.0:
        raise ValueError(f"phase = {phase} is not within the mesh cycle: give 0 ≤ phase < 1")
    if points_per_line < 1:
        raise ValueError(f"points_per_line = {points_per_line}: give at least 1")
    ideal, driven = pair.ideal(phase)
    error = transmission_error(pair, phase)
    driver = ideal + error
    pairs, start, end = pair.extents(driver, driven)
    part = (end - start) / points_per_line
    stations = start[:, None] + part[:, None] * (np.arange(points_per_line) + 0.5)
    trace = pair.trace(pairs, stations, driver, driven)
    along = unit(trace.tangent)
    across = np.cross(trace.driver.normal, along)
    length = part[:, None] * np.sqrt(dot(trace.tangent, trace.tangent))
    curvature = relative_curvature(trace.driver, trace.driven, across)
    curvature_along = relative_curvature(trace.driver, trace.driven, along)
    driver_uw = _located(pair, "driver", trace.driver.point, driver)
    driven_uw = _located(pair, "driven", trace.driven.point, driven)
    lines = tuple(
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
        for i, number in enumerate(pairs)
    )
    return MeshPosition(0, phase, driver, driven, error, lines)


def positions(pair: Pair, count: int, points_per_line: int) -> tuple[MeshPosition, ...]:
    """Unloaded contact at `count` equal steps of the mesh cycle, from phase 0."""
    return tuple(
        replace(position(pair, index / count, points_per_line), index=index)
        for index in range(count)
    )


def transmission_error(pair: Pair, phase: float) -> float:
    """Lead of the driver over the ideal pair when the first flanks touch [rad].

    The driver turns until the least gap over all lines is zero; each step is the least gap over
    the arm, and the lines move along.

    Raises
    ------
    NoContactError
        If no pair of teeth is within both active flanks.
    """
    driver, driven = pair.ideal(phase)
    error = 0.0
    for _ in range(20):
        pairs, start, end = pair.extents(driver + error, driven)
        if not len(pairs):
            raise NoContactError(
                f"no pair of teeth is in contact at phase {phase:.4g} of the mesh cycle: "
                "no contact line lies within both active flanks. Make the misalignment smaller, "
                "or the addenda or the face widths larger"
            )
        gap, _ = least_gap(pair, pairs, start, end, driver + error, driven)
        error += float(gap.min()) / pair.arm
        if abs(gap.min()) < TOUCHING:
            break
    return error


def _located(pair: Pair, which: str, points: Array, rotation: float) -> Array:
    body = pair.driver if which == "driver" else pair.driven
    return np.stack(body.locate(body.to_body(points, rotation)), axis=-1)
