"""Results as labelled arrays (xarray) and tables (pandas)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare.case.words import as_given
from loadshare.results.differences import DIGITS, ROUND_OFF

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from loadshare.results.result import Position, Result


JUDGED_ARRAYS = ("residual", "torque_bound")
"""Figures of certificates, which are round-off themselves (see `differences.JUDGED`)."""
COMPONENTS = ("x", "y")
"""Of a displacement in the gear's transverse frame."""
DETERMINED = (np.nan, np.nan)
"""Ends of the range of what is determined."""


@dataclass(frozen=True, slots=True)
class Variable:
    """A figure in labelled arrays: its dimensions, its unit, what it is, where it stands.

    Attributes
    ----------
    dims : tuple of str
        Beside the position. The first names elements.
    units, long_name : str
    read : callable
        Value at a position for one name of the first dimension; None where there is none.
    """

    dims: tuple[str, ...]
    units: str
    long_name: str
    read: Callable[[Position, str], object] = lambda position, name: None

    def labelled(self, values: np.ndarray, *over: str) -> tuple[Any, ...]:
        """Return values as xarray takes them, the dimensions `over` before the variable's own."""
        attributes = {"units": self.units, "long_name": self.long_name}
        return (*over, *self.dims), values, attributes


VARIABLES = {
    "torque": Variable(("mesh",), "N·m", "torque on the driver", lambda p, m: p.torque[m]),
    "coast_torque": Variable(
        ("mesh",), "N·m", "torque on the coast flank", lambda p, m: p.coast_torque[m]
    ),
    "share": Variable(
        ("mesh",), "1", "load-sharing coefficient, stage mean", lambda p, m: p.share.get(m)
    ),
    "pair_share": Variable(
        ("mesh",), "1", "load-sharing coefficient, group mean", lambda p, m: p.pair_share.get(m)
    ),
    "mesh_position": Variable(
        ("mesh",), "1", "position of the mesh in its own cycle", lambda p, m: p.mesh_position[m]
    ),
    "mesh_force": Variable(
        ("mesh",), "N", "force along the line of action", lambda p, m: p.loads.meshes[m]
    ),
    "transmission_error": Variable(
        ("side",),
        "rad",
        "rotation of the input beyond the kinematic one, referred to input or output",
        lambda p, side: p.elastic.transmission_error[side],
    ),
    "torsional_stiffness": Variable(
        ("side",),
        "N·m/rad",
        "tangent stiffness from input to output, referred to input or output",
        lambda p, side: p.elastic.torsional_stiffness[side],
    ),
    "mesh_transmission_error": Variable(
        ("mesh",),
        "m",
        "transmission error along the line of action",
        lambda p, m: p.elastic.mesh_transmission_error[m],
    ),
    "mesh_stiffness": Variable(
        ("mesh",),
        "N/m",
        "tangent stiffness along the line of action",
        lambda p, m: p.elastic.mesh_stiffness[m],
    ),
    "mesh_torsional_stiffness": Variable(
        ("mesh",),
        "N·m/rad",
        "tangent stiffness at the driver",
        lambda p, m: p.elastic.mesh_torsional_stiffness[m],
    ),
    "shaft_torque": Variable(
        ("shaft",),
        "N·m",
        "torque from the first gear to the second",
        lambda p, s: p.loads.shafts[s],
    ),
    "gear_torque": Variable(
        ("gear",),
        "N·m",
        "torque from outside, counter-clockwise about the gear's axis",
        lambda p, g: p.loads.gears[g],
    ),
    "bearing_force": Variable(
        ("gear", "component"),
        "N",
        "force on the bearing or the pin in the gear's transverse frame",
        lambda p, g: p.loads.bearings[g],
    ),
    "rotation": Variable(("gear",), "rad", "elastic rotation", lambda p, g: p.rotation[g]),
    "displacement": Variable(
        ("gear", "component"),
        "m",
        "displacement of the centre in the gear's transverse frame",
        lambda p, g: p.displacement[g],
    ),
    "rotation_range": Variable(
        ("gear", "end"),
        "rad",
        "least and largest rotation where forces leave it open",
        lambda p, g: p.undetermined.get(f"gear {g} rotation", DETERMINED),
    ),
    "displacement_range": Variable(
        ("gear", "component", "end"),
        "m",
        "least and largest displacement where forces leave it open",
        lambda p, g: [p.undetermined.get(f"gear {g} {axis}", DETERMINED) for axis in COMPONENTS],
    ),
    "margin": Variable(
        ("float",),
        "m",
        "distance to the nearest boundary of the float's region",
        lambda p, g: p.floats[g].margin,
    ),
    "on_boundary": Variable(
        ("float",),
        "1",
        "1 where the float rests on a boundary",
        lambda p, g: p.floats[g].state == "on boundary",
    ),
    "reaction": Variable(
        ("float", "component"),
        "N",
        "force of the ring on the float",
        lambda p, g: p.floats[g].reaction,
    ),
    "torque_bound": Variable(
        ("mesh",),
        "N·m",
        "largest distance of the torque from the exact equilibrium's",
        lambda p, m: p.certificate.bound.torque.get(m),
    ),
    "residual": Variable(
        ("figure",),
        "1",
        "scaled residual of the certificate",
        lambda p, name: p.certificate.residuals[name].scaled,
    ),
    "validity": Variable(
        ("measure",),
        "1",
        "size of the displacements for the geometry in which they were found",
        lambda p, name: getattr(p.validity.measures.get(name), "value", None),
    ),
}
"""Every variable of a result; samples and studies take theirs from here."""


