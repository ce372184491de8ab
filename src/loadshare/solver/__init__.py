"""From a scene to an equilibrium: back-ends, exact active sets, the outer loop, reduction."""

from loadshare.solver.position import solve_scene
from loadshare.solver.record import METHODS, Iteration, Options, Record

__all__ = ["METHODS", "Iteration", "Options", "Record", "solve_scene"]
