"""Clarabel with `update`: one solver for all samples."""

from __future__ import annotations

from benchmarks.peers.clarabel_ import Clarabel


def make(tolerance: float) -> Clarabel:
    """Return Clarabel that keeps its solver."""
    return Clarabel(tolerance, update=True)
