"""One position of a train, ready to be differentiated with respect to any input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from loadshare.array_types import Array
from loadshare.errors import CaseError, Refused
from loadshare.job.answer import Answer
from loadshare.results.share import carries
from loadshare.settings import SENSITIVITY
from loadshare.study.sensitivity.branch import Setting
from loadshare.study.sensitivity.differenced import NoDifference, differenced
from loadshare.study.sensitivity.differences import SideSlope
from loadshare.study.sensitivity.directional import Neighbourhood
from loadshare.study.sensitivity.motion import Motion
from loadshare.study.sensitivity.result import Input, Rates, Remark
from loadshare.study.sensitivity.variation import Trains, Variation, torques_of
from loadshare.train import Train
from loadshare.train.placed import train_at


class PositionSensitivity:
    """One certified position, ready to be differentiated.

    Parameters
    ----------
    train : Train
    answer : Answer
        Of one of its positions, certified.

    Attributes
    ----------
    position : int
        1-based.
    neighbourhood : Neighbourhood
    torques : MeshTorques
        Of this answer alone.
    remarks : list of Remark
        Remarks on the derivatives taken so far.
    """

    def __init__(self, train: Train, answer: Answer) -> None:
        self.position = answer.index
        self.train = train = train_at(train, self.position)
        self._answer = answer.equilibrium
        setting = Setting.at(train, self.position)
        self.structure = setting.structure
        self.neighbourhood = Neighbourhood(setting, self._answer)
        self.torques = torques_of(train, self._answer)
        self.remarks: list[Remark] = []
        self._caught: dict[str, None] = {}

    @property
    def on_the_verge(self) -> tuple[str, ...]:
        """Elements because of which derivatives found so far hold on one side only."""
        return tuple(dict.fromkeys((*self.neighbourhood.verge, *self._caught)))

    def rates(self, trains: Trains, item: Input) -> dict[tuple[int, str, str], Rates]:
        """Return the derivatives on both sides, by position, input and side.

        Raises
        ------
        CaseError
            If the input can be varied to neither side.
        """
        varied, key = Variation(trains, item.value, self.position, self.structure), item.key
        falling, shared = self._side(varied, -1.0, key, "falling")
        rising = falling if shared else self._side(varied, 1.0, key, "rising")[0]
        return {(self.position, key, "falling"): falling, (self.position, key, "rising"): rising}

    def _side(self, varied: Variation, sign: float, key: str, side: str) -> tuple[Rates, bool]:
        """Return the derivatives on one side, and whether they hold on the other as well."""
        place = self.neighbourhood.own
        step, kinked = None, True
        if place is not None:
            change = varied.change(place.branch, place.z)
            step, kinked = change.step, change.kinked
            slope = change.to(sign)
            if isinstance(slope, CaseError):
                self._remark(key, side, f"cannot be {_word(side)}: {slope.problems[0].message}")
                return self._nothing(), False
            if isinstance(slope, SideSlope) and self.neighbourhood.gives_way(slope, step):
                try:
                    varied.answer(sign * SENSITIVITY.shorter[-1] * step)
                except (CaseError, ValueError, Refused) as why:
                    return self._without(key, side, why), False
            passing = varied.steps(sign, step)
            if passing:
                self._remark(
                    key,
                    side,
                    f"meshes {', '.join(passing)} pass to the next position of their cycle exactly "
                    "there, in a step; the derivative holds for their present positions",
                )
        motion = self.neighbourhood.motion(sign, varied)
        if motion is not None:
            self._caught |= dict.fromkeys(motion.elements)
            shared = not motion.one_sided and not kinked
            return self._moved(motion), shared
        try:
            found = self._differenced(varied, sign, step)
        except NoDifference as why:
            return self._without(key, side, why), False
        self._remark(
            key, side, f"found by differences when it is {_word(side)}: no active set was proved"
        )
        return found, False

    def _without(self, key: str, side: str, why: Exception) -> Rates:
        """Add a remark on why a side has no derivative, and return NaN for it."""
        reason = str(why).removeprefix(f"position {self.position}: ")
        self._remark(key, side, f"has no derivative when it is {_word(side)}: {reason}")
        return self._nothing()

    def _differenced(self, varied: Variation, sign: float, step: float | None) -> Rates:
        """Return derivatives from differences of certified solves."""
        count = len(self.train.meshes)
        rates, errors = differenced(self._answer, varied, sign, step)
        moved: dict[str, Array] = {}
        error: dict[str, Array] = {}
        for k, (gear, loose) in enumerate(self._loose().items()):
            here = slice(count + 2 * k, count + 2 * k + 2)
            moved[gear] = np.where(loose, np.nan, rates[here])
            error[gear] = np.where(loose, np.nan, errors[here])
        torque = rates[:count]
        return self._rates(torque, lambda weights: np.abs(weights) @ errors[:count], moved, error)

    def _moved(self, motion: Motion) -> Rates:
        """Return the derivatives from a motion."""
        branch, size = motion.branch, motion.branch.size
        gradients = branch.torque_gradients(motion.z)
        direct_error = motion.change.error[size:]
        torque, length = motion.torque, self.structure.length
        off = [other.torque - torque for other in motion.beside]

        def bound(weights: Array) -> Array:
            found = motion.bound(weights @ gradients) + np.abs(weights) @ direct_error
            return np.asarray(found + _largest([weights @ change for change in off]))

        loose = self._loose(motion)
        moved = {g: np.zeros(2) for g in self.train.gears}
        error = {g: np.zeros(2) for g in self.train.gears}
        for gear, where in self.structure.coordinates.displacement.items():
            pick = np.eye(size)[where]
            moved[gear] = np.where(loose[gear], np.nan, pick @ motion.rate * length)
            apart = _largest([other.rate[where] - motion.rate[where] for other in motion.beside])
            error[gear] = np.where(loose[gear], np.nan, (motion.bound(pick) + apart) * length)
            body = self.train.gears[gear]
            if body.is_tilted:
                moved[gear] = body.in_plane(moved[gear])
                error[gear] = error[gear] @ np.abs(body.frame @ body.plane.T)
        return self._rates(torque, bound, moved, error)

    def _rates(
        self,
        torque: Array,
        bound: Callable[[Array], Array],
        moved: dict[str, Array],
        moved_error: dict[str, Array],
    ) -> Rates:
        """Return derivatives with their errors.

        Parameters
        ----------
        torque : ndarray, shape (meshes,)
            Derivatives of the torques [N·m] per SI unit.
        bound : callable
            Bound on the errors of linear combinations (k, meshes) of these.
        moved, moved_error : mapping of gear to ndarray, shape (2,)
            Derivatives of displacements [m] per SI unit, and their errors; NaN where undetermined.
        """
        stages = self.train.stages
        groupings = [[s.meshes for s in stages], [g for s in stages for g in s.groups]]
        weights = [np.eye(len(torque)), *map(self._weights, groupings)]
        of_torque, share, pair = (self._by_mesh(w @ torque) for w in weights)
        torque_error, share_error, pair_error = (self._by_mesh(bound(w)) for w in weights)
        error = Rates(torque_error, share_error, pair_error, moved_error)
        return Rates(of_torque, share, pair, moved, error)

    def _by_mesh(self, values: Array) -> dict[str, float]:
        return dict(zip(self.train.meshes, values.tolist(), strict=True))

    def _weights(self, groups: list[tuple[str, ...]]) -> Array:
        """Return the derivatives (meshes, meshes) of Ω = T / mean(T) of every branch by torques.

        Rows are NaN where the group of a mesh carries no load.
        """
        order = list(self.train.meshes)
        found = np.full((len(order), len(order)), np.nan)
        for group in groups:
            rows = [order.index(m) for m in group]
            torque = self.torques.net[0, rows]
            mean = torque.mean()
            if carries(mean, self.torques.largest[0]):
                weights = np.eye(len(order))[rows]
                weights[:, rows] -= torque[:, None] / mean / len(group)
                found[rows] = weights / mean
        return found

    def _loose(self, motion: Motion | None = None) -> dict[str, Array]:
        """Return which components of each gear's displacement are undetermined, here or on a side.

        A gear that is held here may begin to float as it moves to a side.
        """
        free = set(self._answer.undetermined)
        loose = {g: np.array([f"gear {g} {c}" in free for c in "xy"]) for g in self.train.gears}
        own = self.neighbourhood.own
        tangents = [] if own is None else [own.tangent]
        if motion is not None:
            tangents += [m.tangent for m in (motion, *motion.beside)]
        for tangent in tangents:
            moves = np.abs(tangent.loose).max(axis=1, initial=0.0) > SENSITIVITY.loose
            for gear, where in self.structure.coordinates.displacement.items():
                loose[gear] = loose[gear] | moves[where]
        return loose

    def _nothing(self) -> Rates:
        """Return NaN for everything that might move."""
        nothing = dict.fromkeys(self.train.meshes, np.nan)
        moved = {
            name: np.full(2, np.nan if gear.moves else 0.0)
            for name, gear in self.train.gears.items()
        }
        none = Rates(nothing, nothing, nothing, moved)
        return replace(none, error=none)

    def _remark(self, key: str, side: str, message: str) -> None:
        self.remarks.append(Remark(key, self.position, side, message))


def _largest(changes: list[Array]) -> Array | float:
    """Return the largest size over several changes, entry by entry; 0 if there are none."""
    return np.abs(changes).max(axis=0) if changes else 0.0


def _word(side: str) -> str:
    return "raised" if side == "rising" else "lowered"
