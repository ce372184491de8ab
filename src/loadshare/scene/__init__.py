"""The contact problem of one meshing position: named, minimal, dimensionless.

A :class:`~loadshare.scene.scene.Scene` is everything the train does at one position, in SI units
and with nothing left out. A :class:`~loadshare.contact.plan.Plan` says which of it is in play, and
why the rest is not. A :class:`~loadshare.contact.programme.Programme` is what a solver sees.
"""

from loadshare.contact.plan import Plan
from loadshare.contact.programme import Programme
from loadshare.scene.assemble import assemble
from loadshare.scene.scene import Scene

__all__ = ["Plan", "Programme", "Scene", "assemble"]
