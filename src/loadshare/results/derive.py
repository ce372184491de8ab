"""Derive everything in a result from the claims and the train: the only way to make one."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.case.table import Table
from loadshare.results.result import Answered, Position, Result, Stamp
from loadshare.results.share import (
    forces_of,
    largest,
    mesh_torques,
    over_meshes,
    shares,
    torques_of_flanks,
)
from loadshare.train.train import Train

Found = tuple[Train, int, Mapping[str, float], Answered]
"""Train at a position, 1-based index of the position, forces of flanks [N], and the answer."""


def positions_of(found: Sequence[Found]) -> list[Position]:
    """Return the positions of a result from the answers of one machine."""
    if not found:
        return []
    train = found[0][0]
    force = forces_of(train, (forces for _, _, forces, _ in found))
    torques, stages = mesh_torques(train, force), train.stages
    coast = over_meshes(train, np.maximum(-torques_of_flanks(train, force), 0.0))
    shared = [m for stage in stages for m in stage.meshes]
    tables = zip(
        _tables(torques.meshes, torques.net),
        _tables(torques.meshes, coast),
        _tables(torques.meshes, shares(torques, stages), shared),
        _tables(torques.meshes, shares(torques, stages, pairs=True), shared),
        strict=True,
    )
    return [
        Position(index, *each, here, answer)
        for (here, index, _, answer), each in zip(found, tables, strict=True)
    ]


def _tables(
    meshes: Sequence[str], figures: Array, wanted: Sequence[str] | None = None
) -> Iterator[Table[Any]]:
    """Yield a table for each answer of figures (S, meshes) of all or some meshes; None for NaN."""
    names = meshes if wanted is None else wanted
    columns = [meshes.index(name) for name in names]
    for row in figures[:, columns].tolist():
        yield Table(
            {name: None if math.isnan(v) else v for name, v in zip(names, row, strict=True)}
        )


def result_from(
    case: Case,
    solved: Case,
    train: Train,
    positions: Sequence[Position],
    stamped: Callable[[], Stamp],
) -> Result:
    """Assemble a result from positions.

    Parameters
    ----------
    case : Case
        As it was given.
    solved : Case
        The same with its mesh laws computed.
    train : Train
        Of that case.
    positions : sequence of Position
    stamped : callable
        Returns the stamp.
    """
    stages = train.stages
    return Result(
        frames=Table(
            {
                n: (tuple(g.plane[0].tolist()), tuple(g.plane[1].tolist()))
                for n, g in train.gears.items()
            }
        ),
        stages=Table({s.name: s.meshes for s in stages}),
        positions=tuple(positions),
        omega=largest([p.share for p in positions], stages),
        pair_omega=largest([p.pair_share for p in positions], stages),
        case=case,
        solved=solved,
        stamped=stamped,
    )
