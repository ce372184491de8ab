"""Picard's outer loop with Clarabel: secant compliances."""

from __future__ import annotations

from benchmarks.peers.clarabel_ import Clarabel


def make(tolerance: float) -> Clarabel:
    """Return Clarabel that keeps its solver, in Picard's loop."""
    return Clarabel(tolerance, update=True, method="picard")
