"""The machine: a case turned into frozen numbers in SI units.

Geometry is settled here once (running senses, lines of action, frames, laws). Every later package
reads a :class:`~loadshare.train.train.Train` and never a case file.
"""

from loadshare.train.build import build_train
from loadshare.train.train import Train

__all__ = ["Train", "build_train"]
