"""The smooth equations that hold as long as an active set does, and when it ceases to."""

from loadshare.study.branch.active import ActiveSet, Place, read_set
from loadshare.study.branch.system import Branch, Units

__all__ = ["ActiveSet", "Branch", "Place", "Units", "read_set"]
