"""The commands that need more than one equilibrium of a case, and how they end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from loadshare.cli.cases import open_case
from loadshare.cli.completion import study_names
from loadshare.cli.console import Tick, print_note, progress, stand
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, reporting_problems
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
from loadshare.cli.refusal import refusal_lines
from loadshare.cli.stop import Stop
from loadshare.cli.study.answers import KINDS
from loadshare.cli.waiting import echo
from loadshare.errors import LoadshareError, Refused

if TYPE_CHECKING:
    from loadshare.case import Case


@contextmanager
def running_study(
    file: Path,
    change: list[str] | None,
    what: str,
    total: int | None = 1,
    *,
    rated: bool = False,
) -> Iterator[tuple[Case, Tick]]:
    """Open the case of a study and a progress bar; what cannot be answered becomes a message.

    Parameters
    ----------
    file : Path
    change : list of str or None
        Values of ``--set``.
    what, total, rated
        As for `progress`, as far as known beforehand.
    """
    with answered():
        case = open_case(file, change)
        with progress(what, total, rated=rated) as tick:
            yield case, tick


@contextmanager
def answered() -> Iterator[None]:
    """Turn an unusable case, wrong positions and a refused answer into messages and exit codes."""
    try:
        with reporting_problems():
            yield
    except Refused as refusal:
        fail([f"REFUSED  {line}" for line in refusal_lines(refusal)], REFUSED)
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
    write_all([o for o in files or () if o.form != FOLDER], KINDS[kind].makers(found))
    if lines := found._left_open():
        fail(lines, REFUSED)


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
    from loadshare.study.sweep import sweep as swept

    form = "KEY=GRID, as in rings.4.float='0 um:12 um:61'"
    parameters = settings_of(grids, form)
    with running_study(case, change, "points") as (loaded, tick):
        found = swept(loaded, parameters, positions=position, progress=tick)
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
    from loadshare.study.critical import critical as found_along

    along, low, high = _range(ranges, key, start, stop)
    with running_study(case, change, "positions") as (loaded, tick):
        found = found_along(loaded, along, low, high, positions=position, progress=tick)
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
    from loadshare.study.sensitivity import sensitivity as differentiated

    with running_study(case, change, "inputs") as (loaded, tick):
        found = differentiated(loaded, key or None, positions=position, progress=tick)
    conclude("sensitivity", found, file)


def _study_name(text: str) -> Any:
    """Return the argument that names a study of the case, with its help."""
    return typer.Argument(metavar="NAME", help=text, autocompletion=study_names)


def tolerance(
    case: CaseFile,
    name: Annotated[
        str | None,
        _study_name("Which study, if the case has more than one of this kind."),
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
    from loadshare.study.tolerance.study import tolerance as studied

    folders = [output.file for output in file or () if output.form == FOLDER]
    if len(folders) > 1:
        raise typer.BadParameter("samples can only go into one folder", param_hint="--output")
    out = folders[0] if folders else None
    scatter = _scatter(ranges, "KEY=LOW:HIGH")
    stop = Stop()
    with running_study(case, change, "samples", None, rated=True) as (loaded, tick):
        try:
            with stop:
                found = studied(
                    loaded,
                    scatter or None,
                    study=name,
                    samples=samples,
                    seed=seed,
                    positions=position,
                    out=out,
                    scheduler=scheduler,
                    workers=workers,
                    worst=worst,
                    progress=tick,
                )
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
    from loadshare.study.march import march as marched

    with running_study(case, change, "steps") as (loaded, tick):
        found = marched(loaded, gear=gear, revolutions=revolutions, steps=steps, progress=tick)
    conclude("march", found, file)


def compare(
    case: CaseFile,
    file: Files = None,
    change: Changes = None,
) -> None:
    """Compare measured figures with computed ones."""
    from loadshare.study.compare import compare as compared

    with running_study(case, change, "positions") as (loaded, tick):
        found = compared(loaded, progress=tick)
    conclude("compare", found, file)


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
    from loadshare.study.fit import fit as fitted

    unknowns = ranges_of(unknown, "KEY=LOW:HIGH")
    with running_study(case, change, "starting points", starts) as (loaded, tick):
        found = fitted(loaded, unknowns, starts=starts, seed=seed, progress=tick)
    conclude("fit", found, file)


def study(
    case: CaseFile,
    name: Annotated[
        str | None,
        _study_name("Which study; by default all are listed."),
    ] = None,
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
    from loadshare.study.named import run_study

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
            found = run_study(loaded, name, progress=tick)
    makers = KINDS[kind].makers(found)
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
