"""The certificate of a result."""

from __future__ import annotations

import math

from rich.console import Console
from rich.text import Text

from loadshare.cli.exits import counted
from loadshare.cli.tables.table import show, table
from loadshare.report.numbers import NONE, small
from loadshare.results import Result


def print_certificate(console: Console, result: Result, wanted: int) -> None:
    """Print the worst value of every residual over the positions, and the verdict.

    Parameters
    ----------
    console : Console
    result : Result
        Of what was certified.
    wanted : int
        Number of positions that were asked for.
    """
    many = len(result.positions) > 1
    made = table(
        ("figure", "value", "unit", "scaled", "where", *(("position",) if many else ())),
        words=("figure", "unit", "where"),
    )
    for name in result.positions[0].certificate.residuals:
        worst = max(result.positions, key=lambda p: p.certificate.residuals[name].scaled)
        residual = worst.certificate.residuals[name]
        shown = (small(residual.value), residual.unit, small(residual.scaled))
        nowhere = residual.scaled == 0.0
        where = NONE if nowhere else residual.where or NONE
        at = NONE if nowhere else str(worst.position)
        made.add_row(name.replace("_", " "), *shown, where, *((at,) if many else ()))
    show(console, "Certificate: the worst residuals", made)
    proved = max(p.certificate.bound.relative for p in result.positions)
    none = "no bound of the torques is proved: they are in balance"
    console.print(
        none if math.isinf(proved) else f"torques proved to {small(proved)} of the largest"
    )
    console.print(_verdict(result, wanted))
    told = result.uniqueness.told
    console.print(f"{told[0].upper()}{told[1:]}.")


def _verdict(result: Result, wanted: int) -> Text:
    passed = result.passed and len(result.positions) == wanted
    word = ("PASSED", "bold green") if passed else ("REFUSED", "bold red")
    certified = sum(p.certificate.passed for p in result.positions)
    worst = result.certificate.worst
    return Text.assemble(
        word,
        f"  {certified} of {counted(wanted, 'position')} certified; "
        f"worst {small(worst)}, allowed {result.stamp.tolerance:.0e}",
    )
