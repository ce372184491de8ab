"""What the compiled bound finds of claims, and where it works."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Numbers
from loadshare.certify.bound.acts import Acts


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
    reach: Array  # error of a force up to which laws hold as assumed [N]
    faint: Array  # the same of what is light
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

    turned: Array  # (gears, w): rotations [rad]
    moved: Array  # (3 gears, w): displacements [m]
    torque: Array  # (gears, w): external [N·m]
    wound: Array  # (shafts, w): torques [N·m]
    borne: Array  # (2 gears, w): forces of bearings [N]
    x: Array  # (n, w): coordinates [m]
    varying: Array  # (…, w): clockings and offsets
    shift: Array  # (3 gears, w): where gears are off their nominal centres [m]
    length: Array  # (m, w) [m]
    at_rest: Array  # (e, w): approach that remains when nothing turns or moves [m]
    across: Array  # (e, w): turns of lines of action
    force: Array  # (m, w) [N]
    excess: Array  # (2 q, w): force of radial elements beyond their graph [N]
    left: Array  # (n, w): load that forces as claimed leave over [N]
    left_over: Array  # (n, w): the same with radial elements on their graphs
    sizes: Array  # (n, w): sum of the sizes of its terms
    claimed: Array  # (c, w): forces of contacts [N]
    acts: Array  # (c, w): how they act
    gap: Array  # (c, w) [m]
    apart: Array  # (rows, w): misfits [m]
    line: Array  # (2 d, 2, w): unit vectors of arcs
    turn: Array  # (2 d, w)
    law: Array  # (4, w): of the contact at hand (see `flank_law`)
    stiffest: Array  # (q, w) [m/N]
    graph: Array  # (q, 6, w): of radial elements
    offset: Array  # (q, 2, w): from their centres [m]
    pull: Array  # (q, 3, w): claimed, in the gear's frame and along its axis [N]
    given: Array  # (w,): any number, as the following one of each claim
    push: Array  # force of the contact at hand if it acts [N]; after the contacts any number
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
    pulled: Array  # largest force that nothing may bear [N]
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
    total: Array  # sum in which nothing that is no number is lost
    behind: Array  # 1 where a gear stands beyond a neighbour
    lawful: Array  # 1 where laws of radial elements have a meaning
    covered: Array  # 1 where the bound covers these as well
