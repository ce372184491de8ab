"""Faults of a law that was written by hand, with which a contact could push without touching."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from loadshare.contact.law import PowerLaw, TableLaw
from loadshare.contact.radial import RadialLaw
from loadshare.settings import LAWS


def law_faults(law: object) -> Iterator[str]:
    """Yield why a law of this package is not a compression that grows with its force.

    Parameters
    ----------
    law : object
        Laws that are not of this package are not checked.
    """
    match law:
        case PowerLaw(b, c):
            yield from _powers(b, c)
        case TableLaw(forces, compressions):
            yield from _points(forces, compressions)
        case RadialLaw(pieces) if not pieces:
            yield "has no piece"
        case RadialLaw():
            yield from _pieces(law)


def _powers(b: float, c: float) -> Iterator[str]:
    for name, value in (("b", b), ("c", c)):
        if not 0.0 <= value < math.inf:
            yield f"{name} = {value!r} is not a finite number of at least 0"


def _points(forces: Sequence[float], compressions: Sequence[float]) -> Iterator[str]:
    if len(forces) != len(compressions) or len(forces) < 2:
        counts = f"{len(forces)} forces and {len(compressions)} compressions"
        yield f"has {counts}, but as many of both are needed, at least 2"
        return
    for name, values in (("forces", forces), ("compressions", compressions)):
        rises = all(low < high for low, high in pairwise(values))
        if values[0] != 0.0 or not rises or not all(map(math.isfinite, values)):
            yield f"its {name} are not finite numbers rising from 0"


def _pieces(law: RadialLaw) -> Iterator[str]:
    for number, piece in enumerate(law.pieces):
        what = f"piece {number + 1} ({piece.name})"
        if not (0.0 <= piece.force < math.inf and 0.0 <= piece.stiffness < math.inf):
            yield f"{what}: force and stiffness must be finite and at least 0"
        if not piece.length >= 0.0:
            yield f"{what}: its length {piece.length!r} is not a number of at least 0"
        if math.isinf(piece.length) and piece is not law.pieces[-1]:
            yield f"{what}: is endless but not the last one"
    for number, (piece, following) in enumerate(pairwise(law.pieces)):
        if following.force < piece.end_force * (1.0 - LAWS.written):
            yield f"the force falls from piece {number + 1} to the next"
