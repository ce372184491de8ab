"""How large displacements are for the geometry in which they were found."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from loadshare.certify.validity import TOLD
from loadshare.cli.tables.table import show, table
from loadshare.report.numbers import NONE, significant
from loadshare.report.page.validity import advice
from loadshare.results import Result


def print_validity(console: Console, result: Result) -> None:
    """Print the largest figures over the positions, their bounds, and a warning above one.

    Parameters
    ----------
    console : Console
    result : Result
    """
    many = len(result.positions) > 1
    made = table(
        ("figure", "value", "warning", "refusal", "where", *(("position",) if many else ())),
        words=("figure", "where"),
    )
    for name, m, position in result.validity:
        bounds = [NONE if b is None else significant(b, 3) for b in (m.warning, m.refusal)]
        nowhere = m.value == 0.0
        made.add_row(
            TOLD[name],
            significant(m.value, 3) if m.value >= 1e-4 or nowhere else f"{m.value:.1e}",
            *bounds,
            NONE if nowhere else m.where,
            *((NONE if nowhere else str(position),) if many else ()),
        )
    show(console, "Displacements: the largest, and the bounds of the geometry", made)
    told = advice(result)
    if told:
        console.print(Text.assemble(("WARNING", "bold yellow"), f"  {told}"))
