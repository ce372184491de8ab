"""From a scene to an equilibrium: back-ends, the exact active-set solve, the outer loop, verified reduction."""

from loadshare.solver.position import solve_scene
from loadshare.solver.record import METHODS, Iteration, Options, Record

__all__ = ["METHODS", "Iteration", "Options", "Record", "solve_scene"]
