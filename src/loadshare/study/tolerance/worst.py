"""The worst case within the tolerances, and the inputs that give it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from loadshare.array_types import Array
from loadshare.errors import CaseError, Problem, Refused, ResultError
from loadshare.job import solve
from loadshare.settings import JOB, TOLERANCE
from loadshare.study.tolerance.figures import KIND_OVER, KINDS, SYSTEM
from loadshare.study.tolerance.job import Job


@dataclass(frozen=True)
class WorstCase:
    """The largest Ω that was found within the tolerances. There may be a larger one.

    Attributes
    ----------
    over : str
        "stage" or "group": whose mean Ω is over.
    omega : float
        Ω of the system, the largest over positions and branches, of a certified equilibrium that
        was solved on its own.
    inputs : mapping of str to float
        Value of each input, in its unit.
    changes : mapping of str to str or float
        The same, as `Case.replace` takes it.
    at : mapping of str to str
        "low", "high" or "between", by input.
    solved : int
        Number of samples that were solved to find it.
    """

    over: str
    omega: float
    inputs: dict[str, float]
    changes: dict[str, Any]
    at: dict[str, str]
    solved: int


def worst_case(job: Job, kind: str, known: Sequence[Array]) -> WorstCase | None:
    """Search for the worst case from many starting points at once.

    From each point, every input is tried a step up and down. The point moves to the best of these
    trials or of several that gain, taken together; if nothing gains, its step is reduced. The
    trials of all points are solved as one batch.

    Parameters
    ----------
    job : Job
    kind : {"omega", "pair_omega"}
    known : sequence of ndarray, shape (inputs,)
        Samples to start from, such as the worst ones of the study.

    Returns
    -------
    WorstCase or None
        None if no starting point has an answer, or no point found is certified on its own.
    """
    search = _Search(job, kind)
    points = search.starts(known)
    best = search.omega(points)
    step = np.full(len(points), TOLERANCE.step)
    for _ in range(TOLERANCE.rounds):
        active = np.flatnonzero((step >= TOLERANCE.last_step) & np.isfinite(best))
        if not len(active):
            break
        moved, omega = search.round(points[active], best[active], step[active])
        gains = omega > best[active] + TOLERANCE.gain
        points[active[gains]], best[active[gains]] = moved[gains], omega[gains]
        step[active[~gains]] *= TOLERANCE.narrower
    for k in np.argsort(-best, kind="stable").tolist():
        if np.isfinite(best[k]):
            found = _confirmed(search, points[k])
            if found is not None:
                return found
    return None


class _Search:
    """A search in the tolerance box: each input between its ends, scaled to [0, 1].

    A distribution without an end is cut at three standard deviations of a normal one (0.135 % lie
    beyond). Correlations do not narrow the box.
    """

    def __init__(self, job: Job, kind: str) -> None:
        self.job, self.kind, self.solved = job, kind, 0
        distributions = [one.distribution for one in job.inputs.every]
        self.low, high = np.array([one.ends() for one in distributions]).T
        self.width = high - self.low
        self.periodic = np.array([one.periodic for one in distributions])

    def starts(self, known: Sequence[Array]) -> Array:
        """Return points of the box to start from: known inputs, corners, and points inside."""
        # An input that scatters by less than the precision of numbers has no range.
        width = np.where(self.width > 0.0, self.width, 1.0)
        scaled = [np.clip((values - self.low) / width, 0.0, 1.0) for values in known]
        source = np.random.SeedSequence(self.job.settings["seed"], spawn_key=(0, 3))
        rng, shape = np.random.default_rng(source), (TOLERANCE.corners, len(self.low))
        inner = rng.random((TOLERANCE.inner, len(self.low)))
        corners = np.where(self.periodic, rng.random(shape), rng.integers(0, 2, shape))
        return np.array([*scaled, *corners, *inner], dtype=float)

    def values(self, scaled: Array) -> Array:
        """Return inputs in their units."""
        return np.asarray(self.low + scaled * self.width)

    def within(self, scaled: Array) -> Array:
        """Bring points back into the box: angles wrap around, others are clipped."""
        return np.where(self.periodic, scaled % 1.0, np.clip(scaled, 0.0, 1.0))

    def omega(self, scaled: Array) -> Array:
        """Return Ω at points of the box; minus infinity where there is no certified answer."""
        found = np.full(len(scaled), -np.inf)
        for at in range(0, len(scaled), JOB.block):
            part = slice(at, at + JOB.block)
            values = self.job.solve(self.values(scaled[part])).columns[f"{self.kind}.{SYSTEM}"]
            found[part] = np.where(np.isnan(values), -np.inf, values)
        self.solved += len(scaled)
        return found

    def round(self, points: Array, best: Array, step: Array) -> tuple[Array, Array]:
        """Return, for each point, the best point tried around it, and its Ω."""
        count, width = points.shape
        ways = np.concatenate([np.eye(width), -np.eye(width)])
        around = points[:, None, :] + step[:, None, None] * ways
        trials = self.within(around.reshape(-1, width)).reshape(around.shape)
        omega = self.omega(trials.reshape(-1, width)).reshape(count, 2 * width)
        gain = np.where(np.isfinite(omega), omega - best[:, None], -np.inf)
        # Steps that gain alone often gain together: all of them, and the better half, are tried.
        up, down = gain[:, :width], gain[:, width:]
        sign = np.where(up >= down, 1.0, -1.0)
        each = np.maximum(up, down)
        gains = np.ma.masked_less_equal(each, TOLERANCE.gain)
        middle = np.ma.median(gains, axis=1).filled(np.inf)  # type: ignore[no-untyped-call]
        together = np.stack(
            [
                self.within(points + step[:, None] * sign * (each > least[:, None]))
                for least in (np.full(count, TOLERANCE.gain), middle)
            ],
            axis=1,
        )
        more = self.omega(together.reshape(-1, width)).reshape(count, -1)
        every = np.concatenate([omega, more], axis=1)
        chosen = every.argmax(axis=1)
        scaled = np.concatenate([trials, together], axis=1)
        rows = np.arange(count)
        return scaled[rows, chosen], every[rows, chosen]


def _confirmed(search: _Search, place: Array) -> WorstCase | None:
    """Solve a point of the box on its own, with a full certificate."""
    inputs, values = search.job.inputs, search.values(place).tolist()
    changes = inputs.changes(values)
    omega = _omega_with(search.job, changes, search.kind)
    if omega is None:
        return None
    names = [one.name for one in inputs.every]
    return WorstCase(
        over=KINDS[search.kind],
        omega=omega,
        inputs=dict(zip(names, values, strict=True)),
        changes=changes,
        at={
            name: "between" if p else ("low" if u <= 0.0 else "high" if u >= 1.0 else "between")
            for name, u, p in zip(names, place.tolist(), search.periodic, strict=True)
        },
        solved=search.solved,
    )


def _omega_with(job: Job, changes: dict[str, Any], kind: str) -> float | None:
    """Return Ω of the system with inputs changed; None if it is not certified or has no Ω."""
    try:
        how = {key: job.settings[key] for key in ("positions", "tolerance")}
        result = solve(job.case.replace(changes), **how)
    except (Refused, CaseError):
        return None
    found: dict[str, float | None] = getattr(result, kind)
    return found[SYSTEM]


def check_worst(job: Job, known: WorstCase, file: str) -> None:
    """Check a worst case that an earlier run found, by solving it again.

    Raises
    ------
    ResultError
        If its inputs do not give its Ω.
    """
    try:
        changes = job.inputs.changes(list(known.inputs.values()))
        found = _omega_with(job, changes, KIND_OVER.get(known.over, "pair_omega"))
    except (TypeError, ValueError):
        changes, found = {}, None
    if (
        found is None
        or changes != known.changes
        or not abs(known.omega - found) <= TOLERANCE.gain * found
    ):
        expected = "no certified answer" if found is None else repr(found)
        raise ResultError(
            [
                Problem(
                    file,
                    f"worst.{known.over}.omega",
                    repr(known.omega),
                    "is not what the inputs given there yield",
                    expected,
                    "Delete this file and repeat the command: it is then searched for again.",
                )
            ]
        )
