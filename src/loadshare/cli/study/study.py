"""`loadshare study`: a study that the case itself holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from loadshare.cli.changes import open_case
from loadshare.cli.completion import study_names
from loadshare.cli.console import progress
from loadshare.cli.forms import FIGURES, TABLES, Makers, Output, outputs, write_all
from loadshare.cli.options import OVER, CaseFile, Changes, over, ranges_of, split_setting
from loadshare.cli.study.common import answered, end
from loadshare.cli.study.compare import made_of_comparison, show_comparison
from loadshare.cli.study.critical import made_of_critical, show_critical
from loadshare.cli.study.fit import made_of_fit, show_fit
from loadshare.cli.study.march import made_of_march, show_march
from loadshare.cli.study.sensitivity import made_of_sensitivity, show_sensitivity
from loadshare.cli.study.sweep import made_of_sweep, show_sweep
from loadshare.cli.study.tolerance import made_of_tolerance, show_tolerance
from loadshare.cli.waiting import echo

if TYPE_CHECKING:
    from loadshare.case import Case


@dataclass(frozen=True)
class Kind:
    """How the answer of a kind of study is shown.

    Attributes
    ----------
    show : callable
        Prints it.
    makers : callable
        Returns what makes files of it.
    """

    show: Callable[[Any], None]
    makers: Callable[[Any], Makers]


KINDS = {
    "compare": Kind(show_comparison, made_of_comparison),
    "critical": Kind(show_critical, made_of_critical),
    "fit": Kind(show_fit, made_of_fit),
    "march": Kind(show_march, made_of_march),
    "sensitivity": Kind(show_sensitivity, made_of_sensitivity),
    "sweep": Kind(show_sweep, made_of_sweep),
    "tolerance": Kind(show_tolerance, made_of_tolerance),
}
FORMS = (*TABLES, *FIGURES, "toml")


def study(
    case: CaseFile,
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="Which study; by default all are listed.",
            autocompletion=study_names,
        ),
    ] = None,
    varied: Annotated[
        list[str] | None,
        over(
            "VALUES",
            "What the study varies instead of its own inputs: as for sweep, critical, fit or "
            "tolerance; may be repeated.",
        ),
    ] = None,
    file: Annotated[list[Output] | None, outputs(*FORMS, what="Write the answer")] = None,
    change: Changes = None,
) -> None:
    """Run a study that the case holds, [study.NAME]."""
    from loadshare.study.named import run_study

    with answered():
        loaded = open_case(case, change)
        if name is None:
            for known, block in loaded.study.items():
                echo(f"{known}: {block.kind}")
            if not loaded.study:
                echo("The case holds no study: add a table [study.NAME].")
            return
        kind = loaded.study[name].kind if name in loaded.study else ""
        if kind and varied:
            loaded = _varied(loaded, name, kind, varied)
        rated = kind == "tolerance"
        with progress(*(("samples", None) if rated else (name, 1)), rated=rated) as tick:
            found = run_study(loaded, name, progress=tick)
    chosen = KINDS[kind]
    makers = chosen.makers(found)
    for output in file or ():
        if output.form not in makers:
            can = ", ".join(f".{form}" for form in makers)
            raise typer.BadParameter(
                f"{output.file}: a {kind} can write {can}", param_hint="--output"
            )
    chosen.show(found)
    write_all(file, makers)
    end(found)


def _varied(case: Case, name: str, kind: str, given: list[str]) -> Case:
    """Return the case with the inputs of a study as the command line has them.

    Raises
    ------
    typer.BadParameter
        If a study of this kind varies no inputs over values.
    """
    from loadshare.case.keys import dotted

    def at(key: str) -> str:
        return dotted(("study", name, key))

    if kind == "sweep":
        pairs = (split_setting(text, "KEY=GRID") for text in given)
        return case.replace({at("over"): {"=".join(keys): grid for keys, grid in pairs}})
    if kind not in ("critical", "fit", "tolerance"):
        raise typer.BadParameter(f"a {kind} varies no input over values", param_hint=OVER)
    ranges = ranges_of(given, "KEY=FROM:TO")
    if kind == "critical":
        if len(ranges) > 1:
            raise typer.BadParameter("takes one range for a critical", param_hint=OVER)
        ((keys, (low, high)),) = ranges.items()
        return case.replace({at("keys"): list(keys), at("start"): low, at("stop"): high})
    if kind == "fit":
        return case.replace({at("unknowns"): {"=".join(k): list(v) for k, v in ranges.items()}})
    scatter = {
        "=".join(keys): {"distribution": "uniform", "low": low, "high": high}
        for keys, (low, high) in ranges.items()
    }
    return case.replace({at("inputs"): scatter})
