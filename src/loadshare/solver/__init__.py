"""From a scene to an equilibrium: the fast method, plans and back-ends, what forces leave open."""

from loadshare.contact.record import Iteration, Options, Record
from loadshare.solver.position import solve_scene

__all__ = ["Iteration", "Options", "Record", "solve_scene"]
