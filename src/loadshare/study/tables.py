"""Studies as labelled arrays (xarray) and tables (pandas)."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare._version import __version__
from loadshare.results.dataset import COMPONENTS, VARIABLES

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from loadshare.results import Result
    from loadshare.study.march import March
    from loadshare.study.sensitivity import Sensitivity
    from loadshare.study.sweep import Sweep

NONE = np.array(np.nan)


def sweep_dataset(sweep: Sweep) -> xr.Dataset:
    """Build the labelled arrays of a sweep.

    Returns
    -------
    xarray.Dataset
        One dimension per parameter, named after it, with the unit in its attributes; then those of
        a result (position, mesh, gear, component, end, float, figure) and "stage". Besides what a
        result holds: "omega" and "pair_omega" (parameters, stage), "rest" and "spline" (parameters,
        position, float) as words, "status" and "message" (parameters). What was not certified is
        NaN, or an empty text.
    """
    import xarray as xr

    dims = tuple(p.name for p in sweep.parameters)
    shape = tuple(len(values) for values in sweep.grids)
    coords: dict[str, object] = {
        p.name: (p.name, np.array(values), {"units": p.unit or "1", "keys": ", ".join(p.keys)})
        for p, values in zip(sweep.parameters, sweep.grids, strict=True)
    }
    words = {
        "status": (dims, np.array([p.status for p in sweep.points]).reshape(shape)),
        "message": (dims, np.array([p.message for p in sweep.points]).reshape(shape)),
    }
    results = [p.result for p in sweep.points]
    first = next((r for r in results if r is not None), None)
    attributes = {"case": sweep.case, "loadshare_version": __version__}
    if first is None:
        return xr.Dataset(words, coords=coords, attrs=attributes)
    attributes["title"] = first.stamp.title
    positions = sorted({p.position for r in results if r for p in r.positions})
    model = first.dataset.reindex(position=positions)
    parts = [r.dataset.reindex(position=positions) if r else None for r in results]
    data: dict[str, object] = dict(words)
    for name, variable in model.items():
        arrays = [p[name].values if p is not None else np.full(variable.shape, NONE) for p in parts]
        stacked = np.array(arrays).reshape(shape + variable.shape)
        data[str(name)] = ((*dims, *map(str, variable.dims)), stacked, variable.attrs)
    stages = list(first.omega)
    for name, label in (("omega", "stage mean"), ("pair_omega", "group mean")):
        filled = [[_figure(r, name, stage) for stage in stages] for r in results]
        attrs = {"units": "1", "long_name": f"largest load-sharing coefficient, {label}"}
        data[name] = ((*dims, "stage"), np.array(filled).reshape((*shape, len(stages))), attrs)
    floats = [str(name) for name in model["float"].values]
    for name, label in (("rest", "where the float rests"), ("spline", "stage of the spline")):
        filled_words = [
            [[_word(r, k, g, name) for g in floats] for k in positions] for r in results
        ]
        stacked = np.array(filled_words, dtype=str).reshape((*shape, len(positions), len(floats)))
        data[name] = ((*dims, "position", "float"), stacked, {"long_name": label})
    coords |= {str(n): model[n].values for n in model.coords} | {"stage": stages}
    return xr.Dataset(data, coords=coords, attrs=attributes)


def _figure(result: Result | None, name: str, stage: str) -> float:
    value = getattr(result, name)[stage] if result is not None else None
    return np.nan if value is None else float(value)


def _word(result: Result | None, position: int, gear: str, name: str) -> str:
    for p in result.positions if result is not None else ():
        if p.position == position:
            rest = p.floats[gear]
            return (rest.spline or "") if name == "spline" else (rest.boundary or rest.state)
    return ""


def sweep_frame(sweep: Sweep) -> pd.DataFrame:
    """Tabulate a sweep: point by position by mesh; a refused point has one row with its message."""
    import pandas as pd

    frames = []
    for point in sweep.points:
        table = (
            pd.DataFrame({"position": [pd.NA]}) if point.result is None else point.result.to_frame()
        )
        for number, (parameter, value) in enumerate(
            zip(sweep.parameters, point.values, strict=True)
        ):
            label = f"{parameter.name} [{parameter.unit}]" if parameter.unit else parameter.name
            table.insert(number, label, value)
        frames.append(table.assign(status=point.status, message=point.message))
    table = pd.concat([f.astype(object) for f in frames], ignore_index=True)
    # A refused point may come first; what became of a point stands last all the same.
    last = ["status", "message"]
    return table[[c for c in table if c not in last] + last]


def sensitivity_dataset(found: Sensitivity) -> xr.Dataset:
    """Build the labelled arrays of a sensitivity.

    Returns
    -------
    xarray.Dataset
        "torque", "share", "pair_share" (position, input, side, mesh), "displacement" (position,
        input, side, gear, component), "omega", "pair_omega" (input, side, stage): derivatives per
        SI unit of the input, and each with "_error" at its name its stated error; coordinates
        "value", "unit" and "factor" (SI units per unit) say what the input is, "error" the largest
        stated error of a torque's derivative, "kink" (position) whether the sides may differ.
    """
    import xarray as xr

    keys = [item.key for item in found.inputs]
    kinks = {kink.position for kink in found.kinks}
    some = next(iter(found.rates.values()), None)
    gears = list(some.displacement) if some else []
    coords: dict[str, Any] = {
        "position": list(found.positions),
        "input": keys,
        "side": list(found.sides),
        "mesh": list(some.torque) if some else [],
        "gear": gears,
        "component": list(COMPONENTS),
        "stage": list(next(iter(found.omega.values()), {})),
    }

    each = ("position", "input", "side")

    def entry(name: str, ending: str, *dims: str) -> tuple[Any, ...]:
        rows = []
        for at in product(*(coords[d] for d in dims if d in each)):
            if "position" in dims:
                here = found.rates[at]
                by_name = getattr(here.error if ending else here, name)
            else:
                by_name = getattr(found, name + ending)[at]
            rows.append(list(by_name.values()))
        values = np.array(rows, dtype=float).reshape([len(coords[d]) for d in dims])
        unit = VARIABLES[name].units if name in VARIABLES else "1"
        return dims, values, {"units": f"{unit} per SI unit of the input"}

    figures = (
        *((name, *each, "mesh") for name in ("torque", "share", "pair_share")),
        ("displacement", *each, "gear", "component"),
        *((name, *each[1:], "stage") for name in ("omega", "pair_omega")),
    )
    return xr.Dataset(
        {
            name + ending: entry(name, ending, *dims)
            for name, *dims in figures
            for ending in ("", "_error")
        },
        coords={
            **coords,
            "value": ("input", [item.value.number for item in found.inputs]),
            "unit": ("input", [item.value.unit for item in found.inputs]),
            "factor": ("input", [item.value.factor for item in found.inputs]),
            "error": ("input", [found.error[key] for key in keys]),
            "kink": ("position", [k in kinks for k in found.positions]),
        },
        attrs={"loadshare_version": __version__},
    )


def march_dataset(found: March) -> xr.Dataset:
    """Build the labelled arrays of a march.

    Returns
    -------
    xarray.Dataset
        Those of its result, and "slip" (position, spline, component), "dissipated", "friction" and
        "stage" (position, spline), "revolutions" (position).
    """
    gears = list(found.slips[0]) if found.slips else []
    steps = len(found.slips)
    on_spline = ("position", "spline")

    def over(name: str, *tail: int) -> np.ndarray:
        rows = [[getattr(step[g], name) for g in gears] for step in found.slips]
        return np.array(rows, dtype=float).reshape((steps, len(gears), *tail))

    stages = np.array([[step[g].stage for g in gears] for step in found.slips], dtype=str)
    return found.result.dataset.assign_coords(spline=gears).assign(
        slip=((*on_spline, "component"), over("slip", 2), {"units": "m"}),
        dissipated=(on_spline, over("dissipated"), {"units": "J"}),
        friction=(on_spline, over("friction"), {"units": "N"}),
        stage=(on_spline, stages.reshape((steps, len(gears)))),
        revolutions=("position", list(found.revolutions), {"gear": found.gear}),
    )
