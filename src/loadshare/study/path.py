"""A case along one parameter: its scenes, its branches, its certified active sets."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from loadshare.case import Case
from loadshare.certify import certify
from loadshare.errors import Refused
from loadshare.scene import assemble
from loadshare.scene.scene import Array, Scene
from loadshare.study.answers import certified
from loadshare.study.branch import ActiveSet, Branch, Units
from loadshare.study.branch.system import BranchLost, Gauge, identified
from loadshare.study.parameter import Parameter
from loadshare.train import Train, build_train


class Trains:
    """The trains of a case along a parameter, built once for each value."""

    def __init__(self, case: Case, parameter: Parameter) -> None:
        self.parameter = parameter
        self.at: Callable[[float], Train] = lru_cache(maxsize=4096)(
            lambda value: build_train(parameter.applied(case, value))
        )


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """A value with the active set and the unknowns that are certified there.

    Attributes
    ----------
    value : float
    active : ActiveSet
    z : ndarray
    worst : float
        Worst scaled residual of the certificate.
    """

    value: float
    active: ActiveSet
    z: Array
    worst: float


class Path:
    """One position of a case along a parameter.

    Parameters
    ----------
    trains : Trains
    position : int
        1-based.
    start : float
        Value at which the path is measured: its units hold everywhere on it.
    """

    def __init__(self, trains: Trains, position: int, start: float) -> None:
        self._trains, self.position = trains, position
        self.parameter = trains.parameter
        self.scene: Callable[[float], Scene] = lru_cache(maxsize=4096)(
            lambda value: assemble(trains.at(value), position)
        )
        self.units = Units.of(self.scene(start))
        self._settled: dict[float, End] = {}

    def settled(self, value: float, guesses: Iterable[tuple[ActiveSet, Array]] = ()) -> End:
        """Return the certified active set at a value.

        Parameters
        ----------
        value : float
        guesses : iterable of (ActiveSet, ndarray)
            Active sets, and unknowns near by, whose own answers are judged by the certificate if
            the solver finds none, as it may right beside an event.

        Raises
        ------
        Refused
            If there is no certified equilibrium.
        BranchLost
            If the active set cannot be read from it.
        """
        if value not in self._settled:
            train = self._trains.at(value)
            try:
                answer = certified(train, self.position)
            except Refused:
                found = self._guessed(train, value, guesses)
                if found is None:
                    raise
            else:
                branch, z = identified(self.scene(value), answer.equilibrium, self.units)
                found = End(value, branch.active, z, answer.certificate.worst)
            self._settled[value] = found
        return self._settled[value]

    def _guessed(
        self, train: Train, value: float, guesses: Iterable[tuple[ActiveSet, Array]]
    ) -> End | None:
        for active, near in guesses:
            with suppress(BranchLost):
                branch = Branch(self.scene(value), active, self.units)
                z = branch.solve(
                    near[: branch.size]
                    if len(near) >= branch.size
                    else np.pad(near, (0, branch.size - len(near)))
                )
                certificate = certify(train, branch.equilibrium(z))
                if certificate.passed:
                    return End(value, active, z, certificate.worst)
        return None

    def followed(self, active: ActiveSet, value: float, near: Array) -> tuple[Branch, Array]:
        """Return the branch of an active set at a value, solved from unknowns near by.

        Raises
        ------
        BranchLost
            If it has no point there.
        """
        branch = Branch(self.scene(value), active, self.units)
        return branch, branch.solve(near)

    def gauges(
        self, active: ActiveSet, value: float, near: Array
    ) -> tuple[dict[tuple[str, str], Gauge], Array]:
        """Return the gauges of a branch at a value, by element and where it would go."""
        branch, z = self.followed(active, value, near)
        return {(g.element, g.to.label if g.to else ""): g for g in branch.gauges(z)}, z


__all__ = ["BranchLost", "End", "Path", "Trains"]
