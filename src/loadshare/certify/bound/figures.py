"""What the compiled bound finds of claims, and where it works."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Numbers

Acts = NDArray[np.int8]


class Found(NamedTuple):
    """Figures of S claims."""

    number: Numbers  # (S,): of what acts; −1 if there is too much of it
    acts: Acts  # (S, c + q)
    misfit: Array  # (S, rows) [m]
    left: Array  # (S, n): of the balance [N]
    soft: Array  # (S, q): compliance where a radial element stands [m/N]
    spare: Array  # (S, q): by how much its force may change there [N]
    slip: Array  # (S, q, 2): unit vector along a slip, 0 of anything else
    rate: Array  # (S, q): change of its force with the torque [1/m]
    held: Array  # (S, q): change of the torque at which that begins to matter [N·m]
    scale: Array  # (S,): load [N], as the following
    largest: Array  # torque [N·m]
    push: Array  # largest force [N]
    residual: Array  # largest one of balance [N]
    rounding: Array  # of that [N]
    width: Array  # rounding of lengths [m]
    reach: Array  # error of a force up to which laws of contacts hold as assumed [N]
    room: Array  # smallest gap of what does not act [m]
    aside: Array  # largest torque of what is put aside [N·m]
    turned: Array  # largest turn of an arc's line
    bow: Array  # largest force of an arc over its distance [N/m]
    worst: Array  # largest scaled residual; not a number where two opposed contacts carry
    deflection: Array  # of the case [m]
    displaced: Array  # displacements over what is warned of; not a number where that is for NumPy


class Sets(NamedTuple):
    """Sets of elements that act: their first claim, smallest and largest compliances [m/N]."""

    first: Numbers
    key: NDArray[np.uint64]
    least: Array  # (…, c + springs + q)
    most: Array


class Workspace(NamedTuple):
    """What is found of the claims at hand, overwritten by the next; w of them stand abreast."""

    x: Array  # (n, w): coordinates [m]
    varying: Array  # (…, w): clockings and offsets
    shift: Array  # (3 gears, w): where gears are off their nominal centres [m]
    length: Array  # (m, w) [m]
    at_rest: Array  # (e, w): approach that remains when nothing turns or moves [m]
    across: Array  # (e, w): turns of lines of action
    force: Array  # (m, w) [N]
    excess: Array  # (2 q, w): force of radial elements beyond their graph [N]
    left: Array  # (n, w): load that is left over [N]
    sizes: Array  # (n, w): sum of the sizes of its terms
    gap: Array  # (c,) [m]
    line: Array  # (2 d, 2): unit vectors of arcs
    turn: Array  # (2 d,)
    stiffest: Array  # (q,) [m/N]
    law: Array  # (q, 6): of radial elements
    offset: Array  # (q, 2): from their centres [m]
    pull: Array  # (q, 3): claimed, in the gear's frame and along its axis [N]
