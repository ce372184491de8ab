"""Resuming a study: parts that exist are checked by solving some of their samples again.

A part holds only the largest figures of some ten thousand certified answers, so it cannot itself be
certified. A few of its samples can, because the study says how all of them were drawn.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from loadshare.array_types import Array
from loadshare.case.words import as_given
from loadshare.errors import Problem, ResultError
from loadshare.libraries import pa
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.folder import Folder, read_part
from loadshare.study.tolerance.job import Job, Part

AGAIN = "Delete this file and repeat the command: the part is then solved again."


def check_part(folder: Folder, part: Part) -> None:
    """Solve some samples of a part again; the study and the part determine which.

    Parameters
    ----------
    folder : Folder
    part : Part
        One that exists.

    Raises
    ------
    ResultError
        If the part's inputs are not those that the study draws, or a sample's figures are not those
        of its answer. Displacements of floats are not compared: they may be undetermined.
    """
    job, file = folder.job, str(folder.file(part))
    table = read_part(folder.file(part))
    rng = np.random.default_rng(list(hashlib.sha256(job.stamp(part)).digest()))
    design, blocks = job.designs[part.design], job.blocks(part.design, part.number)
    block = int(rng.choice(blocks))
    first = sum(len(design.rows(b)) for b in range(blocks.start, block))
    numbers, values = design.rows(block), design.values(block)
    there = table.slice(first, len(numbers))
    drawn = {one.column: values[:, k] for k, one in enumerate(job.inputs.every)}
    for name, column in {"sample": numbers, **drawn}.items():
        found = _column(there, name, file)
        if not np.array_equal(found, column):
            row = int(np.flatnonzero(found != column)[0])
            _refuse(file, name, int(numbers[row]), found[row], column[row])
    rows = rng.choice(len(numbers), min(TOLERANCE.sampled, len(numbers)), replace=False)
    again = job.solve(values[rows])
    least = _round_off(job, again.columns)
    for name, expected in {**again.columns, "certified": ~np.isnan(again.residual)}.items():
        found = _column(there, name, file)[rows]
        if name.startswith("float."):
            continue
        atol = least.get(name.partition(" ")[2], 0.0)
        off = ~np.isclose(found, expected, rtol=TOLERANCE.apart, atol=atol, equal_nan=True)
        if off.any():
            k = int(np.flatnonzero(off)[0])
            _refuse(file, name, int(numbers[rows[k]]), found[k], expected[k])


def _round_off(job: Job, columns: Mapping[str, Array]) -> dict[str, float]:
    """Return what a certificate leaves open of figures, by unit: its tolerance times the largest.

    A stop that a gear just touches carries nothing but round-off.
    """
    train, known = job.train, job.settings["tolerance"]
    torque = {
        m: np.fmax.reduce(np.abs(columns[f"torque.{m} [N*m]"]), initial=0.0) for m in train.meshes
    }
    force = [found / train.meshes[mesh].radii[0] for mesh, found in torque.items()]
    return {"[N*m]": known * max(torque.values()), "[N]": known * max(force)}


def _column(table: pa.Table, name: str, file: str) -> np.ndarray[Any, Any]:
    if name not in table.column_names:
        raise ResultError([Problem(file, name, "", "is missing", "", AGAIN)])
    return np.asarray(table.column(name).to_numpy())


def _refuse(file: str, name: str, sample: int, found: object, expected: object) -> None:
    message = f"is not what sample {sample} of this study gives"
    raise ResultError([Problem(file, name, as_given(found), message, as_given(expected), AGAIN)])
