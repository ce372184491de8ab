"""Results: immutable, labelled, stamped, saved and loaded bit for bit."""

from loadshare.results.result import Effort, Position, Result, Stamp

__all__ = ["Effort", "Position", "Result", "Stamp"]
