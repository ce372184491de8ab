"""`loadshare sensitivity`: how load sharing changes with every input."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import console
from loadshare.cli.study.common import (
    CaseFile,
    Changes,
    Positions,
    TableFile,
    asked,
    write_table,
)

if TYPE_CHECKING:
    from rich.console import Console

    from loadshare.study.sensitivity import Input, Sensitivity

SHOWN = 25
"""Inputs that are shown; a file holds all."""
SIDES = ("falling", "rising")
ROUND_OFF = 1e-13
"""Change of Ω over a unit and over the whole value of an input that says nothing."""


def sensitivity(
    case: CaseFile,
    key: Annotated[
        list[str] | None,
        typer.Argument(metavar="KEY", help="Inputs; a star stands for any name. All by default."),
    ] = None,
    file: TableFile = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Tell how torques, Ω and floats change with inputs of a case."""
    from loadshare.study.sensitivity import sensitivity as differentiated

    with asked(case, change, "inputs") as (loaded, tick):
        found = differentiated(loaded, key or None, positions=position, progress=tick)
    show_sensitivity(console(), found)
    if file is not None:
        arrays = found.dataset
        write_table(file, arrays["torque"].to_dataframe().reset_index(), arrays)


def show_sensitivity(screen: Console, found: Sensitivity) -> None:
    """Print what moves the system's Ω most, per unit of each input and over its whole value."""
    from loadshare.cli.tables.table import show, table

    ordered = sorted(found.inputs, key=lambda item: -_whole(found, item))
    one_sided = {item.key for item in ordered[:SHOWN] if _apart(found, item)}
    sides = ("dΩ per unit", *(["falling"] if one_sided else []))
    made = table(("input", "value", *sides, "dΩ over its value"), words=("input", "value"))
    for item in ordered[:SHOWN]:
        slopes = [found.pair_omega[item.key, s]["system"] * item.value.factor for s in SIDES]
        changes = [*slopes, _whole(found, item)]
        if all(abs(change) < ROUND_OFF for change in changes):
            changes = [0.0, 0.0, 0.0]
        falling, rising, whole = map(_signed, changes)
        below = [falling if item.key in one_sided else ""] if one_sided else []
        value = f"{item.value.number:.6g} {item.value.unit}".strip()
        made.add_row(item.key, value, rising, *below, whole)
    show(screen, "Sensitivity of the system's Ω, by group mean", made)
    if len(ordered) > SHOWN:
        screen.print(f"{len(ordered) - SHOWN} inputs that matter less are not shown.")
    if one_sided:
        screen.print("Where a value stands under falling, the derivative differs to that side.")
    for kink in found.kinks:
        screen.print(
            f"Position {kink.position} stands on the verge of another active set: "
            f"{', '.join(kink.elements)}. Its derivatives hold to one side each."
        )
    for key, why in found.skipped:
        screen.print(f"Left out: {key}: {why}.", soft_wrap=True)


def _apart(found: Sensitivity, item: Input) -> bool:
    """Whether the derivatives to both sides differ."""
    falling, rising = (found.pair_omega[item.key, s]["system"] for s in SIDES)
    return not math.isclose(falling, rising, rel_tol=1e-6, abs_tol=1e-300)


def _whole(found: Sensitivity, item: Input) -> float:
    """Change of Ω over the whole value of an input, to first order; 0 where it has none."""
    slopes = [found.pair_omega[item.key, s]["system"] for s in SIDES]
    sizes = [abs(s * item.value.si) for s in slopes if not math.isnan(s)]
    return max(sizes, default=0.0)


def _signed(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:+.4g}" if value else "0"
