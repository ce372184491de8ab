"""What the forces of an equilibrium leave undetermined: the place of least norm, and the ranges."""

from loadshare.solver.undetermined.free_set import free_set
from loadshare.solver.undetermined.places import places

__all__ = ["free_set", "places"]
