"""What the forces of an equilibrium leave undetermined: the place of least norm, and the ranges."""

from loadshare.solver.undetermined.free_set import FreeSet, free_set
from loadshare.solver.undetermined.places import Places, places

__all__ = ["FreeSet", "Places", "free_set", "places"]
