"""`loadshare tolerance`: what scattering inputs do to load sharing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from loadshare._version import __version__
from loadshare.cli.completion import study_names
from loadshare.cli.console import say, say_all, stand
from loadshare.cli.exits import fail
from loadshare.cli.files import document_text, tell_written
from loadshare.cli.forms import (
    FIGURES,
    FOLDER,
    Makers,
    Output,
    figure_of,
    outputs,
    tables_of,
    write_all,
)
from loadshare.cli.options import CaseFile, Changes, Positions, over, ranges_of
from loadshare.cli.stop import Stop
from loadshare.cli.study.common import end, running_study
from loadshare.cli.tables.table import show, table
from loadshare.output import netcdf_of
from loadshare.report.numbers import NONE, counted, interval

if TYPE_CHECKING:
    from loadshare.study.tolerance.result import Tolerance
    from loadshare.study.tolerance.statistics import Summary

FORMS = (FOLDER, "csv", "nc", "parquet", "xlsx", "json", *FIGURES)
SHOWN = 20
"""Inputs, and messages, that are shown."""


def tolerance(
    case: CaseFile,
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="Which study, if the case has more than one of this kind.",
            autocompletion=study_names,
        ),
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
            "Input that varies evenly between two values, as in rings.*.float='0 um:12 um', in "
            "place of those of [study.NAME]; without NAME, a study of these alone. May be "
            "repeated.",
        ),
    ] = None,
    file: Annotated[
        list[Output] | None,
        outputs(
            *FORMS,
            what="Folder for the samples (Parquet), from which an interrupted study continues; "
            "or a file: tables hold the samples, .json and .nc the statistics",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Dask scheduler whose workers solve the samples."),
    ] = None,
    workers: Annotated[int, typer.Option(metavar="K", min=1, help="Processes.")] = 2,
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
        raise typer.BadParameter("the samples go into one folder only", param_hint="--output")
    out = folders[0] if folders else None
    scatter = {
        "=".join(keys): {"distribution": "uniform", "low": low, "high": high}
        for keys, (low, high) in ranges_of(ranges, "KEY=LOW:HIGH").items()
    }
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
    show_tolerance(found)
    if out is not None:
        tell_written(out, err=True)
    write_all([o for o in file or () if o.form != FOLDER], made_of_tolerance(found))
    end(found)


def _kept(out: Path | None, done: int, total: int) -> str:
    """Return what is kept, and how to go on, in words."""
    if out is None:
        return "nothing is kept. With -o FOLDER what is solved is, and the same command goes on."
    if done == total > 0:
        kept = f"all {total:,} samples are kept in {out}."
        return f"{kept} The same command looks for the worst case again."
    part = f"{done:,} of {total:,} samples are" if total else "what was there is"
    return f"{part} kept in {out}. The same command continues from there."


def made_of_tolerance(found: Tolerance) -> Makers:
    """Return what makes the files of a tolerance study: samples, and statistics."""
    return {
        **tables_of("tolerance", found.to_frame),
        **figure_of(found.plot),
        "json": lambda: document_text(statistics_document(found)),
        "nc": lambda: netcdf_of(found.dataset),
    }


def statistics_document(found: Tolerance) -> dict[str, Any]:
    """Return the statistics of Ω, the worst cases and what was refused as plain data."""
    return {
        "question": "tolerance",
        "version": __version__,
        "case": found.case,
        "samples": found.samples,
        "refused": found.refused,
        "worst_residual": found.residual,
        "limit": found.limit,
        "omega": [
            {
                "stage": one.stage,
                "over": one.over,
                "mean": one.summary.mean.value,
                "deviation": one.summary.deviation,
                "lowest": one.summary.lowest,
                "highest": one.summary.highest,
                "quantiles": {f"{k:g}": q.value for k, q in one.summary.quantiles.items()},
                "exceedance": None if one.exceedance is None else one.exceedance.value,
            }
            for one in found.omega
        ],
        "worst": [asdict(one) for one in found.worst],
    }


def show_tolerance(found: Tolerance) -> None:
    """Print how Ω scatters, from which inputs it comes, and the worst case."""
    settings = found.settings
    say(
        f"Tolerance study of {found.case}: {found.samples:,} {settings['sampling']} samples, "
        f"seed {settings['seed']}, {counted(len(settings['positions']), 'position')}, "
        f"largest residual {found.residual:.1e}"
    )
    inputs = [(drawn.name, str(drawn.distribution)) for drawn in found.inputs.every]
    _show_first("Inputs", ("input", "scatters"), inputs, words=("input", "scatters"))
    _show_omega(found)
    _show_shares(found)
    _show_others(found)
    _show_worst(found)
    refusals = list(found.messages.items())[:SHOWN]
    say_all(f"REFUSED  {count}×  {text}" for text, count in refusals)
    if found.design_refused:
        refused = counted(found.design_refused, "sample")
        say(f"WARNING  {refused} for the shares of variance refused; their rows are left out")


def _show_first(
    title: str, heads: Iterable[str], rows: Sequence[Sequence[str]], words: Iterable[str]
) -> None:
    """Print the first rows, and how many there are more."""
    show(title, table(heads, rows[:SHOWN], words))
    if len(rows) > SHOWN:
        say(f"and {len(rows) - SHOWN} more")


def _show_omega(found: Tolerance) -> None:
    levels = list(found.omega[0].summary.quantiles) if found.omega else []
    limit = [] if found.limit is None else [f"P(Ω > {found.limit:g})"]
    figures, quantiles = [], []
    for one in found.omega:
        if one.over not in found.overs:
            continue
        s = one.summary
        label = f"{one.stage}, group" if one.over == "group" else one.stage
        above = [interval(one.exceedance)] if one.exceedance is not None else []
        mean, spread, highest = f"{s.mean.value:.5f}", f"{s.spread:.2g}", f"{s.highest:.5f}"
        figures.append((label, mean, spread, highest, *above))
        quantiles.append((label, *(f"{q.value:.5f}" for q in s.quantiles.values())))
    heads = ("Ω", "mean", "deviation", "largest", *limit)
    show("Largest Ω over branches and positions", table(heads, figures, words=("Ω",)))
    heads = ("Ω", *(f"{100 * level:g} %" for level in levels))
    show("Its quantiles", table(heads, quantiles, words=("Ω",)))
    if found.limit is not None or any(one.shares for one in found.omega):
        say("Intervals in brackets: 95 %.")


def _show_shares(found: Tolerance) -> None:
    for one in found.omega:
        if one.stage != "system" or one.over not in found.overs or not one.shares:
            continue
        rows = [
            (share.unit, *(interval(e, ".3f") for e in (share.first, share.total)))
            for share in sorted(one.shares, key=lambda s: -s.total.value)
        ]
        mean = "group" if one.over == "group" else "stage"
        title = f"Shares of the variance of Ω of the system, by the mean of the {mean}"
        _show_first(title, ("input", "alone", "with interactions"), rows, words=("input",))


def _show_others(found: Tolerance) -> None:
    heads = ("mean", "deviation", "smallest", "largest")

    def cells(s: Summary, factor: float = 1.0) -> list[str]:
        values = (s.mean.value, s.spread, s.lowest, s.highest)
        return [f"{factor * value:.5g}" for value in values]

    rows = [(mesh, *cells(summary)) for mesh, summary in found.torque.items()]
    made = table(("mesh", *heads), rows, words=("mesh",))
    show("Largest driver torque over positions [N·m]", made)
    if found.floats:
        rows = [
            (f.gear, *cells(f.way, 1e6), NONE if f.pressed is None else f"{100 * f.pressed:.4g} %")
            for f in found.floats
        ]
        made = table(("float", *heads, "on its boundary"), rows, words=("float",))
        show("Largest displacement of floats over positions [µm]", made)


def _show_worst(found: Tolerance) -> None:
    for one in found.worst:
        rows = (
            (d.name, f"{one.inputs[d.name]:.6g} {d.distribution.unit}".strip(), one.at[d.name])
            for d in found.inputs.every
        )
        heads = ("input", "value", "of its tolerance")
        show(
            f"Worst case found within the tolerances: Ω = {one.omega:.5f} "
            f"by the mean of the {one.over}",
            table(heads, rows, words=("input", "of its tolerance")),
        )
        say(f"Certified; the best of {one.solved:,} trials, there may be a worse one")
