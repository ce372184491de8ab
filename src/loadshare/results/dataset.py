"""Results as labelled arrays (xarray) and tables (pandas)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from loadshare.case.words import as_given
from loadshare.results.differences import DIGITS, ROUND_OFF

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from loadshare.results.result import Position, Result


JUDGED_ARRAYS = ("residual", "torque_bound")
"""Figures of certificates, which are round-off themselves (see `differences.JUDGED`)."""


def dataset(result: Result) -> xr.Dataset:
    """Build the labelled arrays of a result.

    Returns
    -------
    xarray.Dataset
        Dimensions position, mesh, gear, component, end, float, figure and measure; every variable
        carries its unit.
    """
    import xarray as xr

    positions = result.positions
    first = positions[0]
    meshes, gears = list(first.torque), list(first.rotation)
    floats, residuals = list(first.floats), list(first.certificate.residuals)

    def over(names: list[str], read: Callable[[Position], Mapping[str, object]]) -> np.ndarray:
        """Array position × name; what a mapping lacks or leaves open becomes NaN."""
        rows = [[read(p).get(n) for n in names] for p in positions]
        return np.array([[np.nan if v is None else v for v in row] for row in rows], dtype=float)

    def ranges(name: str) -> np.ndarray:
        """Array position × gear × 2 of what is undetermined; NaN where it is determined."""
        determined = (np.nan, np.nan)
        rows = [[p.undetermined.get(name.format(g), determined) for g in gears] for p in positions]
        return np.array(rows, dtype=float)

    def variable(
        dims: tuple[str, ...], values: np.ndarray, units: str, long_name: str
    ) -> tuple[tuple[str, ...], np.ndarray, dict[str, str]]:
        return dims, values, {"units": units, "long_name": long_name}

    on_mesh, on_gear, on_float = ("position", "mesh"), ("position", "gear"), ("position", "float")
    displacement = np.array([[p.displacement[g] for g in gears] for p in positions])
    reaction = np.array([[p.floats[g].reaction for g in floats] for p in positions], dtype=float)
    data = {
        "torque": variable(
            on_mesh, over(meshes, lambda p: p.torque), "N m", "torque on the driver"
        ),
        "coast_torque": variable(
            on_mesh, over(meshes, lambda p: p.coast_torque), "N m", "torque on the coast flank"
        ),
        "share": variable(
            on_mesh, over(meshes, lambda p: p.share), "1", "load-sharing coefficient, stage mean"
        ),
        "pair_share": variable(
            on_mesh,
            over(meshes, lambda p: p.pair_share),
            "1",
            "load-sharing coefficient, group mean",
        ),
        "rotation": variable(on_gear, over(gears, lambda p: p.rotation), "rad", "elastic rotation"),
        "displacement": variable(
            ("position", "gear", "component"),
            displacement.reshape(len(positions), len(gears), 2),
            "m",
            "displacement of the centre in the gear's transverse frame",
        ),
        "rotation_range": variable(
            (*on_gear, "end"),
            ranges("gear {} rotation"),
            "rad",
            "least and largest rotation where forces leave it open",
        ),
        "displacement_range": variable(
            ("position", "gear", "component", "end"),
            np.stack([ranges(f"gear {{}} {axis}") for axis in "xy"], axis=2),
            "m",
            "least and largest displacement where forces leave it open",
        ),
        "margin": variable(
            on_float,
            over(floats, lambda p: {g: f.margin for g, f in p.floats.items()}),
            "m",
            "distance to the nearest boundary of the float's region",
        ),
        "on_boundary": variable(
            on_float,
            over(floats, lambda p: {g: f.state == "on boundary" for g, f in p.floats.items()}),
            "1",
            "1 where the float rests on a boundary",
        ),
        "reaction": variable(
            ("position", "float", "component"),
            reaction.reshape(len(positions), len(floats), 2),
            "N",
            "force of the ring on the float",
        ),
        "torque_bound": variable(
            on_mesh,
            over(meshes, lambda p: p.certificate.bound.torque),
            "N m",
            "largest distance of the torque from the exact equilibrium's",
        ),
        "residual": variable(
            ("position", "figure"),
            over(
                residuals,
                lambda p: {n: r.scaled for n, r in p.certificate.residuals.items()},
            ),
            "1",
            "scaled residual of the certificate",
        ),
    }
    measures = [name for name, _, _ in result.validity]
    data["validity"] = variable(
        ("position", "measure"),
        over(measures, lambda p: {n: m.value for n, m in p.validity.measures.items()}),
        "1",
        "size of the displacements for the geometry in which they were found",
    )
    stamp = result.stamp
    return xr.Dataset(
        data,
        coords={
            "position": [p.position for p in positions],
            "mesh": meshes,
            "gear": gears,
            "component": ["x", "y"],
            "end": ["least", "largest"],
            "float": floats,
            "figure": residuals,
            "measure": measures,
        },
        attrs={
            "title": stamp.title or stamp.case,
            "case": stamp.case,
            "case_hash": stamp.case_hash,
            "loadshare_version": stamp.version,
            "solver": stamp.solver,
            "method": stamp.method,
            "tolerance": stamp.tolerance,
        },
    )


def array_differences(expected: xr.Dataset, found: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """Yield where the arrays of a file differ from those of its result by more than round-off.

    Yields
    ------
    tuple of (str, str, str)
        Variable or attribute, what stands there, and what is wrong with it.
    """
    for name, value in expected.attrs.items():
        if found.attrs.get(name) != value:
            given = as_given(found.attrs.get(name))
            yield name, given, f"is not {as_given(value)}, as the result in this file says"
    for name in map(str, found.variables):
        if name not in expected.variables:
            yield name, "", "is not known"
    for name, variable in expected.variables.items():
        if name not in found.variables:
            yield str(name), "", "is missing"
        elif not _alike(str(name), variable, found.variables[name]):
            yield str(name), "", "does not agree with the result in this file"


def _alike(name: str, expected: xr.Variable, found: xr.Variable) -> bool:
    one, other = np.asarray(expected.values), np.asarray(found.values)
    if expected.dims != found.dims or one.shape != other.shape or expected.attrs != found.attrs:
        return False
    if one.dtype.kind != "f":
        return bool(np.array_equal(one, other))
    if other.dtype.kind != "f" or not np.array_equal(np.isnan(one), np.isnan(other)):
        return False
    floor = ROUND_OFF * float(np.abs(one[np.isfinite(one)]).max(initial=0.0))
    return name in JUDGED_ARRAYS or np.allclose(one, other, DIGITS, floor, equal_nan=True)


def frame(result: Result) -> pd.DataFrame:
    """Tabulate position by mesh: torque [N·m], coefficients, the position's worst residual."""
    import pandas as pd

    rows = [
        {
            "position": p.position,
            "mesh": mesh,
            "torque": torque,
            "coast_torque": p.coast_torque[mesh],
            "share": p.share.get(mesh),
            "pair_share": p.pair_share.get(mesh),
            "worst_residual": p.certificate.worst,
        }
        for p in result.positions
        for mesh, torque in p.torque.items()
    ]
    return pd.DataFrame(rows).astype({"share": float, "pair_share": float})
