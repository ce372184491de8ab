"""The inputs of every sample: of the study's own, and of those for the shares of variance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array
from loadshare.libraries import qmc
from loadshare.settings import JOB, TOLERANCE
from loadshare.study.tolerance.inputs import ScatteredInputs


@dataclass(frozen=True)
class Drawn:
    """Samples drawn in blocks of up to `JOB.block`.

    Attributes
    ----------
    inputs : ScatteredInputs
    count : int
        Rows of each matrix.
    seed : int
    sampling : str
    """

    inputs: ScatteredInputs
    count: int
    seed: int
    sampling: str

    @property
    def matrices(self) -> int:
        """Number of matrices of samples."""
        return 1

    @property
    def _each(self) -> int:
        return -(-self.count // JOB.block)

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return self.matrices * self._each

    def rows(self, block: int) -> NDArray[np.int64]:
        """Return the numbers of a block's samples, from 0."""
        matrix, part = divmod(block, self._each)
        start = matrix * self.count
        return np.arange(start + part * JOB.block, start + min((part + 1) * JOB.block, self.count))

    def values(self, block: int) -> Array:
        """Return the inputs of a block's samples in their units, shape (rows, inputs)."""
        points = uniforms(self.sampling, self.seed, (), block, len(self.inputs.every))
        return self.inputs.values(points[: len(self.rows(block))])


class PickFreeze(Drawn):
    """Saltelli's design: A, B, and A with one unit of inputs after another taken from B.

    Row r of matrix m has the number m · count + r; the matrices are in this order.

    Notes
    -----
    A. Saltelli et al., Variance based sensitivity analysis of model output, Computer Physics
    Communications 181 (2010). Correlated inputs are exchanged together, as one unit.
    """

    @property
    def matrices(self) -> int:
        """Number of matrices: A, B, and one for each unit."""
        return 2 + len(self.inputs.units)

    def values(self, block: int) -> Array:
        """Return the inputs of a block's samples in their units, shape (rows, inputs)."""
        matrix, part = divmod(block, self._each)
        width = len(self.inputs.every)
        both = uniforms(self.sampling, self.seed, (1,), part, 2 * width)[: len(self.rows(block))]
        points, other = both[:, :width].copy(), both[:, width:]
        taken = {0: [], 1: list(range(width))}.get(matrix)
        columns = list(self.inputs.units[matrix - 2]) if taken is None else taken
        points[:, columns] = other[:, columns]
        return self.inputs.values(points)


def uniforms(sampling: str, seed: int, stream: tuple[int, ...], block: int, width: int) -> Array:
    """Return the points of a block, strictly between 0 and 1.

    Parameters
    ----------
    sampling : {"random", "sobol"}
        Independent points, or points of scrambled Sobol sequences in turn: row i of a block belongs
        to sequence i mod `TOLERANCE.sequences`.
    seed : int
    stream : tuple of int
        Separates the points of one study that serve different purposes.
    block : int
        0-based.
    width : int
        Number of coordinates.

    Returns
    -------
    ndarray, shape (JOB.block, width)
    """
    if sampling == "sobol":
        return _sobol(seed, stream, block, width)
    sequence = np.random.SeedSequence(seed, spawn_key=(block, *stream))
    points = np.random.default_rng(sequence).random((JOB.block, width))
    return np.maximum(points, TOLERANCE.smallest)


def _sobol(seed: int, stream: tuple[int, ...], block: int, width: int) -> Array:

    each = JOB.block // TOLERANCE.sequences
    points = np.empty((each, TOLERANCE.sequences, width))
    for r in range(TOLERANCE.sequences):
        source = np.random.SeedSequence(seed, spawn_key=(r, *stream))
        engine = qmc.Sobol(width, scramble=True, seed=np.random.default_rng(source))
        if block:
            engine.fast_forward(block * each)
        points[:, r] = engine.random(each)
    # Points are on a grid of 2^-30 that includes zero; they are moved to the middle of a cell.
    return points.reshape(JOB.block, width) + 2.0**-31
