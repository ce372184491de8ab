"""Figures of every element at a claim."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.array_types import Array, Flags
from loadshare.certify.bound.acts import Acts


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements at S claims.

    Attributes
    ----------
    act : ndarray of int8, shape (S, elements)
        Flanks, stops, arcs, radial elements.
    active : ndarray of bool, shape (S, m)
        Columns that act.
    force : ndarray, shape (S, m)
        F of the columns [N]: what is claimed, along the line of the element where it has one.
    rounding : ndarray, shape (S, m)
        Rounding of this force [N].
    soft, skew : ndarray, shape (S, m) and (S, pairs)
        Compliance: diagonal, and off the diagonal for elements with two columns [m/N].
    misfit, width : ndarray, shape (S, m)
        A X − g − δ(F) [m], and its rounding.
    curve : ndarray, shape (S, m)
        Curvature of the law, as the part of the compliance that goes with F^(−1/3), over F.
    room : ndarray, shape (S, m)
        Error of the force [N] up to which these figures describe the law: beyond it, a light
        contact is stiffer, and a table has another corner.
    line, distance, size : ndarray, shape (S, pairs, 2), (S, pairs), (S, pairs)
        u, |d| [m] and the force along it [N].
    along : ndarray, shape (S, pairs)
        Compliance along the line [m/N].
    bent : ndarray, shape (S, pairs)
        Largest change of the compliance along the line per force [m/N²], from half to twice it.
    stiff_error : ndarray, shape (S, pairs)
        Lateral stiffness that `soft` and `skew` leave out or add [N/m].
    follows, shrinks : ndarray, shape (S, pairs)
        Change of the level [1/m], and of the room up to a stop [1/N], per torque over the spline;
        0 where it does not enter.
    spare : ndarray, shape (S, radials)
        Change of friction that is put aside, per torque [1/m].
    begins : ndarray of bool, shape (S, pairs)
        Slips that are zero so far: u is the direction of the friction.
    centred : ndarray, shape (S, pairs)
        Largest compliance of power-law walls that carry nothing at their centre [m/N], see `pairs`;
        0 for all others.
    """

    act: Acts
    active: Flags
    force: Array
    rounding: Array
    soft: Array
    skew: Array
    misfit: Array
    width: Array
    curve: Array
    room: Array
    line: Array
    distance: Array
    size: Array
    along: Array
    bent: Array
    stiff_error: Array
    follows: Array
    shrinks: Array
    spare: Array
    begins: Flags
    centred: Array
