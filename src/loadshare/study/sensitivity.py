r"""Sensitivities: how torques, shares and floats change with any input of a case.

The equilibrium equations of the active set are differentiated implicitly: with r(z, u) = 0,

.. math:: \frac{dz}{du} = -\left(\frac{\partial r}{\partial z}\right)^{-1}
    \frac{\partial r}{\partial u}

The Jacobian is factorised once for all inputs; no equilibrium is solved again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from loadshare.case import Case
from loadshare.case.keys import Path, dotted, look_up, parse
from loadshare.errors import CaseError, Problem
from loadshare.job import Progress
from loadshare.job.positions import wanted_positions
from loadshare.results.share import coefficients
from loadshare.scene import assemble
from loadshare.scene.scene import Array, Scene
from loadshare.study.answers import certified
from loadshare.study.branch import Branch
from loadshare.study.branch.system import identified
from loadshare.study.differences import Derivative, differentiate
from loadshare.study.directional import ROUND_OFF, Motion, Neighbourhood
from loadshare.study.parameter import STUDY, Value, leaves, matches, read_value
from loadshare.study.positions import loaded
from loadshare.train import Train, build_train

if TYPE_CHECKING:
    import xarray as xr

SIDES = ("falling", "rising")
TIE = 1e-9
"""Shares that differ by no more are both the largest."""


@dataclass(frozen=True, slots=True)
class Input:
    """An input that is varied.

    Attributes
    ----------
    key : str
        Dotted key path.
    value : Value
        As the case says it.
    """

    key: str
    value: Value


@dataclass(frozen=True, slots=True)
class Kink:
    """An equilibrium on the verge of another active set: its derivatives hold to one side each.

    Attributes
    ----------
    position : int
    elements : tuple of str
        What has neither gap nor force, or stands at a corner of its law; and contacts that catch a
        body which floats free, as soon as an input loads it.
    """

    position: int
    elements: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Derivatives of one position with respect to one input, to one side, per SI unit.

    Attributes
    ----------
    torque, share, pair_share : mapping of mesh to float
        [N·m], [-]; NaN where nothing can follow to that side, or a group carries nothing.
    displacement : mapping of gear to ndarray, shape (2,)
        [m], in the gear's transverse frame; NaN where the equilibrium leaves it undetermined.
    """

    torque: dict[str, float]
    share: dict[str, float]
    pair_share: dict[str, float]
    displacement: dict[str, Array]


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives of the certified equilibria of a case.

    Attributes
    ----------
    inputs : tuple of Input
    positions : tuple of int
    rates : mapping of (position, key, side) to Rates
        Side is "falling" or "rising"; both agree where there is no kink.
    omega, pair_omega : mapping of (key, side) to mapping of stage to float
        Derivative of the largest Ω of each stage and of the system.
    kinks : tuple of Kink
    error : mapping of key to float
        Estimated relative error of the derivative of the equations.
    skipped : tuple of (str, str)
        Inputs that cannot be varied on their own, and why.
    """

    inputs: tuple[Input, ...]
    positions: tuple[int, ...]
    rates: dict[tuple[int, str, str], Rates]
    omega: dict[tuple[str, str], dict[str, float]]
    pair_omega: dict[tuple[str, str], dict[str, float]]
    kinks: tuple[Kink, ...]
    error: dict[str, float]
    skipped: tuple[tuple[str, str], ...]

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The derivatives as labelled arrays, per SI unit of the input."""
        from loadshare.study.tables import sensitivity_dataset

        return sensitivity_dataset(self)


