"""What an equilibrium's forces leave undetermined: its least place, and how far it may move."""

from loadshare.solver.undetermined.free_set import FreeSet, free_set
from loadshare.solver.undetermined.places import Places, places

__all__ = ["FreeSet", "Places", "free_set", "places"]
