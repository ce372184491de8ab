"""Answers of many samples as one labelled table, filled block by block."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from loadshare.case import Case
from loadshare.train.equilibria import Equilibria
from loadshare.train.train import Stage

if TYPE_CHECKING:
    import xarray as xr

    from loadshare.job.many import Block

Array = NDArray[np.float64]


def mesh_torques(answers: Equilibria) -> tuple[Array, tuple[str, ...]]:
    """Return torques at the drivers [N·m], drive less coast, (S, meshes), and the meshes."""
    meshes = answers.names.train.meshes
    lever = np.zeros((answers.flank_force.shape[1], len(meshes)))
    flank = 0
    for m, mesh in enumerate(meshes.values()):
        for drive in mesh.flanks:
            lever[flank, m] = mesh.lever(drive)
            flank += 1
    return answers.flank_force @ lever, tuple(meshes)


def shares(torque: Array, meshes: tuple[str, ...], stages: Iterable[Stage], pairs: bool) -> Array:
    """Return Ω of every mesh, shape (S, meshes): over its stage's mean, or over its group's.

    NaN for a mesh of no stage, and where a group carries nothing.
    """
    found = np.full_like(torque, np.nan)
    order = {m: k for k, m in enumerate(meshes)}
    with np.errstate(invalid="ignore", divide="ignore"):
        for stage in stages:
            for group in stage.groups if pairs else (stage.meshes,):
                columns = [order[m] for m in group]
                mean = torque[:, columns].mean(axis=1)
                found[:, columns] = (
                    torque[:, columns] / np.where(mean != 0.0, mean, np.nan)[:, None]
                )
    return found


class Table:
    """Variables of all samples, filled block by block."""

    def __init__(self, first: Block, count: int, keep: tuple[str, ...]) -> None:
        names = first.equilibria[0].names
        self.positions, self.keep, self.names = first.positions, keep, names
        train = names.train
        self.moving = [k for k, g in enumerate(train.gears.values()) if g.moves]
        # From the displacements of all gears to those that can move, in their frames.
        frames = np.zeros((len(train.gears), 3, len(self.moving), 2))
        for column, k in enumerate(self.moving):
            frames[k, :, column] = list(train.gears.values())[k].frame.T
        self.frames = frames.reshape(3 * len(train.gears), -1)
        shape = (count, len(first.positions))
        sizes = {
            "torque": (len(train.meshes),),
            "share": (len(train.meshes),),
            "pair_share": (len(train.meshes),),
            "displacement": (len(self.moving), 2),
            "contact_force": (len(names.contacts),),
        }
        self.values = {name: np.full((*shape, *sizes[name]), np.nan) for name in keep}
        self.residual = np.full(shape, np.nan)
        self.bound = np.full(shape, np.nan)
        self.certified = np.zeros(shape, dtype=bool)
        self.determined = np.zeros(shape, dtype=bool)
        self.displaced, self.arc_curvature = np.full((2, *shape), np.nan)
        self.convex = np.zeros(shape, dtype=bool)
        self.rung = np.full(shape, "", dtype="<U24")
        self.message: dict[str, str] = {}

    def write(self, block: Block) -> None:
        """Write a block in its place."""
        rows = block.rows
        self.residual[rows] = block.residual
        self.bound[rows] = block.bound
        self.certified[rows] = block.certified
        self.determined[rows] = block.determined
        self.displaced[rows] = block.displaced
        self.convex[rows] = block.convex
        self.arc_curvature[rows] = block.arc_curvature
        self.rung[rows] = block.rung
        for (row, index), why in block.message.items():
            self.message[f"sample {row}, position {index}"] = why
        place = slice(rows[0], rows[-1] + 1) if rows[-1] - rows[0] == len(rows) - 1 else rows
        stages = self.names.train.stages
        for p, answers in enumerate(block.equilibria):
            torque, meshes = mesh_torques(answers)
            values = self.values
            if "torque" in values:
                values["torque"][place, p] = torque
            for name, pairs in (("share", False), ("pair_share", True)):
                if name in values:
                    values[name][place, p] = shares(torque, meshes, stages, pairs=pairs)
            if "displacement" in values:
                flat = answers.displacement.reshape(len(rows), -1)
                values["displacement"][place, p] = (flat @ self.frames).reshape(len(rows), -1, 2)
            if "contact_force" in values:
                values["contact_force"][place, p] = answers.ring_force

    def dataset(self, case: Case, tolerance: float) -> xr.Dataset:
        """Return everything with labels."""
        import xarray as xr

        from loadshare._version import __version__

        axes = {
            "torque": ("mesh",),
            "share": ("mesh",),
            "pair_share": ("mesh",),
            "displacement": ("gear", "axis"),
            "contact_force": ("contact",),
        }
        units = {"torque": "N*m", "displacement": "m", "contact_force": "N"}
        every = ("sample", "position")
        variables = {
            name: ((*every, *axes[name]), self.values[name], {"units": units.get(name, "1")})
            for name in self.keep
        }
        train = self.names.train
        gears = list(train.gears)
        coords = {
            "sample": np.arange(len(self.residual)),
            "position": list(self.positions),
            "mesh": list(train.meshes),
            "gear": [gears[k] for k in self.moving],
            "axis": ["x", "y"],
            "contact": list(self.names.contacts),
        }
        used = {axis for name in self.keep for axis in axes[name]} | set(every)
        return xr.Dataset(
            {
                **variables,
                "residual": (every, self.residual),
                "torque_bound": (every, self.bound),
                "certified": (every, self.certified),
                "determined": (every, self.determined),
                "displaced": (every, self.displaced),
                "convex": (every, self.convex),
                "arc_curvature": (every, self.arc_curvature, {"units": "N/m"}),
                "rung": (every, self.rung),
            },
            coords={k: v for k, v in coords.items() if k in used},
            attrs={
                "case": case.name,
                "case_hash": case.hash,
                "version": __version__,
                "tolerance": tolerance,
                "warned": int((self.displaced > 1.0).sum()),
                "refused": self.message,
            },
        )
