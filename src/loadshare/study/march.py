"""A march with memory: revolutions of the gears, with spline friction that remembers its slip.

At every step the programme of formulation section 5 is solved with the change of the slip, s − s₀,
in place of the slip. This is the implicit step of a friction law that dissipates F_m times the
size of that change. The certificate of every step includes this memory.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path as FilePath
from typing import Literal

import numpy as np

from loadshare.case import Case
from loadshare.case.reader import opened
from loadshare.equality import Comparable
from loadshare.errors import CaseError, Refused
from loadshare.job.answer import Answer
from loadshare.job.positions import result_of
from loadshare.libraries import pd, xr
from loadshare.numbers import counted
from loadshare.one_thread import one_thread
from loadshare.pictures import Figure, picture
from loadshare.progress import Progress
from loadshare.results import Result
from loadshare.results.dataset import unchanging
from loadshare.settings import CERTIFY, MARCH
from loadshare.study.memory.step import StepHistory, stepped
from loadshare.study.positions import BACKEND
from loadshare.study.tables import march_dataset
from loadshare.table import text_table
from loadshare.train import Train, build_train
from loadshare.train.build import with_laws
from loadshare.train.elements import Spline
from loadshare.train.gear import Vector
from loadshare.train.memory import slip_of
from loadshare.train.placed import train_at
from loadshare.view import View, Viewed, by_name


@dataclass(frozen=True, slots=True, eq=False)
class Slip(Comparable):
    """The slip of a spline in one step.

    Attributes
    ----------
    slip : ndarray, shape (2,)
        s at the end of the step [m], in the gear's transverse frame.
    stage : str
        "stick" where s did not change, "slip" where it did, "stop" at the end of the clearance.
    friction : float
        Friction bound F_m [N].
    dissipated : float
        Energy dissipated by friction in the step [J].
    """

    slip: Vector
    stage: str
    friction: float
    dissipated: float


@dataclass(frozen=True, eq=False, repr=False)
class March(Viewed):
    """Certified equilibria along a march, each starting from the slip of the one before.

    Attributes
    ----------
    result : Result
        Torques, shares, floats and certificates of every step.
    revolutions : tuple of float
        Of the reference gear at every step.
    gear : str
        Reference gear.
    slips : tuple of mapping of gear to Slip
        One per step.
    refused : str
        Why the step after the last one was refused; empty if the march is complete.
    """

    result: Result
    revolutions: tuple[float, ...]
    gear: str
    slips: tuple[dict[str, Slip], ...]
    refused: str = ""

    @property
    def dissipated(self) -> float:
        """Energy dissipated by all splines [J]."""
        return float(sum(s.dissipated for step in self.slips for s in step.values()))

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The result's labelled arrays, with slips, dissipation and revolutions by position."""
        return unchanging(march_dataset(self))

    def to_dataframe(self) -> pd.DataFrame:
        """Return torques and coefficients, one row per step and mesh, with the revolutions."""
        table = self.result.to_dataframe()
        steps = [p.position for p in self.result.positions]
        at = dict(zip(steps, self.revolutions, strict=True))
        table.insert(1, "revolutions", table["position"].map(at))
        return table

    def to_xarray(self) -> xr.Dataset:
        """Return the labelled arrays, `dataset`."""
        return self.dataset

    def plot(self, over: Literal["stage", "group"] = "stage") -> Figure:
        """Plot the load-sharing coefficient of every branch over the steps.

        Parameters
        ----------
        over : {"stage", "group"}
            Whose mean divides the torque of a branch.
        """
        return picture(self, over)

    def _view(self) -> View:
        """Show how far the march went, how load was shared, and what the splines dissipated."""
        result, steps = self.result, len(self.revolutions)
        last = self.revolutions[-1] if steps else 0.0
        which = f"{steps} of {len(result.stamp.positions)}" if self.refused else "all"
        facts = (
            ("way", f"{counted(steps, 'step')}, {last:g} revolutions of gear {self.gear}"),
            ("certified", f"{which} steps, worst residual {result.certificate.worst:.1e}"),
            ("largest Ω", by_name(result.omega)),
            ("dissipated", f"{self.dissipated:.4g} J"),
        )
        rows = []
        for gear in self.slips[0] if self.slips else ():
            every = [step[gear] for step in self.slips]
            stages = Counter(s.stage for s in every).most_common()
            sizes = [float((s.slip @ s.slip) ** 0.5) * 1e6 for s in every]
            rows.append(
                (
                    gear,
                    ", ".join(f"{stage} {n}×" for stage, n in stages),
                    f"{min(sizes):.3f} … {max(sizes):.3f}",
                    f"{sum(s.dissipated for s in every):.4g}",
                )
            )
        heads = ("spline", "stages", "slip [µm]", "dissipated [J]")
        tables = (text_table("Splines", heads, rows, heads[:2]),) if rows else ()
        return View(f"March of {result.stamp.case}", facts, tables)

    def _left_open(self) -> list[str]:
        lines = [f"REFUSED  {line}" for line in self.refused.splitlines()]
        total, done = len(self.result.stamp.positions), counted(len(self.slips), "step")
        more = f"{done} of {total} certified; each needs the one before."
        return [*lines, more] if lines else []