def dataset(result: Result) -> xr.Dataset:
    """Build the labelled arrays of a result.

    Returns
    -------
    xarray.Dataset
        Dimensions position, mesh, gear, shaft, side, component, end, float, figure and measure;
        every variable carries its unit.
    """
    import xarray as xr

    positions, stamp = result.positions, result.stamp
    first = positions[0]
    names: dict[str, list[str]] = {
        "mesh": list(first.torque),
        "gear": list(first.rotation),
        "shaft": list(first.loads.shafts),
        "side": list(first.elastic.transmission_error),
        "component": list(COMPONENTS),
        "end": ["least", "largest"],
        "float": list(first.floats),
        "figure": list(first.certificate.residuals),
        "measure": [name for name, _, _ in result.validity],
    }
    data = {}
    for name, variable in VARIABLES.items():
        rows = [[variable.read(p, n) for n in names[variable.dims[0]]] for p in positions]
        shape = [len(positions), *(len(names[dim]) for dim in variable.dims)]
        data[name] = variable.labelled(np.array(rows, dtype=float).reshape(shape), "position")
    return xr.Dataset(
        data,
        coords={"position": [p.position for p in positions], **names},
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
    arrays = result.dataset[["torque", "coast_torque", "share", "pair_share"]]
    worst = [p.certificate.worst for p in result.positions]
    return arrays.assign(worst_residual=("position", worst)).to_dataframe().reset_index()


def with_units(table: pd.DataFrame, arrays: xr.Dataset) -> pd.DataFrame:
    """Return a table of arrays that tells the unit of each of its columns in ``attrs``."""
    told = {name: arrays[name].attrs.get("units") for name in table if name in arrays.data_vars}
    known = {name: unit for name, unit in told.items() if unit is not None}
    table.attrs["units"] = {**known, "worst_residual": "1"} if "worst_residual" in table else known
    return table


def frames(result: Result) -> dict[str, pd.DataFrame]:
    """Tabulate everything by what it is told of: train, meshes, gears, shafts, floats.

    A row for every position and element; heads tell the unit.
    """
    arrays, found = result.dataset, {}
    for dim in ("side", "mesh", "gear", "shaft", "float"):
        columns = {}
        for name, variable in VARIABLES.items():
            head = f"{name} [{variable.units}]"
            if variable.dims == (dim,):
                columns[head] = arrays[name]
            elif variable.dims == (dim, "component"):
                for axis in COMPONENTS:
                    columns[f"{name} {axis} [{variable.units}]"] = arrays[name].sel(
                        component=axis, drop=True
                    )
        if arrays.sizes[dim]:
            table = arrays[[]].assign(columns).to_dataframe(["position", dim])
            found[TABLES[dim]] = table.reset_index()
    return found


TABLES = {"side": "train", "mesh": "meshes", "gear": "gears", "shaft": "shafts", "float": "floats"}
"""Names of tables of what is told of an element, by dimension."""
