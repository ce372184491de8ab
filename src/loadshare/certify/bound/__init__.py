"""A bound on the torque itself: how far a claimed equilibrium is from the exact one."""

from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.judge import Bounds, bounds, completed, torque_bounds
from loadshare.certify.bound.one import Bound, bound_of

__all__ = ["Bound", "Bounds", "Columns", "bound_of", "bounds", "completed", "torque_bounds"]
