"""What a sensitivity study shows: how load sharing changes with every input, and how surely."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from loadshare.numbers import NONE, counted
from loadshare.results.share import NO_STAGES
from loadshare.table import Table, text_table
from loadshare.view import View, listed

if TYPE_CHECKING:
    from loadshare.study.sensitivity.result import Input, Sensitivity

SHOWN = 25
"""Number of inputs that a screen shows; a file holds all."""
DIGITS = 4
"""Digits that are shown of a derivative that is known to more."""
ALIKE = 1e-6
"""Relative difference of the derivatives to both sides that is not worth showing."""
ROUND_OFF = 1e-13
"""Change of Ω, over a unit and over the whole value of an input, that counts as zero."""

Figure = tuple[float, float]
"""A figure and its stated error."""


class SideSlopes(NamedTuple):
    """Derivatives of Ω of the system per unit of an input, to both sides."""

    item: Input
    falling: Figure
    rising: Figure

    @property
    def whole(self) -> Figure:
        """Change of Ω over the input's whole value, to first order."""
        slope, error = max(self.rising, self.falling, key=lambda figure: _size(figure[0]))
        over = abs(self.item.value.number)
        return slope * over, error * over

    @property
    def is_kinked(self) -> bool:
        """Whether the derivatives to both sides differ, or there is one only."""
        (falling, low), (rising, high) = self.falling, self.rising
        if math.isnan(falling) or math.isnan(rising):
            return not (math.isnan(falling) and math.isnan(rising))
        return abs(falling - rising) > low + high + ALIKE * max(abs(falling), abs(rising))


def sensitivity_view(found: Sensitivity) -> View:
    """Show which inputs change Ω of the system most, per unit and over their whole value."""
    facts = (
        ("positions", listed(found.positions)),
        ("inputs", f"{len(found.inputs)}, {len(found.skipped)} left out"),
        ("on the verge", counted(len(found.kinks), "position") if found.kinks else ""),
        ("remarks", str(len(found.remarks)) if found.remarks else ""),
    )
    by_group, by_stage = (_ordered(found, over) for over in ("group", "stage"))
    tables = [_table("group", by_group), _table("stage", by_stage)]
    if tables[0].texts == tables[1].texts:
        tables = [_table("stage and group", by_group)]
    accurate = "Every figure is accurate to one unit of its last digit."
    tables[-1].notes.append(accurate if _has_stages(found) else NO_STAGES)
    if any(slopes.is_kinked for slopes in (*by_group[:SHOWN], *by_stage[:SHOWN])):
        note = "A value under falling means that the derivative to that side differs."
        tables[-1].notes.append(note)
    tables[-1].notes.extend(_notes(found, {slopes.item.key for slopes in by_group[:SHOWN]}))
    return View("Sensitivities of Ω of the system", facts, tuple(tables))


def _has_stages(found: Sensitivity) -> bool:
    return any(len(of_stages) > 1 for of_stages in found.omega.values())


def _ordered(found: Sensitivity, over: str) -> list[SideSlopes]:
    """Return the derivatives with respect to all inputs, by what their whole value changes."""
    rates, errors = (
        (found.pair_omega, found.pair_omega_error)
        if over == "group"
        else (found.omega, found.omega_error)
    )
    every = []
    for item in found.inputs:
        falling, rising = (
            (
                rates[item.key, side]["system"] * item.value.factor,
                errors[item.key, side]["system"] * item.value.factor,
            )
            for side in found.sides
        )
        every.append(SideSlopes(item, falling, rising))
    return sorted(every, key=lambda slopes: -_size(slopes.whole[0]))


def _table(over: str, ordered: list[SideSlopes]) -> Table:
    kinked = any(slopes.is_kinked for slopes in ordered[:SHOWN])
    rows = []
    for slopes in ordered:
        figures = [slopes.rising, *([slopes.falling] if kinked else []), slopes.whole]
        if not any(_size(v) >= ROUND_OFF for v, _ in (*slopes[1:], slopes.whole)):
            # What does not exist stays so.
            figures = [f if math.isnan(f[0]) else (0.0, 0.0) for f in figures]
        texts = [good(*figure) for figure in figures]
        if kinked and not slopes.is_kinked:
            texts[1] = ""
        value = slopes.item.value
        rows.append((slopes.item.key, f"{value.number:.6g} {value.unit}".strip(), *texts))
    sides = ("dΩ per unit", *(["falling"] if kinked else []))
    heads = ("input", "value", *sides, "dΩ over its value")
    made = text_table(f"Sensitivity of the system's Ω, by {over} mean", heads, rows, heads[:2])
    noun = "input" if len(rows) == SHOWN + 1 else "inputs"
    return replace(made, most=SHOWN, rest=f"Not shown: {{}} {noun} of less effect.")


def _notes(found: Sensitivity, shown: set[str]) -> Iterator[str]:
    """Yield what the derivatives of some inputs leave out, and which inputs have none."""
    for kink in found.kinks:
        yield (
            f"Position {kink.position} is on the verge of another active set: "
            f"{', '.join(kink.elements)}. Each of its derivatives holds to one side only."
        )
    positions: dict[tuple[str, str], set[int]] = {}
    for remark in found.remarks:
        if remark.key in shown:
            positions.setdefault((remark.key, remark.message), set()).add(remark.position)
    for (key, message), at in positions.items():
        everywhere = len(at) == len(found.positions)
        where = "" if everywhere else f" at {', '.join(map(str, sorted(at)))}"
        yield f"{key}{where}: {message}."
    yield from (f"Left out: {key}: {why}." for key, why in found.skipped)


def _size(value: float) -> float:
    return 0.0 if math.isnan(value) else abs(value)


def good(value: float, error: float) -> str:
    """Return a figure with as many digits, four at most, as are good to one unit of the last.

    Rounding takes half a unit; the error must not take more than the other half.
    """
    if math.isnan(value):
        return NONE
    if not value and not error:
        return "0"
    if not error < 0.05 * abs(value):
        digits = 1 if 2.0 * error <= 10.0 ** math.floor(math.log10(abs(value) or 1e-300)) else 0
        if not digits:
            return f"0 ± {_above(abs(value) + error)}"
        return f"{value:+.1g}"
    leading = math.floor(math.log10(abs(value)))
    digits = 1 + leading - math.ceil(math.log10(2.0 * error)) if error else DIGITS
    return f"{value:+.{min(max(digits, 1), DIGITS)}g}"


def _above(value: float) -> str:
    """Return a value as one digit, rounded up."""
    power = 10.0 ** math.floor(math.log10(value))
    return f"{math.ceil(value / power) * power:.1g}"