def march(
    case: Case | str | FilePath,
    *,
    gear: str | None = None,
    revolutions: float | None = None,
    steps: int | None = None,
    progress: Progress | None = None,
) -> March:
    """March through revolutions of a gear, with friction that remembers its slip.

    The first step loads the train from rest, without slip.

    Parameters
    ----------
    case : Case or path
    gear : str, optional
        Reference gear; that of the case's ``[march]`` by default.
    revolutions : float, optional
        Of that gear.
    steps : int, optional
    progress : Progress, optional
        Called after every step.

    Returns
    -------
    March

    Raises
    ------
    CaseError
        If the case has no march and none is given, or cannot be used.
    Refused
        If a step has no certified equilibrium, or its displacements are too large for the geometry.
        ``partial`` of the exception holds the result of the steps before it, ``study`` their march.

    Examples
    --------
    >>> import loadshare as ls
    >>> found = ls.march("cases/fgfbstts/full_float.toml", gear="4", revolutions=1.0, steps=6)
    >>> found.dissipated > 0.0
    True
    """
    case = opened(case)
    asked = {"gear": gear, "revolutions": revolutions, "steps": steps}
    given = {key: value for key, value in asked.items() if value is not None}
    if case.march is None and len(given) < 3:
        lacking = " and ".join(key for key in asked if key not in given)
        hint = f"In addition to what was given, {lacking} would do." if given else ""
        allowed = "a march with gear, revolutions and steps"
        raise CaseError([case.problem("march", "is missing", allowed, hint)])
    if given:
        case = case.replace({f"march.{key}": value for key, value in given.items()})
    solved = with_laws(case)
    return _marched(case, solved, build_train(solved), progress)


@one_thread()
def _marched(case: Case, solved: Case, train: Train, progress: Progress | None) -> March:
    answers: list[Answer] = []
    slips: list[dict[str, Slip]] = []
    before: dict[str, Vector] = {gear: np.zeros(3) for gear in train.splines}
    steps, history = range(1, train.count + 1), StepHistory()
    assert train.march is not None
    reference, revolutions, total = train.march

    def found(refused: str = "") -> March:
        return March(
            result=result_of(case, solved, train, answers, BACKEND, CERTIFY.tolerance, steps),
            revolutions=tuple(revolutions * k / total for k in range(len(answers))),
            gear=reference,
            slips=tuple(slips),
            refused=refused,
        )

    for index in steps:
        remembering = train_at(train.remembering(before), index)
        try:
            answer = stepped(remembering, index, history)
            refused = answer.refused()
            if refused is not None:
                raise refused
        except Refused as refusal:
            if answers:
                refusal.study = found(str(refusal))
                refusal.partial = refusal.study.result
            raise
        after = {g: _slipped(answer, s, before[g]) for g, s in train.splines.items()}
        slips.append({g: _slip(answer, g, before[g], after[g]) for g in after})
        answers.append(answer)
        before = {g: train.slip_seen_next(g, slip, index) for g, slip in after.items()}
        if progress is not None:
            progress(index, train.count)
    return found()


def _slipped(answer: Answer, spline: Spline, before: Vector) -> Vector:
    """Return the slip at the end of a step; a change within round-off counts as none."""
    after = slip_of(spline, answer.equilibrium)
    round_off = MARCH.unchanged * answer.certificate.deflection
    return before if float(np.linalg.norm(after - before)) <= round_off else after


def _slip(answer: Answer, gear: str, before: Vector, after: Vector) -> Slip:
    train = answer.train
    spline = train.splines[gear]
    friction = np.asarray(answer.equilibrium.radial_reaction[spline.name])
    stage = answer.certificate.floats[gear].spline or ""
    if stage == "stick" and after is not before:
        # Negligible friction differs from none only in the slip that has happened.
        stage = "slip"
    work = max(float(-friction @ (after - before)), 0.0)
    return Slip(
        slip=train.gears[gear].plane @ after,
        stage=stage,
        friction=spline.bound(train.transmitted(gear, answer.equilibrium.flank_force)),
        dissipated=work,
    )
