"""From a scene to an equilibrium: back-ends, exact active sets, the outer loop, reduction."""

from loadshare.contact.record import METHODS, Iteration, Options, Record
from loadshare.solver.position import solve_scene

__all__ = ["METHODS", "Iteration", "Options", "Record", "solve_scene"]
