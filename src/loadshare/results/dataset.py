"""Results as labelled arrays (xarray) and tables (pandas)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare.array_types import Array
from loadshare.case.words import as_given
from loadshare.libraries import pd, xr
from loadshare.results.differences import DIGITS, ROUND_OFF
from loadshare.results.figures import COMPONENTS

if TYPE_CHECKING:
    from loadshare.results.figures import Figures
    from loadshare.results.result import Result


JUDGED_ARRAYS = ("residual", "torque_bound")
"""Figures of certificates, which are round-off themselves (see `differences.JUDGED`)."""


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of labelled arrays: its dimensions, its unit, and what it is.

    Attributes
    ----------
    dims : tuple of str
        Besides the position. The first is that of the elements.
    units, long_name : str
    """

    dims: tuple[str, ...]
    units: str
    long_name: str

    def labelled(self, values: np.ndarray, *over: str) -> tuple[Any, ...]:
        """Return values in xarray's form, with dimensions `over` before the variable's own."""
        attributes = {"units": self.units, "long_name": self.long_name}
        return (*over, *self.dims), values, attributes


VARIABLES = {
    "torque": Variable(("mesh",), "N·m", "torque on the driver"),
    "coast_torque": Variable(("mesh",), "N·m", "torque on the coast flank"),
    "share": Variable(("mesh",), "1", "load-sharing coefficient, stage mean"),
    "pair_share": Variable(("mesh",), "1", "load-sharing coefficient, group mean"),
    "mesh_position": Variable(("mesh",), "1", "position of the mesh in its own cycle"),
    "mesh_force": Variable(("mesh",), "N", "force along the line of action"),
    "transmission_error": Variable(
        ("side",),
        "rad",
        "rotation of the input beyond the kinematic one, referred to input or output",
    ),
    "torsional_stiffness": Variable(
        ("side",),
        "N·m/rad",
        "tangent stiffness from input to output, referred to input or output",
    ),
    "mesh_transmission_error": Variable(
        ("mesh",), "m", "transmission error along the line of action"
    ),
    "mesh_stiffness": Variable(("mesh",), "N/m", "tangent stiffness along the line of action"),
    "mesh_torsional_stiffness": Variable(("mesh",), "N·m/rad", "tangent stiffness at the driver"),
    "shaft_torque": Variable(("shaft",), "N·m", "torque from the first gear to the second"),
    "gear_torque": Variable(
        ("gear",), "N·m", "torque from outside, counter-clockwise about the gear's axis"
    ),
    "bearing_force": Variable(
        ("gear", "component"),
        "N",
        "force on the bearing or the pin in the gear's transverse frame",
    ),
    "rotation": Variable(("gear",), "rad", "elastic rotation"),
    "displacement": Variable(
        ("gear", "component"), "m", "displacement of the centre in the gear's transverse frame"
    ),
    "rotation_range": Variable(
        ("gear", "end"), "rad", "least and largest rotation where forces leave it open"
    ),
    "displacement_range": Variable(
        ("gear", "component", "end"),
        "m",
        "least and largest displacement where forces leave it open",
    ),
    "margin": Variable(("float",), "m", "distance to the nearest boundary of the float's region"),
    "on_boundary": Variable(("float",), "1", "1 where the float rests on a boundary"),
    "reaction": Variable(("float", "component"), "N", "force of the ring on the float"),
    "torque_bound": Variable(
        ("mesh",), "N·m", "largest distance of the torque from the exact equilibrium's"
    ),
    "residual": Variable(("figure",), "1", "scaled residual of the certificate"),
    "validity": Variable(
        ("measure",), "1", "size of the displacements for the geometry in which they were found"
    ),
}
"""Every variable of a result, each an attribute of `Figures`; samples and studies use them too."""


def unchanging(arrays: xr.Dataset) -> xr.Dataset:
    """Return labelled arrays with their variables made read-only.

    Pictures and files are made from them.
    """
    for variable in arrays.data_vars.values():
        variable.values.flags.writeable = False
    return arrays


def dataset(result: Result) -> xr.Dataset:
    """Build the labelled arrays of a result.

    Returns
    -------
    xarray.Dataset
        Dimensions position, mesh, gear, shaft, side, component, end, float, figure and measure;
        every variable carries its unit. Its arrays are read-only.
    """
    stamp, positions = result.stamp, result.positions
    # A train that is placed may have a shift to report at some positions only.
    measures = list(dict.fromkeys(m for figures, _ in _groups(result) for m in figures.measured))
    names = {**positions[0].figures.names, "measure": measures}
    data = {}
    for name, variable in VARIABLES.items():
        data[name] = variable.labelled(_stacked(result, name, names), "position")
    arrays = xr.Dataset(
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
    return unchanging(arrays)


def _groups(result: Result) -> Iterator[tuple[Figures, list[int]]]:
    """Yield the figures of positions that were evaluated together, and their rows in these."""
    for figures, some in groupby(result.positions, attrgetter("figures")):
        yield figures, [p.row for p in some]


def _stacked(result: Result, name: str, names: Mapping[str, Sequence[str]]) -> Array:
    """Return a figure of all positions as numbers."""
    return np.concatenate([f.as_numbers(name, names)[rows] for f, rows in _groups(result)])


def array_differences(expected: xr.Dataset, found: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """Yield where the arrays of a file differ from those of its result by more than round-off.

    Yields
    ------
    tuple of (str, str, str)
        Variable or attribute, what is written there, and what is wrong with it.
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
    """Tabulate torque [N·m], coefficients and worst residual, one row per position and mesh."""
    positions = result.positions
    names = positions[0].figures.names
    meshes = len(names["mesh"])
    columns: dict[str, object] = {
        "position": np.repeat([p.position for p in positions], meshes),
        "mesh": [*names["mesh"]] * len(positions),
    }
    # Made without labelled arrays: importing these takes longer than solving and writing.
    for name in ("torque", "coast_torque", "share", "pair_share"):
        columns[name] = _stacked(result, name, names).ravel()
    columns["worst_residual"] = np.repeat([p.certificate.worst for p in positions], meshes)
    return pd.DataFrame(columns)


def with_units(table: pd.DataFrame, arrays: xr.Dataset) -> pd.DataFrame:
    """Return a table of arrays with the unit of each column in ``attrs``."""
    units = {name: arrays[name].attrs.get("units") for name in table if name in arrays.data_vars}
    known = {name: unit for name, unit in units.items() if unit is not None}
    table.attrs["units"] = {**known, "worst_residual": "1"} if "worst_residual" in table else known
    return table


def frames(result: Result) -> dict[str, pd.DataFrame]:
    """Tabulate all variables, in a table each for train, meshes, gears, shafts and floats.

    A table has a row for every position and element; column names include the unit.
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
"""Names of the tables of each kind of element, by dimension."""
