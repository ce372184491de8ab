"""Statistics of a tolerance study as labelled arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare.array_types import Array
from loadshare.libraries import xr
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.statistics import Estimate, OmegaStatistics

if TYPE_CHECKING:
    from loadshare.study.tolerance.result import Tolerance


def dataset(found: Tolerance) -> xr.Dataset:
    """Build the labelled arrays of the statistics of Ω.

    Dimensions are ``over`` ("stage", "group"), ``stage``, ``level`` of the quantiles, ``input`` and
    ``bin``; the interval of a figure is under its name with ``_low`` and ``_high`` added.
    """
    overs = list(dict.fromkeys(o.over for o in found.omega))
    stages = list(dict.fromkeys(o.stage for o in found.omega))
    levels = list(found.omega[0].summary.quantiles) if found.omega else []
    units = list(found.inputs.unit_names)
    of = {(o.over, o.stage): o for o in found.omega}
    base = ("over", "stage")

    sizes = {"level": len(levels), "input": len(units)}

    def gathered(get: Callable[[OmegaStatistics], Any], *shape: int) -> Array:
        values = np.full((len(overs), len(stages), *shape), np.nan)
        for i, over in enumerate(overs):
            for j, stage in enumerate(stages):
                if (over, stage) in of:
                    values[i, j] = get(of[over, stage])
        return values

    variables: dict[str, Any] = {
        "deviation": (base, gathered(lambda o: o.summary.deviation)),
        "lowest": (base, gathered(lambda o: o.summary.lowest)),
        "highest": (base, gathered(lambda o: o.summary.highest)),
        "count": ((*base, "bin"), gathered(lambda o: o.summary.counts, TOLERANCE.bins)),
    }

    def estimates(name: str, get: Callable[[OmegaStatistics], list[Estimate]], *axis: str) -> None:
        shape = [sizes[name] for name in axis]
        ends = gathered(
            lambda o: np.reshape([(e.value, e.low, e.high) for e in get(o)], (*shape, 3)), *shape, 3
        )
        for k, ending in enumerate(ENDS):
            variables[name + ending] = ((*base, *axis), ends[..., k])

    estimates("mean", lambda o: [o.summary.mean])
    estimates("quantile", lambda o: list(o.summary.quantiles.values()), "level")
    if found.limit is not None:
        estimates("exceedance", lambda o: [o.exceedance or _NONE])
    if any(o.shares for o in found.omega):
        for name, order in (("first_order", "first"), ("total_order", "total")):
            estimates(name, lambda o, order=order: _shares(o, order, len(units)), "input")  # type: ignore[misc]
    edges = gathered(lambda o: o.summary.edges, TOLERANCE.bins + 1)
    attributes = {
        "case": found.case,
        "title": found.folder.job.case.title,
        "samples": found.samples,
        "refused": found.refused,
        "seed": found.settings["seed"],
        "sampling": found.settings["sampling"],
        "version": found.settings["version"],
        "case_hash": found.settings["case_hash"],
    }
    if found.limit is not None:
        attributes["limit"] = found.limit
    arrays = xr.Dataset(
        variables,
        coords={
            "over": overs,
            "stage": stages,
            "level": levels,
            "input": units,
            "edge": ((*base, "bound"), edges),
        },
        attrs=attributes,
    )
    return _named(arrays)


COEFFICIENT = "largest load-sharing coefficient"
NAMES = {
    "mean": f"mean of the {COEFFICIENT}",
    "deviation": f"standard deviation of the {COEFFICIENT}",
    "lowest": f"lowest {COEFFICIENT} of all samples",
    "highest": f"highest {COEFFICIENT} of all samples",
    "quantile": f"quantile of the {COEFFICIENT}",
    "exceedance": f"part of the samples whose {COEFFICIENT} is beyond the limit",
    "count": "samples in a bin of the histogram",
    "edge": "edges of the bins of the histogram",
    "level": "part of the samples at or below the quantile",
    "first_order": f"part of the variance of the {COEFFICIENT} that is due to the input alone",
    "total_order": f"part of the variance of the {COEFFICIENT} in which the input takes part",
}
"""Description of each figure; all are dimensionless."""
ENDS = {"": "", "_low": ", lower end of its interval", "_high": ", upper end of its interval"}


def _named(arrays: xr.Dataset) -> xr.Dataset:
    for name, text in NAMES.items():
        for ending, end in ENDS.items():
            if name + ending in arrays.variables:
                arrays[name + ending].attrs.update(units="1", long_name=text + end)
    return arrays


_NONE = Estimate(np.nan, np.nan, np.nan)


def _shares(one: OmegaStatistics, order: str, units: int) -> list[Estimate]:
    return [getattr(s, order) for s in one.shares] or [_NONE] * units
