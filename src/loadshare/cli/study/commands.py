"""The commands that need more than one equilibrium of a case, and how they end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from loadshare.cli.cases import open_case
from loadshare.cli.completion import study_names
from loadshare.cli.console import print_note, progress, stand
from loadshare.cli.exits import UNUSABLE, fail, fail_refused, reporting_problems
from loadshare.cli.files import print_written
from loadshare.cli.forms import FIGURES, FOLDER, TABLES, Output, outputs, write_all
from loadshare.cli.options import (
    OVER,
    CaseFile,
    Changes,
    Gear,
    Positions,
    keys,
    over,
    ranges_of,
    settings_of,
)
from loadshare.cli.stop import Stop
from loadshare.cli.study.answers import KINDS, makers_of
from loadshare.cli.waiting import echo
from loadshare.errors import LoadshareError, Refused

if TYPE_CHECKING:
    from loadshare.case import Case


def run(
    kind: str, file: Path, change: list[str] | None, what: str, total: int | None = 1, **asked: Any
) -> Any:
    """Run a study of a case with a progress bar and return its answer.

    Parameters
    ----------
    kind : str
        Name of the study's function in `loadshare`.
    file : Path
    change : list of str or None
        Values of ``--set``.
    what, total
        As for `progress`, as far as known beforehand.
    **asked
        Arguments of the study.

    Raises
    ------
    typer.Exit
        If it cannot be answered; the message says why.
    """
    from loadshare.study.named import found_by

    with answered():
        case = open_case(file, change)
        with progress(what, total, rated=total is None) as tick:
            ask = getattr(import_module("loadshare"), kind)
            return found_by(partial(ask, case, **asked, progress=tick))


@contextmanager
def answered() -> Iterator[None]:
    """Turn an unusable case, wrong positions and a refused answer into messages and exit codes."""
    try:
        with reporting_problems():
            yield
    except Refused as refusal:
        fail_refused(refusal)
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    except ValueError as error:
        if not str(error).startswith("position"):
            raise
        fail([str(error)], UNUSABLE)


def conclude(kind: str, found: Any, files: list[Output] | None) -> None:
    """Print the answer of a study and write its files, except a folder of samples, already there.

    Raises
    ------
    typer.Exit
        With the code of a refusal if answers are missing; the message says which.
    """
    KINDS[kind].show(found)
    for output in files or ():
        if output.form == FOLDER:
            print_written(output.file, err=True)
    single = [o for o in files or () if o.form != FOLDER]
    write_all(single, makers_of(kind, found), missing=found._left_open())


Files = Annotated[list[Output] | None, outputs(*TABLES, *FIGURES)]
SWEPT = ("csv", "nc", "parquet", "xlsx", "json", *FIGURES)


def sweep(
    case: CaseFile,
    grids: Annotated[
        list[str],
        over(
            "GRID",
            "Input and its values, as in rings.4.float='0 um:12 um:61' (first, last, number) or "
            "'a, b, c'; KEY=KEY=GRID ties keys; a star matches any name. One or two inputs.",
        ),
    ],
    file: Annotated[list[Output] | None, outputs(*SWEPT)] = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Solve a case over a grid of one or two inputs."""
    parameters = settings_of(grids, "KEY=GRID, as in rings.4.float='0 um:12 um:61'")
    found = run("sweep", case, change, "points", parameters=parameters, positions=position)
    conclude("sweep", found, file)


