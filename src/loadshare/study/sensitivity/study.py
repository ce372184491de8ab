"""Differentiate the certified equilibria of a case: `loadshare.sensitivity`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from loadshare.case import Case
from loadshare.case.keys import parse
from loadshare.case.reader import opened
from loadshare.errors import CaseError
from loadshare.job.positions import wanted_positions
from loadshare.progress import Progress
from loadshare.results.share import shares
from loadshare.settings import SENSITIVITY
from loadshare.study.positions import each_certified, loaded
from loadshare.study.sensitivity.inputs import inputs_of
from loadshare.study.sensitivity.position import PositionSensitivity
from loadshare.study.sensitivity.result import SIDES, Kink, Rates, Sensitivity
from loadshare.study.sensitivity.variation import Trains
from loadshare.tooth import affects_laws, resolve
from loadshare.train import Train
from loadshare.train.build import train_of
from loadshare.train.geometry import geometry_of


class LargestShare(NamedTuple):
    """The largest share of a stage, its derivative, and the derivative's stated error."""

    share: float
    rate: float
    error: float


Slopes = dict[tuple[str, str], dict[str, float]]
"""Figures by input and side, then by stage."""


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
        Dotted key paths, or patterns in which a star matches any name; a table or list means all
        numbers in it. All numbers of the case by default.
    positions : iterable of int, optional
        1-based positions; all by default.
    progress : Progress, optional
        Called after every input.

    Returns
    -------
    Sensitivity
        One-sided derivatives, which agree unless the equilibrium is on a verge;
        `Sensitivity.kinks` names the positions where it is.

    Raises
    ------
    CaseError
        If an input is missing, is not a number, or cannot be varied on its own. Of those that a
        table or pattern stands for, inputs that cannot be varied are left out (`skipped`).
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
    given = opened(case)
    case = loaded(given)
    geometry = geometry_of(case)
    train = train_of(case, geometry)
    chosen = wanted_positions(train, positions)
    solved = [PositionSensitivity(train, answer) for answer in each_certified(train, chosen)]
    rates: dict[tuple[int, str, str], Rates] = {}
    usable, skipped = [], []
    wanted, named = inputs_of(case, inputs), [inputs] if isinstance(inputs, str) else inputs or ()
    following = resolve(given, leave=given.meshes)
    for done, item in enumerate(wanted, start=1):
        if progress is not None:
            progress(done, len(wanted))
        try:
            own = following if affects_laws(parse(item.key)) else case
            trains = Trains((case, geometry, train), own, item, chosen)
            rates |= {at: of for c in solved for at, of in c.rates(trains, item).items()}
        except CaseError as refusal:
            if len(wanted) == 1 or item.key in named:
                raise
            skipped.append((item.key, refusal.problems[0].message))
        else:
            usable.append(item)
    omega, omega_error = _largest(train, solved, rates, "share")
    pair_omega, pair_omega_error = _largest(train, solved, rates, "pair_share")
    return Sensitivity(
        inputs=tuple(usable),
        positions=tuple(chosen),
        rates=rates,
        omega=omega,
        pair_omega=pair_omega,
        omega_error=omega_error,
        pair_omega_error=pair_omega_error,
        kinks=tuple(Kink(c.position, elements) for c in solved if (elements := c.on_the_verge)),
        error={item.key: _error(rates, item.key, chosen) for item in usable},
        remarks=tuple(r for c in solved for r in c.remarks),
        skipped=tuple(skipped),
    )


def _error(rates: dict[tuple[int, str, str], Rates], key: str, positions: Sequence[int]) -> float:
    """Return the largest stated error of a torque's derivative."""
    errors = [rates[position, key, side].error for position in positions for side in SIDES]
    stated = [v for e in errors if e is not None for v in e.torque.values()]
    return max((v for v in stated if not math.isnan(v)), default=math.nan)


def _largest(
    train: Train,
    at_positions: list[PositionSensitivity],
    rates: dict[tuple[int, str, str], Rates],
    kind: str,
) -> tuple[Slopes, Slopes]:
    """Return the derivatives of the largest Ω of each stage and the system, and their errors."""
    found: Slopes = {}
    stated: Slopes = {}
    for key, side in dict.fromkeys((key, side) for _, key, side in rates):
        here: dict[str, LargestShare] = {}
        for stage in train.stages:
            near: list[LargestShare] = []
            for one in at_positions:
                omega = shares(one.torques, [stage], pairs=kind == "pair_share")[0].tolist()
                own = rates[one.position, key, side]
                slopes, errors = getattr(own, kind), getattr(own.error, kind)
                every = zip(one.torques.meshes, omega, strict=True)
                near += [
                    LargestShare(s, slopes[m], errors[m]) for m, s in every if not math.isnan(s)
                ]
            here[stage.name] = _steepest(near, side)
        here["system"] = _steepest(list(here.values()), side)
        found[key, side] = {name: one.rate for name, one in here.items()}
        stated[key, side] = {name: one.error for name, one in here.items()}
    return found, stated


def _steepest(near: list[LargestShare], side: str) -> LargestShare:
    """Return the largest share with derivative and error; of equal ones, the largest beyond."""
    # Where no load is carried there are no shares.
    near = [one for one in near if not np.isnan(one.share)]
    if not near:
        return LargestShare(np.nan, np.nan, np.nan)
    top = max(one.share for one in near)
    equal = [one for one in near if one.share >= top - SENSITIVITY.tie]
    steepest = (max if side == "rising" else min)(one.rate for one in equal)
    return LargestShare(top, steepest, max(one.error for one in equal))
