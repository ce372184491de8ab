"""Presentation of the answers of studies: functions that print each kind and make its files."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from loadshare.cli.console import say, say_all
from loadshare.cli.exits import ranges
from loadshare.cli.forms import Makers, figure_of, tables_of
from loadshare.cli.tables.sensitivity import show_sensitivity
from loadshare.cli.tables.table import show, table
from loadshare.cli.tables.tolerance import show_tolerance, statistics_document
from loadshare.json_text import json_text
from loadshare.libraries import pd
from loadshare.output import netcdf_of
from loadshare.report.numbers import counted, omega

if TYPE_CHECKING:
    from rich.table import Table

    from loadshare.study.compare import Comparison, Deviation
    from loadshare.study.critical import Critical
    from loadshare.study.fit import Fit
    from loadshare.study.march import March
    from loadshare.study.sweep import Sweep


def show_comparison(found: Comparison) -> None:
    """Print every measured figure next to the computed one."""
    words = ("measured", "of", "at")
    heads = (*words, "figure", "±", "computed", "difference", "in ±")
    show("Measured against computed", table(heads, map(_row, found.deviations), words))
    say(f"χ² = {found.chi_square:.4g} over {counted(len(found.deviations), 'figure')}")


def _row(d: Deviation) -> tuple[str, ...]:
    target = d.target
    unit = f" [{target.unit}]" if target.unit else ""
    return (
        target.measurement,
        f"{target.quantity} {target.where}{unit}",
        "all" if target.position is None else str(target.position),
        f"{target.value:.6g}",
        f"{target.uncertainty:.3g}",
        f"{d.computed:.6g}",
        f"{d.difference:+.3g}",
        f"{d.deviations:+.2f}",
    )


def show_critical(found: Critical) -> None:
    """Print every event, with all positions at which it is found alike."""
    unit = f" [{found.parameter.unit}]" if found.parameter.unit else ""
    doubtful = not all(e.confirmed for e in found.events)
    alike: dict[tuple[str, ...], list[int]] = {}
    for e in found.events:
        confirmed = ["yes" if e.confirmed else "NO"] if doubtful else []
        row = (f"{e.value:.9g}", e.element, e.kind, e.before, e.after, *confirmed)
        alike.setdefault(row, []).append(e.position)
    words = ("element", "event", "below", "above", *(["confirmed"] if doubtful else []), "at")
    ordered = sorted(alike.items(), key=lambda item: float(item[0][0]))
    rows = ((*row, ranges(positions)) for row, positions in ordered)
    made = table((f"{found.parameter.name}{unit}", *words), rows, words)
    made.columns[0].no_wrap = False
    title = f"Events from {found.start:g} to {found.stop:g}{unit}"
    if alike:
        show(title, made)
    else:
        say(f"\n{title}: none")
    if not doubtful and not found.unproved:
        say("Proved: there are no other events between the certified solves.")


def _about_critical(found: Critical) -> dict[str, object]:
    unproved = [{"position": u.position, "from": u.start, "to": u.stop} for u in found.unproved]
    about = {"parameter": found.parameter.name, "unit": found.parameter.unit}
    return {**about, "unproved": unproved}


def show_fit(found: Fit) -> None:
    """Print the fitted values with their uncertainties, and the comparison that they give."""
    rows = (
        (
            u.parameter.name,
            u.parameter.unit,
            f"{u.start:.6g}",
            f"{u.value:.6g}",
            "not determined" if math.isinf(u.deviation) else f"{u.deviation:.3g}",
            f"{u.low:g} … {u.high:g}",
        )
        for u in found.unknowns
    )
    heads = ("unknown", "unit", "start", "fitted", "±", "bounds")
    show("Fitted inputs", table(heads, rows, words=("unknown", "unit")))
    if len(found.unknowns) > 1:
        names = [u.parameter.name for u in found.unknowns]
        correlations = (
            (name, *("–" if math.isnan(c) else f"{c:+.3f}" for c in row))
            for name, row in zip(names, found.correlation, strict=True)
        )
        made = table(("correlation", *names), correlations, words=("correlation",))
        show("Correlations", made)
    show_comparison(found.comparison)
    if len(found.starts) > 1:
        reached = ", ".join("failed" if math.isnan(chi) else f"{chi:.4g}" for chi in found.starts)
        say(f"χ² from each starting point: {reached}")
    say_all(f"WARNING  {warning}" for warning in found.warnings)


def _unknowns(found: Fit) -> pd.DataFrame:
    rows = [
        (u.parameter.name, u.parameter.unit, u.start, u.value, u.deviation, u.low, u.high)
        for u in found.unknowns
    ]
    heads = ["unknown", "unit", "start", "fitted", "deviation", "low", "high"]
    return pd.DataFrame(rows, columns=heads)


def show_march(found: March) -> None:
    """Print load sharing over the march, and what every spline did."""
    from loadshare.cli.tables.result import print_result

    print_result(found.result, len(found.result.stamp.positions))
    if not found.slips or not found.slips[0]:
        say("\nNo gear is on a spline, so no slip carries over from step to step.")
        return
    rows = []
    for gear in found.slips[0]:
        steps = [step[gear] for step in found.slips]
        stages = ", ".join(f"{s} {n}×" for s, n in Counter(s.stage for s in steps).most_common())
        sizes = [float((s.slip @ s.slip) ** 0.5) * 1e6 for s in steps]
        total = sum(s.dissipated for s in steps)
        rows.append((gear, stages, f"{min(sizes):.3f} … {max(sizes):.3f}", f"{total:.4g}"))
    heads = ("spline", "stages", "slip [µm]", "dissipated [J]")
    show("Splines", table(heads, rows, words=heads[:2]))


MEANS = {"stage": "omega", "group": "pair_omega"}


def show_sweep(found: Sweep) -> None:
    """Print the largest Ω of every stage at every point; by group as well if that differs."""
    tables = {mean: _table(found, kind) for mean, kind in MEANS.items()}
    texts = [[list(column.cells) for column in made.columns] for made in tables.values()]
    if texts[0] == texts[1]:
        tables = {"stage and group alike": tables["stage"]}
    for mean, made in tables.items():
        show(f"Sweep of {found.case}: largest Ω, by {mean}", made)


def _table(found: Sweep, kind: str) -> Table:
    stages = list(found.largest(kind, 0))
    heads = [p.column for p in found.parameters]
    # Where every point is certified, a column that says so would only take room.
    status = [] if found.passed else ["status"]
    rows = (
        (
            *(f"{value:.6g}" for value in point.values),
            *map(omega, found.largest(kind, k).values()),
            *([point.status] if status else []),
        )
        for k, point in enumerate(found.points)
    )
    made = table((*heads, *(f"Ω {stage}" for stage in stages), *status), rows, words=status)
    for column in made.columns[: len(heads)]:
        # A long key is folded, and its figures stay whole.
        column.no_wrap, column.min_width = False, 9
    return made


class Kind(NamedTuple):
    """How the answer of a kind of study is printed, and what its files hold.

    Attributes
    ----------
    show, table : callable
        Print the answer; return its table.
    about : callable
        Returns what the JSON file says before the rows of the table.
    """

    show: Callable[[Any], None]
    table: Callable[[Any], pd.DataFrame]
    about: Callable[[Any], dict[str, object]] = lambda _: {}


KINDS = {
    "compare": Kind(
        show_comparison,
        lambda found: found.to_frame(),
        lambda found: {"chi_square": found.chi_square},
    ),
    "critical": Kind(show_critical, lambda found: found.to_dataframe(), _about_critical),
    "fit": Kind(show_fit, _unknowns, lambda found: {"chi_square": found.comparison.chi_square}),
    "march": Kind(
        show_march,
        lambda found: found.to_dataframe(),
        lambda found: {"refused": found.refused} if found.refused else {},
    ),
    # Tables hold the derivatives of torques.
    "sensitivity": Kind(
        show_sensitivity, lambda found: found.dataset["torque"].to_dataframe().reset_index()
    ),
    "sweep": Kind(
        show_sweep,
        lambda found: found.to_frame(),
        lambda found: {"case": found.case, "passed": found.passed},
    ),
    "tolerance": Kind(show_tolerance, lambda found: found.to_frame()),
}


def makers_of(kind: str, found: Any) -> Makers:
    """Return the functions that make files of an answer: of its table, arrays and picture."""
    _, table_of, about = KINDS[kind]
    made = {**tables_of(kind, lambda: table_of(found), **about(found)), **figure_of(found.plot)}
    if hasattr(type(found), "dataset"):
        made["nc"] = lambda: netcdf_of(found.dataset)
    if kind == "fit":
        from loadshare.tooth import written_in

        made["toml"] = lambda: written_in(found.case).to_toml()
    if kind == "tolerance":
        made["json"] = lambda: json_text(statistics_document(found))
    return made
