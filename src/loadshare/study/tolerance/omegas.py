"""How Ω scatters over samples: of every stage and of the system, over both means."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.figures import KINDS, SYSTEM
from loadshare.study.tolerance.result import OmegaStatistics
from loadshare.study.tolerance.statistics import exceedance, summary

Columns = Callable[[str], Array]
"""Gives a column of the samples' figures by its name."""


def omega_statistics(
    column: Columns,
    stages: Sequence[str],
    levels: Sequence[float],
    limit: float | None,
    replicated: bool,
) -> Iterator[OmegaStatistics]:
    """Yield the statistics of Ω, without shares of variance, where any sample has it.

    Parameters
    ----------
    column : callable
        Figures by the name of their column, NaN where a sample has no answer.
    stages : sequence of str
        "system" among them.
    levels : sequence of float
        Of the quantiles.
    limit : float or None
    replicated : bool
        As for `statistics.summary`.
    """
    for (kind, over), stage in product(KINDS.items(), stages):
        values = column(f"{kind}.{stage}")
        found = summary(values, levels, replicated)
        if found is not None:
            above = None if limit is None else exceedance(values, limit, replicated)
            yield OmegaStatistics(over, stage, found, above, ())


def apart_kinds(column: Columns) -> list[str]:
    """Kinds of Ω that differ: where groups share alike, as without groups, both are one."""
    one, other = (column(f"{kind}.{SYSTEM}") for kind in KINDS)
    same = np.allclose(one, other, rtol=TOLERANCE.same, atol=0.0, equal_nan=True)
    return list(KINDS)[:1] if same else list(KINDS)
