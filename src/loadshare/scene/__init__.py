"""The contact problem of one position, with named coordinates and rows.

A :class:`~loadshare.scene.scene.Scene` is the whole train at one position, in SI units and with
nothing left out. A :class:`~loadshare.contact.plan.Plan` says which parts of it are in play, and
why the rest is not. A :class:`~loadshare.contact.programme.Programme` is what a solver sees.
"""

from loadshare.contact.plan import Plan
from loadshare.scene.assemble import assemble
from loadshare.scene.scene import Scene

__all__ = ["Plan", "Scene", "assemble"]
