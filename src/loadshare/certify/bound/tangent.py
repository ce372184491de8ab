r"""Stiffness of a train at claims, with the contact states that the claims have.

Each direction in which an acting element yields is a row with a compliance: a scalar column, or for
a pair its line and the direction across. With rows A, compliances D and a load f,

.. math:: A^T F = f, \qquad A X = D F, \qquad F = (P - G D P) f, \quad
    G = N (N^T D N)^{-1} N^T,

with P and N of the statics (see `Statics`). The compliance of a load is the work that it does,
:math:`F^T D F`: F minimises it, so that an error of F enters it squared and no digit is lost where
stiff parts act next to soft ones. Friction that follows the torque t over a spline adds a push per
torque, and takes part of the room up to a stop. Source: formulation, sections 3, 5 and 6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.certify.bound.acts import Act, first_acts
from loadshare.certify.bound.claim import Claim
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.elements import Elements
from loadshare.certify.bound.laws import elements
from loadshare.certify.bound.statics import Statics
from loadshare.settings import BOUND
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations


@dataclass(frozen=True, eq=False)
class Tangents:
    """How a train yields to a small further load, at each of S claims.

    Attributes
    ----------
    columns : Columns
    flanks : ndarray, shape (S, flanks)
        Stiffness of every flank along its line of action at the force that it carries [N/m]; 0
        where it is open.
    rows : list of ActingRows
        Rows of the acting elements, claim by claim.
    """

    columns: Columns
    flanks: Array
    rows: list[ActingRows]

    def torsion(self, gear: str) -> Array:
        """Return the torque on a gear per rotation of it, (S,) [N·m/rad].

        0 where nothing resists, infinite where nothing yields.
        """
        turn = self.columns.turns[gear]
        if turn.coordinate is None:
            return np.full(len(self.rows), np.inf)
        load = np.zeros(len(self.columns.coordinates))
        load[turn.coordinate] = 1.0
        statics: dict[bytes, Statics] = {}
        for rows in self.rows:
            key = rows.directions.tobytes()
            if key not in statics:
                statics[key] = Statics.of(rows.directions)
        yields = np.array([r.yields(load, statics[r.directions.tobytes()]) for r in self.rows])
        with np.errstate(divide="ignore"):
            return np.asarray(turn.radius**2 / yields)


class ActingRows(NamedTuple):
    """Rows of the acting elements of a claim.

    Attributes
    ----------
    directions, compliance : ndarray, shape (rows, n) and (rows,)
        Direction in the coordinates, and compliance [m/N].
    pushing : ndarray, shape (n, splines)
        Force of friction at every coordinate, per torque over a spline [1/m].
    shrinking : ndarray, shape (rows, splines)
        What friction takes of the length of a row, per torque over a spline [1/N].
    twist : ndarray, shape (splines, rows)
        Torque over a spline per force of a row, positive as claimed [m].
    """

    directions: Array
    compliance: Array
    pushing: Array
    shrinking: Array
    twist: Array

    def yields(self, load: Array, known: Statics) -> float:
        """Return the compliance of a load in its own direction [m/N]; `known` are the statics."""
        d, n = self.compliance, known.redundant
        borne = known.particular @ load
        if np.abs(self.directions.T @ borne - load).max() > BOUND.loose:
            return math.inf
        values, vectors = np.linalg.eigh(n.T @ (d[:, None] * n))
        # A self-stress among rigid parts has no compliance, and no part in the load's work.
        kept = np.abs(values) > BOUND.singular * np.abs(values).max(initial=0.0)
        basis = n @ vectors[:, kept]
        by_gap = basis / values[kept] @ basis.T
        by_load = known.particular - by_gap @ (d[:, None] * known.particular)
        first = by_load @ load
        if not len(self.twist):
            return float(first @ (d * first))
        pushed = by_load @ self.pushing - by_gap @ self.shrinking
        around = np.eye(len(self.twist)) + self.twist @ pushed
        torque = np.linalg.pinv(around) @ (self.twist @ first)
        force = first - pushed @ torque
        return float(first @ (d * force - self.shrinking @ torque))


def tangents_of(columns: Columns, situations: Situations, answers: Equilibria) -> Tangents:
    """Return how a train yields at S answers, assuming that what carries there goes on carrying.

    Parameters
    ----------
    columns : Columns
    situations : Situations
    answers : Equilibria
    """
    claim = Claim(columns, situations, answers)
    with np.errstate(all="ignore"):
        act = first_acts(claim)
        scale = np.maximum(np.abs(claim.forces).max(axis=1, initial=0.0), np.finfo(float).tiny)
        found = elements(claim, act, scale, np.zeros(act.shape, bool), BOUND.softest)
    last = columns.flanks.stop
    soft = np.where(found.active[:, :last], found.soft[:, :last], np.inf)
    with np.errstate(divide="ignore"):
        return Tangents(columns, 1.0 / soft, [_rows(claim, found, k) for k in range(claim.count)])


def _rows(claim: Claim, found: Elements, row: int) -> ActingRows:
    """Return the rows of the acting elements of a claim, and what follows torques over splines."""
    columns, matrix = claim.columns, claim.columns.matrix.high
    scalar = np.flatnonzero(found.active[row, : columns.first_pair])
    directions, yields = list(matrix[scalar]), found.soft[row, scalar].tolist()
    none = np.zeros(len(columns.moments))
    pushing, shrinking = np.zeros((len(columns.coordinates), len(none))), [none] * len(scalar)
    acts = found.act[row, found.act.shape[1] - columns.pairs :]
    for k, (act, line) in enumerate(zip(acts, found.line[row], strict=True)):
        if act == Act.OPEN:
            continue
        at = columns.first_pair + 2 * k
        pair = matrix[at : at + 2]
        soft = np.diag(found.soft[row, at : at + 2]) + found.skew[row, k] * np.eye(2)[::-1]
        along = np.array([1.0, 0.0]) if act in (Act.STICK, Act.PINNED) else line
        ways = [np.array([-along[1], along[0]])]
        shrinking.append(none)
        if act != Act.SLIP:
            ways.append(along)
            shrinking.append(found.shrinks[row, k] * columns.splined[k])
        directions += [way @ pair for way in ways]
        yields += [float(way @ soft @ way) for way in ways]
        pushing += np.outer(line @ pair, found.follows[row, k] * columns.splined[k])
    flanks = scalar[scalar < columns.flanks.stop]
    twist = np.zeros((len(columns.moments), len(directions)))
    twist[:, : len(flanks)] = columns.moments[:, flanks]
    twist *= np.sign(claim.torque_on_splines[row])[:, None]
    return ActingRows(
        np.array(directions).reshape(-1, len(columns.coordinates)),
        np.array(yields),
        pushing,
        np.array(shrinking).reshape(len(directions), len(none)),
        twist,
    )
