"""Presentation of the answers of studies: functions that print each kind and make its files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, NamedTuple

from loadshare._version import __version__
from loadshare.cli.console import say, say_all
from loadshare.cli.forms import Makers, figure_of, tables_of
from loadshare.cli.tables.table import show_view
from loadshare.json_text import json_text
from loadshare.libraries import pd
from loadshare.numbers import counted
from loadshare.output import netcdf_of

if TYPE_CHECKING:
    from loadshare.study.critical import Critical
    from loadshare.study.fit import Fit
    from loadshare.study.march import March
    from loadshare.study.tolerance.result import Tolerance

SHOWN = 20
"""Number of reasons of refusals that are shown."""


def show_fit(found: Fit) -> None:
    """Print the fitted values with their uncertainties, and the comparison that they give."""
    show_view(found)
    say_all(f"WARNING  {warning}" for warning in found.warnings)


def show_march(found: March) -> None:
    """Print load sharing over the march, and what every spline did."""
    from loadshare.cli.tables.result import print_result

    print_result(found.result, len(found.result.stamp.positions))
    show_view(found)
    if not found.slips or not found.slips[0]:
        say("\nNo gear is on a spline, so no slip carries over from step to step.")


def show_tolerance(found: Tolerance) -> None:
    """Print how Ω scatters, which inputs that comes from, the worst case, and what was refused."""
    view = found._view()
    say(f"{view.title}: {dict(view.facts)['samples']}")
    show_view(found)
    refusals = list(found.messages.items())[:SHOWN]
    say_all(f"REFUSED  {count}×  {text}" for text, count in refusals)
    if found.design_refused:
        refused = counted(found.design_refused, "sample")
        say(f"WARNING  {refused} refused for the shares of variance; their rows are left out")


def _about_critical(found: Critical) -> dict[str, object]:
    unproved = [{"position": u.position, "from": u.start, "to": u.stop} for u in found.unproved]
    about = {"parameter": found.parameter.name, "unit": found.parameter.unit}
    return {**about, "unproved": unproved}


def _unknowns(found: Fit) -> pd.DataFrame:
    rows = [
        (u.parameter.name, u.parameter.unit, u.start, u.value, u.deviation, u.low, u.high)
        for u in found.unknowns
    ]
    heads = ["unknown", "unit", "start", "fitted", "deviation", "low", "high"]
    return pd.DataFrame(rows, columns=heads)


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
        show_view,
        lambda found: found.to_dataframe(),
        lambda found: {"chi_square": found.chi_square},
    ),
    "critical": Kind(show_view, lambda found: found.to_dataframe(), _about_critical),
    "fit": Kind(show_fit, _unknowns, lambda found: {"chi_square": found.comparison.chi_square}),
    "march": Kind(
        show_march,
        lambda found: found.to_dataframe(),
        lambda found: {"refused": found.refused} if found.refused else {},
    ),
    # Tables hold the derivatives of torques.
    "sensitivity": Kind(
        show_view, lambda found: found.dataset["torque"].to_dataframe().reset_index()
    ),
    "sweep": Kind(
        show_view,
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
