"""Answers of many samples as one labelled table, filled block by block."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import starmap
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare._version import __version__
from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.job.block import RUNGS, UNANSWERED, Block
from loadshare.results.dataset import VARIABLES, Variable
from loadshare.results.figures import COMPONENTS
from loadshare.results.share import MeshTorques, mesh_torques, shares
from loadshare.settings import JOB
from loadshare.train.equilibria import Equilibria, Names
from loadshare.train.train import Train

if TYPE_CHECKING:
    import xarray as xr

    from loadshare.progress import Progress


EVERY = ("sample", "position")
KEPT: dict[str, Variable] = {
    **{name: VARIABLES[name] for name in ("torque", "share", "pair_share", "displacement")},
    "contact_force": Variable(("contact",), "N", "force of a contact of a ring"),
}
"""Variables of each sample at each position, if they are requested."""
SHARES = ("share", "pair_share")
"""Variables that follow from torques."""
USUAL = ("torque", "share", "pair_share")
"""Variables that are kept if nothing else is requested."""


def checked(names: Any) -> tuple[str, ...]:
    """Return the variables to keep.

    Raises
    ------
    ValueError
        If one of them does not exist.
    """
    single = isinstance(names, str | bytes) or not isinstance(names, Iterable)
    every = (names,) if single else tuple(names)
    unknown = [name for name in every if name not in [*KEPT]]
    if unknown:
        raise ValueError(f"no variable {', '.join(map(str, unknown))}; allowed: {', '.join(KEPT)}")
    return every


EACH = {
    "residual": Variable((), "1", "largest scaled residual of the certificate"),
    "torque_bound": Variable(
        (), "1", "largest distance of a torque from the exact one, over the largest torque"
    ),
    "certified": Variable((), "1", "whether the answer is certified"),
    "determined": Variable((), "1", "whether every displacement is determined"),
    "displaced": Variable((), "1", "displacements over the bound of a warning"),
    "convex": Variable((), "1", "whether nothing that is not convex carries"),
    "arc_curvature": Variable((), "N/m", "stiffness that arcs take across them"),
    "rung": Variable((), "1", "rung (method) that answered"),
}
"""Variables of each sample at each position, which a block has as fields."""


def _refused(where: tuple[int, int], why: str) -> str:
    """Return a line that says why a sample has no answer at a position."""
    sample, position = where
    return f"sample {sample}, position {position}: {' '.join(why.splitlines())}"


def _displacements(answers: Equilibria, gears: list[str]) -> Array:
    """Return displacements of some gears in their planes, (S, gears, 2) [m]."""
    order = answers.names.train.order
    frames = np.zeros((3 * len(order), 2 * len(gears)))
    for column, gear in enumerate(gears):
        rows = slice(3 * order[gear], 3 * order[gear] + 3)
        frames[rows, 2 * column : 2 * column + 2] = answers.names.train.gears[gear].plane.T
    flat = answers.displacement.reshape(len(answers.displacement), -1)
    return np.asarray((flat @ frames).reshape(len(flat), len(gears), 2))


@lru_cache(maxsize=16)
def _coordinates(count: int, *labels: tuple[str, tuple[Any, ...]]) -> xr.Coordinates:
    """Return labels of samples and other dimensions, cached for batches of the same labels."""
    import xarray as xr

    every = {"sample": np.arange(count), **{dim: np.array(names) for dim, names in labels}}
    return xr.Coordinates(
        # `fastpath` takes labels as they are: any closer look at them would import dask first.
        {dim: xr.Variable(dim, names, fastpath=True) for dim, names in every.items()}
    )


class AnswerTable:
    """Variables of all samples, filled block by block."""

    def __init__(
        self,
        trains: Sequence[Train],
        positions: tuple[int, ...],
        count: int,
        keep: tuple[str, ...],
    ) -> None:
        gears = {name: None for t in trains for name, gear in t.gears.items() if gear.moves}
        contacts = {name: None for t in trains for name in Names(t).contacts}
        self.coords: dict[str, Any] = {
            "sample": np.arange(count),
            "position": list(positions),
            "mesh": list(trains[0].meshes),
            "gear": list(gears),
            "component": list(COMPONENTS),
            "contact": list(contacts),
        }
        self.keep = keep
        self.stages = trains[0].stages
        # Shares follow from torques, unless trains group their meshes into different stages.
        alike = all(train.stages == self.stages for train in trains)
        later = [name for name in keep if alike and name in SHARES]
        self.largest = self._empty(np.nan, ())
        written = [name for name in keep if name not in later]
        if later and "torque" not in written:
            written.append("torque")
        self.variables = {name: self._empty(np.nan, KEPT[name].dims) for name in written}
        self.each = {name: self._empty(UNANSWERED[name], ()) for name in EACH}
        self.message: dict[tuple[int, int], str] = {}

    def _empty(self, value: Any, dims: tuple[str, ...]) -> np.ndarray:
        return np.full([len(self.coords[d]) for d in (*EVERY, *dims)], value)

    def fill(self, blocks: Iterable[Block], progress: Progress | None = None) -> None:
        """Write all blocks, and report after each how many samples are done."""
        done, count = 0, len(self.coords["sample"])
        for block in blocks:
            self.write(block)
            done += len(block.rows)
            if progress is not None:
                progress(done, count)

    def write(self, block: Block) -> None:
        """Write a block in its place."""
        rows = block.rows
        # Samples of one train often follow one another; a slice is written at once.
        place = slice(rows[0], rows[-1] + 1) if rows[-1] - rows[0] == len(rows) - 1 else rows
        for name, values in self.each.items():
            values[place] = getattr(block, name)
        self.message |= block.message
        for p, answers in enumerate(block.equilibria):
            torques = mesh_torques(answers.names.train, answers.flank_force)
            self.largest[place, p] = torques.largest
            for name, values in self.variables.items():
                elements, found = self._read(name, answers, torques)
                dim = KEPT[name].dims[0]
                if elements == self.coords[dim]:
                    values[place, p] = found
                else:
                    at = [self.coords[dim].index(element) for element in elements]
                    values[rows[:, None], p, at] = found

    def _read(
        self, name: str, answers: Equilibria, torques: MeshTorques
    ) -> tuple[list[str], Array]:
        """Return a variable of answers at one position, and the elements that it is of."""
        train = answers.names.train
        if name == "displacement":
            # A gear that does not move in these samples may do so in others.
            gears = self.coords["gear"]
            return gears, _displacements(answers, gears)
        if name == "contact_force":
            return list(answers.names.contacts), answers.ring_force
        found = torques.net
        if name != "torque":
            found = shares(torques, train.stages, pairs=name == "pair_share")
        return list(torques.meshes), found

    def _values(self, name: str) -> Any:
        """Return the values written, or an array that is computed from them when read."""
        if name in self.variables:
            return self.variables[name]
        from loadshare.job.derived import shares_when_read

        meshes, torque, pairs = self.coords["mesh"], self.variables["torque"], name == "pair_share"
        return shares_when_read(meshes, torque, self.largest, self.stages, pairs)

    def dataset(self, case: Case, tolerance: float) -> xr.Dataset:
        """Return everything with labels."""
        import xarray as xr

        found = {name: KEPT[name].labelled(self._values(name), *EVERY) for name in self.keep}
        found |= {name: each.labelled(self.each[name], *EVERY) for name, each in EACH.items()}
        data = {
            name: xr.Variable(dims, values, attributes, fastpath=True)
            for name, (dims, values, attributes) in found.items()
        }
        # Numbers are named as in the climate and forecast (CF) conventions.
        data["rung"].attrs["flag_values"] = np.arange(len(RUNGS), dtype=np.int8)
        data["rung"].attrs["flag_meanings"] = " ".join(r.replace(" ", "_") for r in RUNGS)
        used = {dim for variable in data.values() for dim in variable.dims} - {"sample"}
        labels = {dim: tuple(names) for dim, names in self.coords.items() if dim in used}
        count = len(self.coords["sample"])
        coordinates = _coordinates if count <= JOB.block else _coordinates.__wrapped__
        return xr.Dataset(
            data,
            coords=coordinates(count, *labels.items()),
            attrs={
                "case": case.name,
                "case_hash": case.hash,
                "loadshare_version": __version__,
                "tolerance": tolerance,
                "warned": int((self.each["displaced"] > 1.0).sum()),
                # A text: netCDF has no tables, and no lists of fewer than two entries.
                "refused": "\n".join(starmap(_refused, sorted(self.message.items()))),
            },
        )
