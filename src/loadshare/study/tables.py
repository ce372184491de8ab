"""Studies as labelled arrays (xarray) and tables (pandas)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare._version import __version__
from loadshare.libraries import pd, xr
from loadshare.results import share
from loadshare.results.dataset import VARIABLES
from loadshare.results.figures import COMPONENTS

if TYPE_CHECKING:
    from loadshare.job.answered import MachineSamples
    from loadshare.study.march import March
    from loadshare.study.sensitivity import Sensitivity
    from loadshare.study.sweep import Sweep


def sweep_dataset(sweep: Sweep) -> xr.Dataset:
    """Build the labelled arrays of a sweep.

    Returns
    -------
    xarray.Dataset
        One dimension per parameter, named after it, with the unit in its attributes; then those of
        a result (position, mesh, gear, component, end, float, figure) and "stage". Besides what a
        result holds: "omega" and "pair_omega" (parameters, stage), "rest" and "spline" (parameters,
        position, float) as words, "status" and "message" (parameters). Entries without a certified
        answer are NaN or an empty text.
    """
    dims = tuple(p.name for p in sweep.parameters)
    shape = tuple(len(values) for values in sweep.grids)
    coords: dict[str, object] = {
        p.name: (p.name, np.array(values), {"units": p.unit or "1", "keys": ", ".join(p.keys)})
        for p, values in zip(sweep.parameters, sweep.grids, strict=True)
    }
    data: dict[str, object] = {
        "status": (dims, np.array([p.status for p in sweep.points]).reshape(shape)),
        "message": (dims, np.array([p.message for p in sweep.points]).reshape(shape)),
    }
    attributes = {"case": sweep.case, "loadshare_version": __version__}
    positions, names, arrays = _filled(sweep, (*VARIABLES, *WORDS))
    if not positions:
        return xr.Dataset(data, coords=coords, attrs=attributes)
    attributes["title"] = sweep.title
    for name, variable in VARIABLES.items():
        values = arrays[name].reshape(*shape, *arrays[name].shape[1:])
        data[name] = variable.labelled(values, *dims, "position")
    omegas = sweep.shares
    for name, label in (("omega", "stage mean"), ("pair_omega", "group mean")):
        values = np.stack(list(omegas[name].values()), axis=-1)
        attrs = {"units": "1", "long_name": f"largest load-sharing coefficient, {label}"}
        data[name] = ((*dims, "stage"), values.reshape(*shape, -1), attrs)
    for name, label in (("rest", "where the float rests"), ("spline", "stage of the spline")):
        values = arrays[name].astype(str).reshape(*shape, *arrays[name].shape[1:])
        data[name] = ((*dims, "position", "float"), values, {"long_name": label})
    coords |= {"position": positions, **names, "stage": list(omegas["omega"])}
    return xr.Dataset(data, coords=coords, attrs=attributes)


def _filled(
    sweep: Sweep, wanted: Sequence[str]
) -> tuple[list[int], dict[str, list[str]], dict[str, np.ndarray]]:
    """Collect figures from the parts of a sweep, at positions with an answer at any point.

    Returns
    -------
    list of int
        These positions.
    mapping of str to list of str
        Names of the elements and components, by dimension.
    mapping of str to ndarray, shape (points, positions, ...)
        The figures.
    """
    parts = [part for part in sweep.answered.parts if len(part.there)]
    positions = sorted({k for part in parts for k in _answered(part)[1].tolist()})
    names = {**parts[0].figures.names} if parts else {}
    if "validity" in wanted:
        every = (m for part in parts for m in part.figures.measured)
        names["measure"] = list(dict.fromkeys(every))
    arrays: dict[str, np.ndarray] = {}
    for part in parts:
        rows, index = _answered(part)
        at = np.array(sweep.usable)[rows], np.searchsorted(positions, index)
        for name in wanted:
            words = name in WORDS
            values = getattr(part.figures, name) if words else part.figures.as_numbers(name, names)
            if name not in arrays:
                shape = len(sweep.points), len(positions), *values.shape[1:]
                none, kind = ("", object) if words else (np.nan, None)
                arrays[name] = np.full(shape, none, dtype=kind)
            arrays[name][at] = values
    return positions, names, arrays


def _answered(part: MachineSamples) -> tuple[np.ndarray, np.ndarray]:
    """Return the samples and positions of the answers in a part."""
    each = len(part.rows)
    return part.rows[part.there % each], np.array(part.positions)[part.there // each]


WORDS = ("rest", "spline")
"""Figures of floats that are words."""
TABULATED = ("torque", "coast_torque", "share", "pair_share")
"""Figures in the table of a sweep."""


def largest_shares(sweep: Sweep) -> dict[str, dict[str, np.ndarray]]:
    """Return the largest Ω of every stage and of the system at all points, by mean and stage.

    "omega" is over the mean of the stage, "pair_omega" over that of the group; NaN without one.
    """
    found: dict[str, dict[str, np.ndarray]] = {}
    for part in sweep.answered.parts:
        answers, train = part.solved.found.equilibria, part.solved.machine.train
        force = answers.flank_force.copy()
        force[list(part.refused)] = np.nan
        for number, answer in part.others.items():
            force[number] = share.forces_of(train, [answer.flank_force])[0]
        torques = share.mesh_torques(train, force)
        points = np.array(sweep.usable)[part.rows]
        for name in ("omega", "pair_omega"):
            omegas = share.largest_shares(torques, train.stages, pairs=name == "pair_omega")
            each = found.setdefault(name, {s: np.full(len(sweep.points), np.nan) for s in omegas})
            for stage, values in omegas.items():
                largest = np.fmax.reduce(values.reshape(-1, len(points)), axis=0)
                each[stage][points] = np.fmax(each[stage][points], largest)
    return found


def sweep_frame(sweep: Sweep) -> pd.DataFrame:
    """Tabulate a sweep by point, position and mesh; a refused point has one row and its message."""
    positions, names, arrays = _filled(sweep, (*TABULATED, "residual"))
    worst = arrays.get("residual", np.full((len(sweep.points), 0, 1), np.nan)).max(axis=2)
    point, position = np.nonzero(~np.isnan(worst))
    meshes = names.get("mesh", [])
    columns: dict[str, Any] = {}
    number = np.repeat(point, len(meshes))
    at = np.array(positions, dtype=int)[position]
    columns["position"] = np.repeat(at, len(meshes)).astype(object)
    columns["mesh"] = np.tile(np.array(meshes, dtype=object), len(point))
    for name in TABULATED:
        columns[name] = arrays[name][point, position].reshape(-1) if len(point) else []
    columns["worst_residual"] = np.repeat(worst[point, position], len(meshes))
    table = pd.DataFrame(columns, index=number)
    empty = np.setdiff1d(np.arange(len(sweep.points)), point).tolist()
    if empty:
        table = pd.concat([table, pd.DataFrame({"position": [pd.NA] * len(empty)}, index=empty)])
    else:
        table["position"] = table["position"].astype(int)
    table = table.sort_index(kind="stable")
    order = table.index.to_numpy()
    for k, parameter in enumerate(sweep.parameters):
        table.insert(k, parameter.column, np.array([p.values[k] for p in sweep.points])[order])
    for name in ("status", "message"):
        table[name] = np.array([getattr(p, name) for p in sweep.points], dtype=object)[order]
    return table.reset_index(drop=True)


def sensitivity_dataset(found: Sensitivity) -> xr.Dataset:
    """Build the labelled arrays of a sensitivity.

    Returns
    -------
    xarray.Dataset
        "torque", "share", "pair_share" (position, input, side, mesh), "displacement" (position,
        input, side, gear, component), "omega", "pair_omega" (input, side, stage): derivatives per
        SI unit of the input, and under each name with "_error" added, its stated error. Coordinates
        "value", "unit" and "factor" (SI units per unit) describe the input; "error" is the largest
        stated error of a torque's derivative, "kink" (position) whether the sides may differ.
    """
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
        figure = VARIABLES.get(name, VARIABLES["share" if name == "omega" else "pair_share"])
        largest = "" if name in VARIABLES else "largest "
        what = "stated error of the derivative" if ending else "derivative"
        attributes = {
            "units": f"{figure.units} per SI unit of the input",
            "long_name": f"{what} of the {largest}{figure.long_name}",
        }
        return dims, values, attributes

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

    def over(name: str, *tail: int, kind: type = float) -> np.ndarray:
        rows = [[getattr(step[g], name) for g in gears] for step in found.slips]
        return np.array(rows, dtype=kind).reshape((steps, len(gears), *tail))

    def about(unit: str, text: str) -> dict[str, str]:
        return {"units": unit, "long_name": text}

    turned = about("1", f"revolutions of gear {found.gear}") | {"gear": found.gear}
    slipped = about("m", "slip at the end of the step in the gear's transverse frame")
    return found.result.dataset.assign_coords(spline=gears).assign(
        slip=((*on_spline, "component"), over("slip", 2), slipped),
        dissipated=(
            on_spline,
            over("dissipated"),
            about("J", "energy dissipated by friction in the step"),
        ),
        friction=(on_spline, over("friction"), about("N", "largest friction force")),
        stage=(
            on_spline,
            over("stage", kind=str),
            {"long_name": "whether the spline sticks, slips or stops"},
        ),
        revolutions=("position", list(found.revolutions), turned),
    )
