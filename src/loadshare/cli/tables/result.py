"""The whole report of a result."""

from __future__ import annotations

import math

from rich.text import Text

from loadshare.cli.console import say
from loadshare.cli.exits import counted
from loadshare.cli.refusal import ranges
from loadshare.cli.tables.floats import print_floats
from loadshare.cli.tables.sharing import print_sharing
from loadshare.cli.tables.table import show, texts
from loadshare.report import records
from loadshare.report.numbers import significant, small
from loadshare.report.table import Cell
from loadshare.report.validity import advice
from loadshare.results import Result

WORDS = ("figure", "unit", "where")


def print_result(result: Result, wanted: int) -> None:
    """Print load sharing, coefficients, floats, displacements and the certificate.

    Parameters
    ----------
    result : Result
        Of what was certified.
    wanted : int
        Number of positions that were asked for.
    """
    certified = [p.position for p in result.positions]
    if len(certified) < wanted:
        say(f"What follows holds for the certified positions only: {ranges(certified)}")
    print_sharing(result)
    print_omega(result)
    print_floats(result)
    print_validity(result)
    print_certificate(result, wanted)


def print_omega(result: Result) -> None:
    """Print the largest Ω of every stage and of the system, and where each is reached."""
    if not result.stages:
        say("\nNo stages are named, so there is no load-sharing coefficient.")
        return
    heads = ("stage", "over stage mean", "reached at", "over group mean", "at")
    made = texts(
        records.omegas(result),
        dict(
            zip(("stage", "over stage", "stage at", "over group", "group at"), heads, strict=True)
        ),
        words=("stage", "reached at", "at"),
    )
    made.columns[-1].header = "reached at"
    show("Load-sharing coefficient Ω: largest over branches and positions", made)


def print_validity(result: Result) -> None:
    """Print the largest figures over the positions, their bounds, and a warning above one."""
    rows = list(records.measures(result))
    for row in rows:
        value = row["value"].value or 0.0
        text = significant(value, 3) if value >= 1e-4 or value == 0.0 else f"{value:.1e}"
        row["value"] = Cell(text, value)
    made = texts(rows, _fields(result, "figure", "value", "warning", "refusal", "where"), WORDS)
    show("Displacements: the largest, and the bounds of the geometry", made)
    told = advice(result)
    if told:
        say(Text.assemble(("WARNING", "bold yellow"), f"  {told}"))


def print_certificate(result: Result, wanted: int) -> None:
    """Print the worst value of every residual over the positions, and the verdict."""
    fields = _fields(result, "figure", "value", "unit", "scaled", "where")
    show("Certificate: the worst residuals", texts(records.residuals(result), fields, WORDS))
    proved = max(p.certificate.bound.relative for p in result.positions)
    none = "no bound of the torques is proved: they are in balance"
    say(none if math.isinf(proved) else f"torques proved to {small(proved)} of the largest")
    passed = result.passed and len(result.positions) == wanted
    certified = sum(p.certificate.passed for p in result.positions)
    say(
        Text.assemble(
            ("PASSED", "bold green") if passed else ("REFUSED", "bold red"),
            f"  {certified} of {counted(wanted, 'position')} certified; worst "
            f"{small(result.certificate.worst)}, allowed {result.stamp.tolerance:.0e}",
        )
    )
    told = result.uniqueness.told
    say(f"{told[0].upper()}{told[1:]}.")


def _fields(result: Result, *fields: str) -> dict[str, str]:
    """Columns of these fields, and of the position where there are several."""
    many = ("position",) if len(result.positions) > 1 else ()
    return {field: field for field in (*fields, *many)}