def critical(
    case: CaseFile,
    key: Annotated[list[str] | None, typer.Argument(metavar="KEY", hidden=True)] = None,
    ranges: Annotated[
        list[str] | None,
        over(
            "FROM:TO",
            "Input to vary and its ends, as in rings.4.float='0 um:12 um'; KEY=KEY=FROM:TO ties "
            "keys; a star matches any name.",
        ),
    ] = None,
    start: Annotated[str | None, typer.Option("--from", metavar="VALUE", hidden=True)] = None,
    stop: Annotated[str | None, typer.Option("--to", metavar="VALUE", hidden=True)] = None,
    file: Files = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Find exactly where contacts, floats and splines change along an input."""
    along, low, high = _range(ranges, key, start, stop)
    asked: dict[str, Any] = {"key": along, "start": low, "stop": high, "positions": position}
    found = run("critical", case, change, "positions", **asked)
    conclude("critical", found, file)


FORM = "KEY=FROM:TO, as in rings.4.float='0 um:12 um'"


def _range(
    given: list[str] | None, key: list[str] | None, start: str | None, stop: str | None
) -> tuple[list[str], str, str]:
    """Return the keys to vary and the ends of the range, from the present or the former options."""
    if given:
        if key or start or stop:
            raise typer.BadParameter(
                "gives everything: leave out other keys, --from and --to", param_hint=OVER
            )
        if len(given) > 1:
            hint = "takes one range; tied keys are written KEY=KEY=FROM:TO"
            raise typer.BadParameter(hint, param_hint=OVER)
        ((keys, ends),) = ranges_of(given, FORM).items()
        return list(keys), *ends
    if not key or start is None or stop is None:
        raise typer.BadParameter(f"is missing: {FORM}", param_hint=OVER)
    print_note(f"KEY --from FROM --to TO is now {OVER} KEY=FROM:TO.")
    return key, start, stop


def sensitivity(
    case: CaseFile,
    key: Annotated[
        list[str] | None, keys("Inputs; a star matches any name. All by default.")
    ] = None,
    file: Files = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Compute how torques, Ω and floats change with each input."""
    found = run("sensitivity", case, change, "inputs", inputs=key or None, positions=position)
    conclude("sensitivity", found, file)


def _study_name(text: str) -> Any:
    """Return the argument that names a study of the case, with its help."""
    return typer.Argument(metavar="NAME", help=text, autocompletion=study_names)


def tolerance(
    case: CaseFile,
    name: Annotated[
        str | None, _study_name("Which study, if the case has more than one of this kind.")
    ] = None,
    samples: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Samples, instead of the case's.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(metavar="S", min=0, help="Seed, instead of the case's.")
    ] = None,
    ranges: Annotated[
        list[str] | None,
        over(
            "LOW:HIGH",
            "Input that varies uniformly between two values, as in rings.*.float='0 um:12 um', in "
            "place of those of [study.NAME]; without NAME, a study of these alone. May be "
            "repeated.",
        ),
    ] = None,
    file: Annotated[
        list[Output] | None,
        outputs(
            FOLDER,
            *SWEPT,
            what="Folder for the samples (Parquet), from which an interrupted study continues; "
            "or a file: tables hold the samples, .json and .nc the statistics",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Dask scheduler whose workers solve the samples."),
    ] = None,
    workers: Annotated[int, typer.Option(metavar="K", min=1, help="Number of processes.")] = 2,
    worst: Annotated[
        bool, typer.Option("--worst/--no-worst", help="Search for the worst case as well.")
    ] = True,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Vary inputs within their tolerances ([study.NAME]) and show how Ω is distributed."""
    folders = [output.file for output in file or () if output.form == FOLDER]
    if len(folders) > 1:
        raise typer.BadParameter("samples can only go into one folder", param_hint="--output")
    out = folders[0] if folders else None
    scatter = _scatter(ranges, "KEY=LOW:HIGH")
    stop = Stop()
    asked: dict[str, Any] = {"inputs": scatter or None, "study": name, "samples": samples}
    asked |= {"seed": seed, "positions": position, "out": out, "worst": worst}
    asked |= {"scheduler": scheduler, "workers": workers}
    try:
        with stop:
            found = run("tolerance", case, change, "samples", None, **asked)
    except KeyboardInterrupt:
        fail(["Interrupted: " + _kept(out, *stand())], stop.code)
    conclude("tolerance", found, file)


def _kept(out: Path | None, done: int, total: int) -> str:
    """Return what is kept, and how to go on, in words."""
    if out is None:
        return "nothing is kept. With -o FOLDER, samples are kept and the same command continues."
    if done == total > 0:
        kept = f"all {total:,} samples are kept in {out}."
        return f"{kept} The same command searches for the worst case again."
    part = f"{done:,} of {total:,} samples are" if total else "what was there is"
    return f"{part} kept in {out}. The same command continues from there."


def _scatter(ranges: list[str] | None, form: str) -> dict[str, dict[str, str]]:
    """Return inputs that vary evenly over ranges, as in [study.NAME]."""
    return {
        "=".join(keys): {"distribution": "uniform", "low": low, "high": high}
        for keys, (low, high) in ranges_of(ranges, form).items()
    }


def march(
    case: CaseFile,
    gear: Gear = None,
    revolutions: Annotated[
        float | None, typer.Option(metavar="X", help="Revolutions to march, above 0.")
    ] = None,
    steps: Annotated[int | None, typer.Option(metavar="N", min=1, help="Number of steps.")] = None,
    file: Files = None,
    change: Changes = None,
) -> None:
    """March through revolutions; spline friction depends on the previous slip."""
    asked: dict[str, Any] = {"gear": gear, "revolutions": revolutions, "steps": steps}
    found = run("march", case, change, "steps", **asked)
    conclude("march", found, file)


def compare(case: CaseFile, file: Files = None, change: Changes = None) -> None:
    """Compare measured figures with computed ones."""
    conclude("compare", run("compare", case, change, "positions"), file)


def fit(
    case: CaseFile,
    unknown: Annotated[
        list[str],
        over(
            "LOW:HIGH",
            "Input to fit and its bounds, as in errors.6.installation.direction='0 deg:360 deg'; "
            "may be repeated.",
        ),
    ],
    starts: Annotated[
        int, typer.Option(metavar="N", min=1, help="Starting points; the best answer is taken.")
    ] = 1,
    seed: Annotated[
        int, typer.Option(metavar="N", min=0, help="Random seed of the other starting points.")
    ] = 0,
    file: Annotated[list[Output] | None, outputs("toml", *TABLES, *FIGURES)] = None,
    change: Changes = None,
) -> None:
    """Fit inputs of a case to measured figures."""
    unknowns = ranges_of(unknown, "KEY=LOW:HIGH")
    asked: dict[str, Any] = {"unknowns": unknowns, "starts": starts, "seed": seed}
    conclude("fit", run("fit", case, change, "starting points", starts, **asked), file)


def study(
    case: CaseFile,
    name: Annotated[str | None, _study_name("Which study; by default all are listed.")] = None,
    varied: Annotated[
        list[str] | None,
        over(
            "VALUES",
            "Inputs to vary instead of the study's own, as for sweep, critical, fit or "
            "tolerance; may be repeated.",
        ),
    ] = None,
    file: Annotated[
        list[Output] | None, outputs(*TABLES, *FIGURES, "toml", what="Write the answer")
    ] = None,
    change: Changes = None,
) -> None:
    """Run a study of the case, [study.NAME]."""
    from loadshare.study.named import found_by, run_study

    with answered():
        loaded = open_case(case, change)
        if name is None:
            for known, block in loaded.study.items():
                echo(f"{known}: {block.kind}")
            if not loaded.study:
                echo("The case has no study: add a table [study.NAME].")
            return
        kind = loaded.study[name].kind if name in loaded.study else ""
        if kind and varied:
            loaded = _varied(loaded, name, kind, varied)
        rated = kind == "tolerance"
        with progress(*(("samples", None) if rated else (name, 1)), rated=rated) as tick:
            found = found_by(partial(run_study, loaded, name, progress=tick))
    makers = makers_of(kind, found)
    for output in file or ():
        if output.form not in makers:
            can = ", ".join(f".{form}" for form in makers)
            raise typer.BadParameter(
                f"{output.file}: a {kind} can write {can}", param_hint="--output"
            )
    conclude(kind, found, file)


def _varied(case: Case, name: str, kind: str, given: list[str]) -> Case:
    """Return the case with the inputs of a study replaced by those of the command line.

    Raises
    ------
    typer.BadParameter
        If a study of this kind varies no inputs over values.
    """
    from loadshare.case.keys import dotted

    def at(key: str) -> str:
        return dotted(("study", name, key))

    if kind == "sweep":
        grids = settings_of(given, "KEY=GRID")
        return case.replace({at("over"): {"=".join(keys): grid for keys, grid in grids.items()}})
    if kind not in ("critical", "fit", "tolerance"):
        raise typer.BadParameter(f"a {kind} does not vary inputs over values", param_hint=OVER)
    form = "KEY=FROM:TO"
    if kind == "tolerance":
        return case.replace({at("inputs"): _scatter(given, form)})
    ranges = ranges_of(given, form)
    if kind == "critical":
        if len(ranges) > 1:
            raise typer.BadParameter("takes one range for a critical study", param_hint=OVER)
        ((keys, (low, high)),) = ranges.items()
        return case.replace({at("keys"): list(keys), at("start"): low, at("stop"): high})
    return case.replace({at("unknowns"): {"=".join(k): list(v) for k, v in ranges.items()}})
