"""Faults of a law that was written by hand, with which a contact could push without touching."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from loadshare.array_types import floats
from loadshare.contact.law import PowerLaw, TableLaw
from loadshare.contact.radial import Piece, RadialLaw, RollingLaw
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
        case RadialLaw(pieces):
            yield from _pieces(pieces)
        case RollingLaw():
            yield from _rolling(law)


def _number(value: object) -> Any:
    """Return a number, NaN if it is none."""
    number = floats(value)
    return number if np.shape(number) == () and isinstance(number, np.ndarray) else math.nan


def _powers(b: object, c: object) -> Iterator[str]:
    for name, value in (("b", b), ("c", c)):
        if not 0.0 <= _number(value) < math.inf:
            yield f"{name} = {value!r} is not a finite number of at least 0"


def _rolling(law: RollingLaw) -> Iterator[str]:
    if not 0.0 <= _number(law.clearance) < math.inf:
        yield f"clearance = {law.clearance!r} is not a finite number of at least 0"
    for name, value, least in (
        ("stiffness", law.stiffness, 0),
        ("power", law.power, 1),
        ("faint", law.faint, 0),
    ):
        if not least < _number(value) < math.inf:
            yield f"{name} = {value!r} is not a finite number above {least}"


def _points(forces: Any, compressions: Any) -> Iterator[str]:
    for name, values in (("forces", forces), ("compressions", compressions)):
        if not isinstance(values, Sequence | np.ndarray):
            yield f"its {name} {values!r} are no sequence of numbers"
            return
    if len(forces) != len(compressions) or len(forces) < 2:
        counts = f"{len(forces)} forces and {len(compressions)} compressions"
        yield f"has {counts}, but as many of both are needed, at least 2"
        return
    for name, values in (("forces", forces), ("compressions", compressions)):
        numbers = [_number(value) for value in values]
        rises = all(low < high for low, high in pairwise(numbers))
        if numbers[0] != 0.0 or not rises or not all(map(math.isfinite, numbers)):
            yield f"its {name} are not finite numbers rising from 0"


def _pieces(pieces: Any) -> Iterator[str]:
    if not isinstance(pieces, Sequence) or not all(isinstance(p, Piece) for p in pieces):
        yield f"its pieces {pieces!r} are no sequence of Piece"
        return
    if not pieces:
        yield "has no piece"
    sound = bool(pieces)
    for number, piece in enumerate(pieces):
        what = f"piece {number + 1} ({piece.name})"
        force, stiffness, length = map(_number, (piece.force, piece.stiffness, piece.length))
        if not (0.0 <= force < math.inf and 0.0 <= stiffness < math.inf):
            sound = False
            yield f"{what}: force and stiffness must be finite and at least 0"
        if not length >= 0.0:
            sound = False
            yield f"{what}: its length {piece.length!r} is not a number of at least 0"
        if math.isinf(length) and piece is not pieces[-1]:
            yield f"{what}: is endless but not the last one"
    for number, (piece, following) in enumerate(pairwise(pieces if sound else ())):
        if following.force < piece.end_force * (1.0 - LAWS.written):
            yield f"the force falls from piece {number + 1} to the next"
