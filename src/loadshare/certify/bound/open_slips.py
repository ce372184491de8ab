r"""Splines whose friction is used up: how far they have slipped is open, what they carry is not.

Where the force on a gear equals the friction bound :math:`F_m` of its spline, whatever the load,
the gear is in balance anywhere from S1 to S2 along that force. In the case as given, rounding
decides to which end it goes, and no set of acting elements can be identified. As long as its place
changes no force, none is needed: the gear is put at its claimed place, with its place q open within
a rectangle Q along the claimed force :math:`F u`,

.. math:: q \cdot u \in [a, b], \qquad \lvert q \cdot u^\perp \rvert \le w, \qquad
    a = S_1 - \mu, \quad b = S_2 + \mu, \quad w = \mu,

and its spline is left out. The bounds then hold for every q in Q: those of all forces, and so of
the force R(q) that the rest puts on the spline, :math:`\lvert R(q) - F u \rvert \le \epsilon`,
and of the friction bound, which is no less than :math:`F_m^-`. It remains to show that an exact
equilibrium has its place in Q. The law of the spline is the set-valued gradient :math:`\partial W`
of a convex function whose level varies continuously with the torque, so that
:math:`\partial W(q) - R(q)` has compact convex values and is upper semicontinuous: on Q the
variational inequality

.. math:: q^* \in Q, \quad G \in \partial W(q^*) - R(q^*), \quad
    G \cdot (q - q^*) \ge 0 \quad \text{for all } q \in Q

has a solution (Kakutani's fixed point). In the interior of Q that means G = 0, an exact
equilibrium. It cannot be on any side of Q; m(r) is the force of the spline at a radius r:

- far side: there :math:`G \cdot u \le 0`, yet :math:`m(r) \ge F_m^- + K_w (r - S_2)` and r ≥ b, so
  that :math:`\partial W \cdot u \ge (F_m^- + K_w \mu)\, b / \sqrt{b^2 + w^2} > F + \epsilon`;
- near side: there :math:`G \cdot u \ge 0`, yet :math:`r \le \sqrt{a^2 + w^2}` is below S1, so that
  :math:`\partial W \cdot u \le K_w r < F - \epsilon`; and where a < 0,
  :math:`\partial W \cdot u \le 0 < F - \epsilon`;
- lateral sides: there :math:`\pm G \cdot u^\perp \le 0`, yet :math:`m(r) \ge \min(K_w r, F_m^-)`,
  so that :math:`\pm \partial W \cdot u^\perp \ge w \min(K_w, F_m^- / r) > \epsilon`.

Each last inequality is verified with the bounds. If there are several such splines, each has its
own rectangle; Q is their product, and the argument holds for each separately. Source: formulation,
sections 5 and 16.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.settings import BOUND


@dataclass(frozen=True, eq=False)
class OpenSlip:
    """A spline whose friction is used up.

    Attributes
    ----------
    gear : str
    number : int
        Number of the spline.
    force : ndarray, shape (2,)
        Claimed force on the spline [N].
    play : ndarray, shape (2,)
        How far the rectangle reaches from the claimed place along the gear's axes [m].
    """

    gear: str
    number: int
    force: Array
    play: Array


def open_slips(claim: Claim) -> list[OpenSlip]:
    """Return the splines whose friction is used up, of gears that nothing else limits.

    Parameters
    ----------
    claim : Claim
        A single one.
    """
    columns, train = claim.columns, claim.columns.train
    if train.slip is not None:
        return []
    limited = {*train.limits, *(n for r in train.drums for n in r.neighbours)}
    found = []
    for number, gear in enumerate(train.splines):
        support = claim.situations.support[0, columns.order[gear]]
        q = columns.claims.splines.start + number
        both = columns.both(q)
        force = claim.forces[0, both]
        size = math.hypot(*force.tolist())
        _, stick, level, reach, _ = claim.graphs[0, q].tolist()
        if gear in limited or support.any() or not 0.0 <= stick <= reach < math.inf:
            continue
        if size == 0.0 or abs(size - level) > BOUND.used_up * level:
            continue
        way = force / size
        place = claim.lengths[0].value[0, both]
        along, across = float(place @ way), float(place @ [-way[1], way[0]])
        margin = BOUND.margin * reach
        ends = max(reach + margin - along, along - (stick - margin)), abs(across) + margin
        play = np.abs(way) * ends[0] + np.abs(way[::-1]) * ends[1]
        found.append(OpenSlip(gear, number, force, play + EPS * (reach + abs(along))))
    return found


def reaction_error(claim: Claim, slip: OpenSlip, flanks: Array) -> Array:
    """Return the error of the force on such a spline from those of flanks (flanks,), (2,) [N]."""
    columns = claim.columns
    at = columns.places[slip.gear]
    left, rounding = (v[0, at : at + 2] for v in claim.balance(claim.forces))
    pushed = flanks @ np.abs(columns.matrix.high[columns.flanks, at : at + 2])
    return np.asarray((np.abs(left) + rounding + pushed) * (1.0 + EPS))


def is_inside(claim: Claim, slip: OpenSlip, flanks: Array) -> bool:
    """Return whether an exact equilibrium has its place in the rectangle.

    Parameters
    ----------
    claim : Claim
        A single one.
    slip : OpenSlip
    flanks : ndarray, shape (flanks,)
        Errors of the flanks' forces, valid wherever in its rectangle the gear is [N].
    """
    q = claim.columns.claims.splines.start + slip.number
    stiffness, stick, level, reach, _ = claim.graphs[0, q].tolist()
    fixed, rate = claim.situations.spline[0, slip.number, 3:5].tolist()
    size = math.hypot(*slip.force.tolist())
    error = math.hypot(*reaction_error(claim, slip, flanks).tolist()) + EPS * size
    torque = float(flanks @ np.abs(claim.columns.moments[slip.number]))
    torque += EPS * float(
        np.abs(claim.answers.flank_force[0]) @ np.abs(claim.columns.moments[slip.number])
    )
    lost = abs(rate) * torque if math.isnan(fixed) else 0.0
    least = (level - lost) * (1.0 - EPS)
    margin = BOUND.margin * reach
    near, far = stick - margin, math.hypot(reach + margin, margin)
    radius = math.hypot(near, margin)
    return bool(
        (least + stiffness * margin) * (reach + margin) / far > size + error
        and size > error
        and (near < 0.0 or stiffness * radius < min(size - error, stiffness * stick - lost))
        and margin * min(stiffness, least / far) > error
    )
