"""The figures of claims that the compiled bound finds, and its workspace."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Numbers
from loadshare.certify.bound.acts import Acts


class ClaimFigures(NamedTuple):
    """Figures of S claims."""

    number: Numbers  # (S,): of the set that acts; −1 if there are too many sets
    acts: Acts  # (S, c + q)
    misfit: Array  # (S, rows) [m]
    left: Array  # (S, n): residual of balance [N]
    soft: Array  # (S, q): compliance of a radial element at the claim [m/N]
    spare: Array  # (S, q): by how much its force may change there [N]
    slip: Array  # (S, q, 2): unit vector along a slip, 0 if it does not slip
    rate: Array  # (S, q): change of its force with the torque [1/m]
    held: Array  # (S, q): change of the torque at which that begins to matter [N·m]
    scale: Array  # (S,): load [N]; the following have this shape too
    largest: Array  # torque [N·m]
    push: Array  # largest force [N]
    residual: Array  # largest residual of balance [N]
    rounding: Array  # of this residual [N]
    width: Array  # rounding of lengths [m]
    reach: Array  # error of a force up to which laws hold as assumed [N]
    faint: Array  # the same for light elements
    room: Array  # smallest gap of elements that do not act [m]
    aside: Array  # largest torque of forces that are put aside [N·m]
    turned: Array  # largest turn of an arc's line
    bow: Array  # largest force of an arc over its distance [N/m]
    worst: Array  # largest scaled residual; NaN where two opposed contacts carry
    deflection: Array  # of the case [m]
    displaced: Array  # displacements over their warning levels; NaN where left to NumPy


class Sets(NamedTuple):
    """Sets of elements that act: their first claim, smallest and largest compliances [m/N]."""

    first: Numbers
    key: NDArray[np.uint64]
    least: Array  # (…, c + springs + q)
    most: Array


class Workspace(NamedTuple):
    """Figures of w claims side by side, overwritten by those of the next claims."""

    turned: Array  # (gears, w): rotations [rad]
    moved: Array  # (3 gears, w): displacements [m]
    torque: Array  # (gears, w): external [N·m]
    wound: Array  # (shafts, w): torques [N·m]
    borne: Array  # (2 gears, w): forces of bearings [N]
    x: Array  # (n, w): coordinates [m]
    varying: Array  # (…, w): clockings and offsets
    shift: Array  # (3 gears, w): how far gears are off their nominal centres [m]
    length: Array  # (m, w) [m]
    at_rest: Array  # (e, w): approach that remains when nothing turns or moves [m]
    across: Array  # (e, w): turns of lines of action
    force: Array  # (m, w) [N]
    excess: Array  # (2 q, w): force of radial elements beyond their graph [N]
    left: Array  # (n, w): load that the claimed forces leave over [N]
    left_over: Array  # (n, w): the same with radial elements on their graphs
    sizes: Array  # (n, w): sum of the sizes of its terms
    claimed: Array  # (c, w): forces of contacts [N]
    acts: Array  # (c, w): how they act
    gap: Array  # (c, w) [m]
    apart: Array  # (rows, w): misfits [m]
    line: Array  # (2 d, 2, w): unit vectors of arcs
    turn: Array  # (2 d, w)
    law: Array  # (4, w): of the present contact (see `flank_law`)
    stiffest: Array  # (q, w) [m/N]
    graph: Array  # (q, 6, w): of radial elements
    offset: Array  # (q, 2, w): from their centres [m]
    pull: Array  # (q, 3, w): claimed, in the gear's frame and along its axis [N]
    given: Array  # (w,): temporary; the following have this shape too
    push: Array  # force of the present contact if it acts [N]; after the contacts temporary
    root: Array  # its cube root
    band: Array  # force up to which a contact may as well be open [N]
    light: Array  # force below which a contact is light [N]
    root_of_light: Array
    resolution: Array  # of lengths [m]
    limits: Array  # largest gap or float [m]
    approach: Array  # largest one [m]
    widest: Array  # widest gap [m]
    top: Array  # largest force of a flank [N]
    longest: Array  # longest radial element [m]
    yielded: Array  # largest compression [m]
    bent: Array  # deflection of flanks [m]
    weakest: Array  # smallest force of a contact [N]
    misfit: Array  # longest one, beside residuals of other lengths [m]
    energy: Array  # largest work of a force along its misfit [J]
    pulled: Array  # largest force that an element must not carry [N]
    scale: Array  # as in `Found`, and the following
    largest: Array
    largest_push: Array
    residual: Array
    rounding: Array
    width: Array
    reach: Array
    faint: Array
    room: Array
    aside: Array
    turned_lines: Array
    bow: Array
    worst: Array
    deflection: Array
    displaced: Array
    total: Array  # sum that keeps every NaN
    behind: Array  # 1 where a gear is beyond a neighbour
    lawful: Array  # 1 where laws of radial elements have a meaning
    covered: Array  # 1 where the bound covers these as well
