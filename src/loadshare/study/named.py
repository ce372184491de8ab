"""Studies defined in a case itself: ``[study.NAME]``."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from loadshare.case import Case
from loadshare.case.reader import opened
from loadshare.case.words import did_you_mean
from loadshare.errors import CaseError, Problem, Refused

if TYPE_CHECKING:
    from loadshare.progress import Progress
    from loadshare.study.compare import Comparison
    from loadshare.study.critical import Critical
    from loadshare.study.fit import Fit
    from loadshare.study.march import March
    from loadshare.study.sensitivity import Sensitivity
    from loadshare.study.sweep import Sweep
    from loadshare.study.tolerance.result import Tolerance

    Found: TypeAlias = Sweep | Critical | Sensitivity | March | Comparison | Fit | Tolerance


def run_study(case: Case | str | Path, name: str, *, progress: Progress | None = None) -> Found:
    """Run a study that is defined in a case.

    Parameters
    ----------
    case : Case or path
    name : str
        NAME of the table ``[study.NAME]``.
    progress : Progress, optional
        Called whenever a part of the study is done.

    Returns
    -------
    Sweep, Critical, Sensitivity, March, Comparison, Fit or Tolerance
        Depending on the kind of study.

    Raises
    ------
    CaseError
        If the case has no such study, or the study cannot be run.
    Refused
        If an equilibrium that the study needs is refused.

    Examples
    --------
    >>> import loadshare as ls
    >>> case = ls.load_case("cases/fgfbstts/limit_ring.toml")
    >>> study = {"kind": "sweep", "over": {"rings.4.float": "0 um:8 um:2"}, "positions": [1]}
    >>> found = ls.run_study(case.replace({"study.floats": study}), "floats")
    >>> found.dataset["pair_omega"].sel(stage="II").values.round(4).tolist()
    [1.0471, 1.002]
    """
    case = opened(case)
    block = case.study.get(name := str(name))
    if block is None:
        known = list(case.study)
        allowed = ", ".join(known) or "a table [study.NAME] in the case"
        hint = did_you_mean(name, known)
        raise CaseError(
            [Problem(case.name, f"study.{name}", "", "is not in the case", allowed, hint)]
        )
    arguments = {to: getattr(block, key) for to, key in _ARGUMENTS[block.kind].items()}
    if block.kind == "tolerance":
        arguments = {"study": name}
    run = getattr(import_module("loadshare"), block.kind)
    found: Found = run(case, **arguments, progress=progress)
    return found


def found_by(ask: Callable[[], Any]) -> Any:
    """Return the answer of a study, or what it found before an equilibrium was refused.

    Parameters
    ----------
    ask : callable
        Runs the study.

    Raises
    ------
    Refused
        If it found nothing before.
    """
    try:
        return ask()
    except Refused as refusal:
        if refusal.study is None:
            raise
        return refusal.study


_ARGUMENTS: dict[str, dict[str, str]] = {
    "sweep": {"parameters": "over", "positions": "positions"},
    "critical": {"key": "keys", "start": "start", "stop": "stop", "positions": "positions"},
    "sensitivity": {"inputs": "keys", "positions": "positions"},
    "march": {"gear": "gear", "revolutions": "revolutions", "steps": "steps"},
    "compare": {},
    "fit": {"unknowns": "unknowns", "starts": "starts", "seed": "seed"},
    "tolerance": {},
}
"""For each kind of study, the arguments of its function and the keys of the table that hold them.

A tolerance study reads its table itself.
"""
