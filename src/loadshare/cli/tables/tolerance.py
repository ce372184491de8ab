"""The effect of scattering inputs on load sharing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from loadshare._version import __version__
from loadshare.cli.console import say, say_all
from loadshare.cli.tables.table import show, table
from loadshare.report.numbers import NONE, counted, interval

if TYPE_CHECKING:
    from loadshare.study.tolerance.result import Tolerance
    from loadshare.study.tolerance.statistics import Summary

SHOWN = 20
"""Number of inputs, and of messages, that are shown."""


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
    """Print how Ω scatters, which inputs that comes from, and the worst case."""
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
        say(f"WARNING  {refused} refused for the shares of variance; their rows are left out")


def _show_first(
    title: str, heads: Iterable[str], rows: Sequence[Sequence[str]], words: Iterable[str]
) -> None:
    """Print the first rows, and how many more there are."""
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
        say(f"Certified; the largest of {one.solved:,} trials, there may be a worse case")
