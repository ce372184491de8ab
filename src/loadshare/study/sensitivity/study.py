"""Differentiate the certified equilibria of a case: `loadshare.sensitivity`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.job import Progress
from loadshare.job.positions import wanted_positions
from loadshare.results.share import coefficients
from loadshare.study.positions import loaded
from loadshare.study.sensitivity.corner import Corner
from loadshare.study.sensitivity.inputs import inputs_of
from loadshare.study.sensitivity.result import SIDES, Kink, Rates, Sensitivity
from loadshare.train import Train, build_train

TIE = 1e-9
"""Shares that differ by no more are both the largest."""


def sensitivity(
    case: Case | str | Path,
    inputs: str | Sequence[str] | None = None,
    *,
    positions: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> Sensitivity:
    """Differentiate torques, shares and floats with respect to inputs of a case.

    Parameters
    ----------
    case : Case or path
    inputs : str or sequence of str, optional
        Dotted key paths, or patterns in which a star stands for any name; a table or list means all
        numbers in it. All numbers of the case by default.
    positions : iterable of int, optional
        1-based positions; all by default.
    progress : Progress, optional
        Called after every input.

    Returns
    -------
    Sensitivity
        One-sided derivatives, which agree where the equilibrium stands on no verge. Where it does,
        `Sensitivity.kinks` says so.

    Raises
    ------
    CaseError
        If an input is not there or is no number, or cannot be varied on its own.
    Refused
        If a position has no certified equilibrium.

    Examples
    --------
    >>> import loadshare as ls
    >>> found = ls.sensitivity("cases/fgfbstts/limit_ring.toml", "rings.4.float", positions=[1])
    >>> rate = found.rates[1, "rings.4.float", "rising"].pair_share["7-10"]
    >>> f"{rate * 1e-6:.5f} per um"
    '-0.00564 per um'
    """
    case = loaded(case)
    train = build_train(case)
    chosen = wanted_positions(train, positions)
    named = inputs is not None
    found = inputs_of(case, inputs)
    corners = [Corner(train, position) for position in chosen]
    rates: dict[tuple[int, str, str], Rates] = {}
    error: dict[str, float] = {}
    skipped: list[tuple[str, str]] = []
    usable = []
    for done, item in enumerate(found, start=1):
        if progress is not None:
            progress(done, len(found))
        trains = lru_cache(maxsize=None)(
            lambda number, item=item: build_train(
                case.replace({item.key: item.value.at(number).text})
            )
        )
        try:
            for corner in corners:
                sides, worst = corner.rates(trains, item.value)
                error[item.key] = max(worst, error.get(item.key, 0.0))
                rates |= {(corner.position, item.key, s): r for s, r in sides.items()}
        except CaseError as refusal:
            if named:
                raise
            skipped.append((item.key, refusal.problems[0].message))
            continue
        usable.append(item)
    stages = {
        kind: {
            (item.key, side): _largest(train, corners, rates, item.key, side, kind)
            for item in usable
            for side in SIDES
        }
        for kind in ("share", "pair_share")
    }
    return Sensitivity(
        inputs=tuple(usable),
        positions=tuple(chosen),
        rates=rates,
        omega=stages["share"],
        pair_omega=stages["pair_share"],
        kinks=tuple(Kink(c.position, elements) for c in corners if (elements := c.on_the_verge)),
        error={item.key: error[item.key] for item in usable},
        skipped=tuple(skipped),
    )


def _largest(
    train: Train,
    corners: list[Corner],
    rates: dict[tuple[int, str, str], Rates],
    key: str,
    side: str,
    kind: str,
) -> dict[str, float]:
    """Derivative of the largest Ω of each stage, and of the system, to one side."""
    found: dict[str, tuple[float, float]] = {}
    for stage in train.stages:
        groups = [stage.meshes] if kind == "share" else stage.groups
        near: list[tuple[float, float]] = []
        for corner in corners:
            shares = coefficients(corner.torque, groups)
            slopes = getattr(rates[corner.position, key, side], kind)
            near += [(s, slopes[m]) for m, s in shares.items() if s is not None]
        found[stage.name] = _steepest(near, side)
    found["system"] = _steepest(list(found.values()), side)
    return {name: slope for name, (_, slope) in found.items()}


def _steepest(near: list[tuple[float, float]], side: str) -> tuple[float, float]:
    """Return the largest share and its derivative; among equals the one that is largest beyond."""
    if not near:
        return np.nan, np.nan
    top = max(share for share, _ in near)
    slopes = [slope for share, slope in near if share >= top - TIE]
    return top, max(slopes) if side == "rising" else min(slopes)
