"""A bound on the torque itself: how far a claimed equilibrium is from the exact one."""

from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.judge import Bounds, bounds, completed, torque_bounds
from loadshare.certify.bound.one import Bound

__all__ = ["Bound", "Bounds", "Columns", "bounds", "completed", "torque_bounds"]