def sensitivity(
    case: Case | str | FilePath,
    inputs: str | Sequence[str] | None = None,
    *,
    positions: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> Sensitivity:
    """Differentiate torques, shares and floats with respect to inputs of a case.

    Parameters
    ----------
    case : Case or path
    inputs : str or sequence of str, optional
        Dotted key paths, or patterns in which a star stands for any name; a table or list means all
        numbers in it. All numbers of the case by default.
    positions : iterable of int, optional
        1-based positions; all by default.
    progress : Progress, optional
        Called after every input.

    Returns
    -------
    Sensitivity
        One-sided derivatives, which agree where the equilibrium stands on no verge. Where it does,
        `Sensitivity.kinks` says so.

    Raises
    ------
    CaseError
        If an input is not there or is no number, or cannot be varied on its own.
    Refused
        If a position has no certified equilibrium.

    Examples
    --------
    >>> import loadshare as ls
    >>> found = ls.sensitivity("cases/fgfbstts/limit_ring.toml", "rings.4.float", positions=[1])
    >>> rate = found.rates[1, "rings.4.float", "rising"].pair_share["7-10"]
    >>> f"{rate * 1e-6:.5f} per um"
    '-0.00564 per um'
    """
    case = loaded(case)
    train = build_train(case)
    chosen = wanted_positions(train, positions)
    named = inputs is not None
    found = _inputs(case, inputs)
    corners = [_Corner(train, position) for position in chosen]
    rates: dict[tuple[int, str, str], Rates] = {}
    error: dict[str, float] = {}
    skipped: list[tuple[str, str]] = []
    usable = []
    for done, item in enumerate(found, start=1):
        if progress is not None:
            progress(done, len(found))
        trains = lru_cache(maxsize=None)(
            lambda number, item=item: build_train(
                case.replace({item.key: item.value.at(number).text})
            )
        )
        try:
            for corner in corners:
                sides, worst = corner.rates(trains, item.value)
                error[item.key] = max(worst, error.get(item.key, 0.0))
                rates |= {(corner.position, item.key, s): r for s, r in sides.items()}
        except CaseError as refusal:
            if named:
                raise
            skipped.append((item.key, refusal.problems[0].message))
            continue
        usable.append(item)
    stages = {
        kind: {
            (item.key, side): _largest(train, corners, rates, item.key, side, kind)
            for item in usable
            for side in SIDES
        }
        for kind in ("share", "pair_share")
    }
    return Sensitivity(
        inputs=tuple(usable),
        positions=tuple(chosen),
        rates=rates,
        omega=stages["share"],
        pair_omega=stages["pair_share"],
        kinks=tuple(Kink(c.position, elements) for c in corners if (elements := c.on_the_verge)),
        error={item.key: error[item.key] for item in usable},
        skipped=tuple(skipped),
    )


def _inputs(case: Case, wanted: str | Sequence[str] | None) -> list[Input]:
    """Return the inputs meant; all numbers that are no counts by default."""
    data = case.to_dict()
    if wanted is None:
        return _below(data, ())
    inputs: list[Input] = []
    problems = []
    for pattern in [wanted] if isinstance(wanted, str) else wanted:
        meant = [item for key in matches(case, pattern) for item in _meant(data, key)]
        if not meant:
            given = look_up(data, parse(pattern))
            what = "is not in the case" if given is None else "is no number with a unit"
            shown = "" if given is None else str(given)
            problems.append(Problem(STUDY, pattern, shown, what, "an input that the case gives"))
        inputs += meant
    if problems:
        raise CaseError(problems)
    return list(dict.fromkeys(inputs))


def _meant(data: object, key: str) -> list[Input]:
    """Return the number at a key, or all numbers below it."""
    path = parse(key)
    given = look_up(data, path)
    if isinstance(given, dict | list):
        return _below(given, path)
    value = _number(given)
    return [] if value is None else [Input(key, value)]


def _below(data: object, above: Path) -> list[Input]:
    """Return all numbers of a table or list that are no counts."""
    found = []
    for path in leaves(data):
        value = _number(look_up(data, path))
        if value is not None:
            found.append(Input(dotted((*above, *path)), value))
    return found


def _number(given: object) -> Value | None:
    """Return a physical value or a plain number; counts and names are none."""
    if isinstance(given, int):
        return None
    value = read_value(given)
    return None if value is None or (isinstance(given, str) and not value.unit) else value


class _Corner:
    """One certified position, ready to be differentiated."""

    def __init__(self, train: Train, position: int) -> None:
        self.train, self.position = train, position
        answer = certified(train, position)
        branch, z = identified(assemble(train, position), answer.equilibrium)
        self.neighbourhood = Neighbourhood(branch, z)
        self.torque = _torques(branch, z)
        loose = branch.undetermined(z)
        self.loose = np.abs(loose).max(axis=1, initial=0.0) > 1e-9
        self._caught: dict[str, None] = {}

    @property
    def on_the_verge(self) -> tuple[str, ...]:
        """Elements for which the derivatives found so far hold to one side only."""
        return tuple(dict.fromkeys((*self.neighbourhood.verge, *self._caught)))

    def rates(
        self, trains: Callable[[float], Train], value: Value
    ) -> tuple[dict[str, Rates], float]:
        """Return the derivatives to both sides, and the relative error of those of the equations.

        Raises
        ------
        CaseError
            If the input can be varied to neither side.
        """
        scenes = lru_cache(maxsize=None)(lambda number: assemble(trains(number), self.position))
        derivatives: dict[object, Derivative] = {}

        def explicit(branch: Branch, z: Array) -> Derivative:
            if branch.active not in derivatives:

                def of(number: float) -> Array:
                    there = Branch(scenes(number), branch.active, branch.units)
                    return np.concatenate([there.residual(z), list(_torques(there, z).values())])

                derivatives[branch.active] = differentiate(of, value)
            return derivatives[branch.active]

        def shifted(amount: float) -> Scene:
            return scenes(value.number + amount / value.factor)

        found = {}
        here = self.neighbourhood
        both: Motion | None = None
        for side, sign in zip(SIDES, (-1.0, 1.0), strict=True):
            motion = both
            if motion is None:
                try:
                    motion = here.motion(sign, explicit, shifted)
                except CaseError:
                    if not derivatives:
                        raise
            able = next(iter(derivatives.values())).sides[sign > 0] if derivatives else False
            found[side] = self._told(motion if able else None, derivatives)
            caught = motion.caught if motion is not None else ()
            self._caught |= dict.fromkeys(caught)
            both = motion if not here.verge and not caught else None
        worst = 0.0
        for derivative in derivatives.values():
            size = float(np.abs(derivative.value).max(initial=0.0))
            if size * derivative.step > ROUND_OFF:
                worst = max(worst, float(derivative.error.max(initial=0.0)) / size)
        return found, worst

    def _told(self, motion: Motion | None, derivatives: dict[object, Derivative]) -> Rates:
        meshes, scene = self.train.meshes, self.neighbourhood.branch.scene
        moved = {
            g: np.full(2, np.nan) if g in scene.displacement else np.zeros(2)
            for g in self.train.gears
        }
        if motion is None:
            nothing = dict.fromkeys(meshes, np.nan)
            return Rates(nothing, dict(nothing), dict(nothing), moved)
        branch = motion.branch
        direct = derivatives[branch.active].value[branch.size :]
        contacts = branch.contacts(motion.z)
        torque = {}
        for (name, mesh), explicit in zip(meshes.items(), direct, strict=True):
            total = float(explicit)
            for drive in mesh.flanks:
                _, gradient = contacts[mesh.flank_name(drive)]
                total += (1.0 if drive else -1.0) * mesh.radii[0] * float(gradient @ motion.rate)
            torque[name] = total
        for gear, where in scene.displacement.items():
            rate = motion.rate[where] * branch.units.length
            moved[gear] = np.where(self.loose[where], np.nan, rate)
        stages = self.train.stages
        return Rates(
            torque,
            _share_rates(self.torque, torque, [s.meshes for s in stages], meshes),
            _share_rates(self.torque, torque, [g for s in stages for g in s.groups], meshes),
            moved,
        )


def _torques(branch: Branch, z: Array) -> dict[str, float]:
    """Torque on the driver of every mesh, drive flank less coast flank [N·m]."""
    contacts = branch.contacts(z)
    return {
        name: mesh.radii[0]
        * sum((1.0 if d else -1.0) * contacts[mesh.flank_name(d)][0] for d in mesh.flanks)
        for name, mesh in branch.scene.train.meshes.items()
    }


def _share_rates(
    torque: dict[str, float],
    rate: dict[str, float],
    groups: Iterable[tuple[str, ...]],
    meshes: Iterable[str],
) -> dict[str, float]:
    """Derivative of Ω = T / mean(T) of every branch."""
    found = dict.fromkeys(meshes, np.nan)
    for group in groups:
        mean = sum(torque[m] for m in group) / len(group)
        slope = sum(rate[m] for m in group) / len(group)
        if mean:
            found |= {m: (rate[m] - torque[m] / mean * slope) / mean for m in group}
    return found


def _largest(
    train: Train,
    corners: list[_Corner],
    rates: dict[tuple[int, str, str], Rates],
    key: str,
    side: str,
    kind: str,
) -> dict[str, float]:
    """Derivative of the largest Ω of each stage, and of the system, to one side."""
    found: dict[str, tuple[float, float]] = {}
    for stage in train.stages:
        groups = [stage.meshes] if kind == "share" else stage.groups
        near: list[tuple[float, float]] = []
        for corner in corners:
            shares = coefficients(corner.torque, groups)
            slopes = getattr(rates[corner.position, key, side], kind)
            near += [(s, slopes[m]) for m, s in shares.items() if s is not None]
        found[stage.name] = _steepest(near, side)
    found["system"] = _steepest(list(found.values()), side)
    return {name: slope for name, (_, slope) in found.items()}


def _steepest(near: list[tuple[float, float]], side: str) -> tuple[float, float]:
    """Return the largest share and its derivative; among equals the one that is largest beyond."""
    if not near:
        return np.nan, np.nan
    top = max(share for share, _ in near)
    slopes = [slope for share, slope in near if share >= top - TIE]
    return top, max(slopes) if side == "rising" else min(slopes)
