"""Studies that a case itself holds: ``[study.NAME]``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.case import Case, Study
from loadshare.case.words import did_you_mean
from loadshare.errors import CaseError, Problem
from loadshare.study.positions import loaded

if TYPE_CHECKING:
    from loadshare.job import Progress
    from loadshare.study.compare import Comparison
    from loadshare.study.critical import Critical
    from loadshare.study.fit import Fit
    from loadshare.study.march import March
    from loadshare.study.sensitivity import Sensitivity
    from loadshare.study.sweep import Sweep
    from loadshare.study.tolerance.result import Tolerance

    Found = Sweep | Critical | Sensitivity | March | Comparison | Fit | Tolerance


def run_study(case: Case | str | Path, name: str, *, progress: Progress | None = None) -> Found:
    """Run a study that a case holds.

    Parameters
    ----------
    case : Case or path
    name : str
        Of the table ``[study.NAME]``.
    progress : Progress, optional
        Called as parts of the study are done.

    Returns
    -------
    Sweep, Critical, Sensitivity, March, Comparison, Fit or Tolerance
        By the study's kind.

    Raises
    ------
    CaseError
        If the case has no such study, or the study cannot be run.
    Refused
        If an equilibrium that it rests on is refused.

    Examples
    --------
    >>> import loadshare as ls
    >>> case = ls.load_case("cases/fgfbstts/limit_ring.toml")
    >>> asked = {"kind": "sweep", "over": {"rings.4.float": "0 um:8 um:2"}, "positions": [1]}
    >>> found = ls.run_study(case.replace({"study.floats": asked}), "floats")
    >>> found.dataset["pair_omega"].sel(stage="II").values.round(4).tolist()
    [1.0471, 1.002]
    """
    case = loaded(case)
    block = case.study.get(name)
    if block is None:
        known = list(case.study)
        allowed = ", ".join(known) or "a table [study.NAME] in the case"
        raise CaseError(
            [
                Problem(
                    case.name,
                    f"study.{name}",
                    "",
                    "is not in the case",
                    allowed,
                    did_you_mean(name, known),
                )
            ]
        )
    found: Found = _RUN[block.kind](case, block, progress)
    return found


def _sweep(case: Case, block: Study, progress: Any) -> Sweep:
    from loadshare.study.sweep import sweep

    over = {k: list(v) if isinstance(v, tuple) else v for k, v in (block.over or {}).items()}
    return sweep(case, over, positions=block.positions, progress=progress)


def _critical(case: Case, block: Study, progress: Any) -> Critical:
    from loadshare.study.critical import critical

    return critical(
        case,
        block.keys or (),
        block.start,
        block.stop,
        positions=block.positions,
        progress=progress,
    )


def _sensitivity(case: Case, block: Study, progress: Any) -> Sensitivity:
    from loadshare.study.sensitivity import sensitivity

    return sensitivity(case, block.keys, positions=block.positions, progress=progress)


def _march(case: Case, block: Study, progress: Any) -> March:
    from loadshare.study.march import march

    return march(
        case,
        gear=block.gear,
        revolutions=block.revolutions,
        steps=block.steps,
        progress=progress,
    )


def _compare(case: Case, _: Study, progress: Any) -> Comparison:
    from loadshare.study.compare import compare

    return compare(case, progress=progress)


def _fit(case: Case, block: Study, progress: Any) -> Fit:
    from loadshare.study.fit import fit

    return fit(
        case,
        dict((block.unknowns or {}).items()),
        starts=block.starts,
        seed=block.seed,
        progress=progress,
    )


def _tolerance(case: Case, block: Study, progress: Any) -> Tolerance:
    from loadshare.study.tolerance.study import tolerance

    name = next(name for name, known in case.study.items() if known is block)
    return tolerance(case, study=name, progress=progress)


_RUN: dict[str, Callable[[Case, Study, Any], Any]] = {
    "sweep": _sweep,
    "critical": _critical,
    "sensitivity": _sensitivity,
    "march": _march,
    "compare": _compare,
    "fit": _fit,
    "tolerance": _tolerance,
}
