"""Figures of claims that are certified one by one."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from loadshare.array_types import Array
from loadshare.certify import Claims
from loadshare.certify.bound import Columns
from loadshare.certify.floats import FloatPlaces
from loadshare.certify.state import ClaimedState
from loadshare.certify.validity import Measuring
from loadshare.results.figures import Figures


class Judged(Figures):
    """Figures of claims that reuse what their certificates have computed.

    Parameters
    ----------
    claims : Claims
    """

    def __init__(self, claims: Claims) -> None:
        none = np.full(len(claims.positions), np.inf)
        situations, answers = claims.situations, claims.answers
        super().__init__(claims.train, situations, answers, claims.undetermined, none)
        self._claims = claims

    @property
    def state(self) -> ClaimedState:
        """The mechanics evaluated at the claims."""
        return self._claims.state

    @property
    def columns(self) -> Columns:
        """The mechanics as columns of a matrix."""
        return self._claims.judge.columns

    @property
    def measuring(self) -> Measuring:
        """The measures of displacements."""
        return self._claims.judge.measuring

    @property
    def _rests(self) -> FloatPlaces:
        return self._claims.rests

    @cached_property
    def torque_bound(self) -> Array:
        """Bounds on torques from the certificates; NaN where there is none."""
        every = [bound.torque for bound in self._claims.bounds]
        return np.array([[b.get(mesh, np.nan) for mesh in self.train.meshes] for b in every])
