r"""Stiffness of a train at a claim, with the contact states that the claim has.

What acts is one row each along which it yields by a compliance: a scalar column, or of a pair its
line and what is across. With rows A, compliances D and a load f,

.. math:: A^T F = f, \qquad A X = D F, \qquad F = (P - G D P) f, \quad
    G = N (N^T D N)^{-1} N^T,

P and N those of the statics (see `Statics`). The compliance of a load is the work that it does,
:math:`F^T D F`: F makes it least, so that an error of F enters it squared and no figure is lost
where stiff parts act beside soft ones. Friction that follows the torque t over a spline adds what
the torque pushes by, and what it takes of the room up to a stop. Source: formulation, sections 3, 5
and 6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.bound.claim import Claim
from loadshare.certify.bound.laws import Act, Elements, elements, first_acts
from loadshare.certify.bound.one import columns_of
from loadshare.certify.bound.statics import Statics
from loadshare.settings import BOUND
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of
from loadshare.train.train import Train

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Tangent:
    """How a train yields to a little more load.

    Attributes
    ----------
    flanks : ndarray, shape (flanks,)
        Stiffness of every flank along its line of action at the force that it carries [N/m]; 0
        where it is open.
    directions, compliance : ndarray, shape (rows, n) and (rows,)
        What acts: its direction over the coordinates, and how it yields [m/N].
    pushing : ndarray, shape (n, splines)
        Force of friction at every coordinate, per torque over a spline [1/m].
    shrinking : ndarray, shape (rows, splines)
        What friction takes of the length of a row, per torque over a spline [1/N].
    twist : ndarray, shape (splines, rows)
        Torque over a spline per force of a row, positive as claimed [m].
    train : Train
    """

    flanks: Array
    directions: Array
    compliance: Array
    pushing: Array
    shrinking: Array
    twist: Array
    train: Train

    def torsion(self, gear: str) -> float:
        """Torque on a gear per rotation of it [N·m/rad].

        0 where nothing resists, infinite where nothing yields.
        """
        turn = columns_of(self.train).turns[gear]
        if turn.coordinate is None:
            return math.inf
        load = np.zeros(self.directions.shape[1])
        load[turn.coordinate] = 1.0
        yields = self._yields(load)
        return math.inf if yields == 0.0 else turn.radius**2 / yields

    def _yields(self, load: Array) -> float:
        """Compliance of a load, in its own direction [m/N]."""
        known = Statics.of(self.directions)
        d, n = self.compliance, known.redundant
        borne = known.particular @ load
        if np.abs(self.directions.T @ borne - load).max() > BOUND.loose:
            return math.inf
        values, vectors = np.linalg.eigh(n.T @ (d[:, None] * n))
        # A self-stress among rigid parts has no compliance, and none of the load's work.
        kept = np.abs(values) > BOUND.singular * np.abs(values).max(initial=0.0)
        basis = n @ vectors[:, kept]
        by_gap = basis / values[kept] @ basis.T
        by_load = known.particular - by_gap @ (d[:, None] * known.particular)
        first = by_load @ load
        pushed = by_load @ self.pushing - by_gap @ self.shrinking
        around = np.eye(len(self.twist)) + self.twist @ pushed
        torque = np.linalg.pinv(around) @ (self.twist @ first)
        force = first - pushed @ torque
        return float(first @ (d * force - self.shrinking @ torque))


def tangent_of(train: Train, answer: Equilibrium) -> Tangent:
    """Return how a train yields at an answer, what carries there taken to go on carrying.

    Parameters
    ----------
    train : Train
    answer : Equilibrium
    """
    columns = columns_of(train)
    claim = Claim(columns, situation_of(train, answer.index), Equilibria.of(train, answer))
    with np.errstate(all="ignore"):
        act = first_acts(claim)
        scale = np.maximum(np.abs(claim.forces).max(axis=1, initial=0.0), np.finfo(float).tiny)
        found = elements(claim, act, scale, np.zeros(act.shape, bool), BOUND.softest)
    directions, compliance, pushing, shrinking = _rows(claim, found)
    scalar = np.flatnonzero(found.active[0, : columns.first_pair])
    flanks = scalar[scalar < columns.flanks.stop]
    twist = np.zeros((len(columns.moments), len(directions)))
    twist[:, : len(flanks)] = columns.moments[:, flanks]
    twist *= np.sign(claim.torque_on_splines[0])[:, None]
    stiffness = np.zeros(columns.flanks.stop)
    stiffness[flanks] = 1.0 / found.soft[0, flanks]
    return Tangent(stiffness, directions, compliance, pushing, shrinking, twist, train)


def _rows(claim: Claim, found: Elements) -> tuple[Array, Array, Array, Array]:
    """Directions and compliances of what acts, and what follows the torques over splines."""
    columns, matrix = claim.columns, claim.columns.matrix.high
    scalar = np.flatnonzero(found.active[0, : columns.first_pair])
    directions, yields = list(matrix[scalar]), found.soft[0, scalar].tolist()
    none = np.zeros(len(columns.moments))
    pushing, shrinking = np.zeros((len(columns.coordinates), len(none))), [none] * len(scalar)
    acts = found.act[0, found.act.shape[1] - columns.pairs :]
    for k, (act, line) in enumerate(zip(acts, found.line[0], strict=True)):
        if act == Act.OPEN:
            continue
        at = columns.first_pair + 2 * k
        pair = matrix[at : at + 2]
        soft = np.diag(found.soft[0, at : at + 2]) + found.skew[0, k] * np.eye(2)[::-1]
        along = np.array([1.0, 0.0]) if act in (Act.STICK, Act.PINNED) else line
        ways = [np.array([-along[1], along[0]])]
        shrinking.append(none)
        if act != Act.SLIP:
            ways.append(along)
            shrinking.append(found.shrinks[0, k] * columns.splined[k])
        directions += [way @ pair for way in ways]
        yields += [float(way @ soft @ way) for way in ways]
        pushing += np.outer(line @ pair, found.follows[0, k] * columns.splined[k])
    shape = (len(directions), len(columns.coordinates))
    return (
        np.array(directions).reshape(shape),
        np.array(yields),
        pushing,
        np.array(shrinking).reshape(len(directions), len(none)),
    )
