"""Points in the unit cube, block by block: each block is the same whoever asks for it."""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import JOB, TOLERANCE


def uniforms(sampling: str, seed: int, stream: tuple[int, ...], block: int, width: int) -> Array:
    """Return the points of a block, strictly between 0 and 1.

    Parameters
    ----------
    sampling : {"random", "sobol"}
        Independent points; or points of scrambled Sobol sequences in turn: row i of a block belongs
        to sequence i mod `TOLERANCE.sequences`.
    seed : int
    stream : tuple of int
        Tells apart the points of one study that serve different ends.
    block : int
        0-based.
    width : int
        Number of coordinates.

    Returns
    -------
    ndarray, shape (BLOCK, width)
    """
    if sampling == "sobol":
        return _sobol(seed, stream, block, width)
    sequence = np.random.SeedSequence(seed, spawn_key=(block, *stream))
    points = np.random.default_rng(sequence).random((JOB.block, width))
    return np.maximum(points, TOLERANCE.smallest)


def _sobol(seed: int, stream: tuple[int, ...], block: int, width: int) -> Array:
    from scipy.stats import qmc

    each = JOB.block // TOLERANCE.sequences
    points = np.empty((each, TOLERANCE.sequences, width))
    for r in range(TOLERANCE.sequences):
        source = np.random.SeedSequence(seed, spawn_key=(r, *stream))
        engine = qmc.Sobol(width, scramble=True, seed=np.random.default_rng(source))
        if block:
            engine.fast_forward(block * each)
        points[:, r] = engine.random(each)
    # Points are on a grid of 2^-30, zero included; the middle of a cell is as good as its edge.
    return points.reshape(JOB.block, width) + 2.0**-31
