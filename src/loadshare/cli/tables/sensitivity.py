"""How load sharing changes with every input, and how accurately that is known."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from loadshare.cli.console import say, say_all
from loadshare.cli.tables.table import show, table
from loadshare.report.numbers import counted

if TYPE_CHECKING:
    from loadshare.study.sensitivity import Input, Sensitivity

SHOWN = 25
"""Number of inputs that are shown; a file holds all."""
SIDES = ("falling", "rising")
DIGITS = 4
"""Digits that are shown of a derivative that is known to more."""
ALIKE = 1e-6
"""Relative difference of the derivatives to both sides that is not worth showing."""
ROUND_OFF = 1e-13
"""Change of Ω, over a unit and over the whole value of an input, that counts as zero."""


def show_sensitivity(found: Sensitivity) -> None:
    """Print which inputs change the system's Ω most, per unit and over their whole value."""
    ordered = sorted(found.inputs, key=lambda item: -_whole(found, item))[:SHOWN]
    one_sided = {item.key for item in ordered if _apart(found, item)}
    sides = ("dΩ per unit", *(["falling"] if one_sided else []))
    rows = []
    for item in ordered:
        falling, rising = (_figure(found, item, side) for side in SIDES)
        steepest = max((falling, rising), key=lambda figure: _size(figure[0]))
        over = abs(item.value.number)
        whole = abs(steepest[0]) * over, steepest[1] * over
        figures = [rising, *([falling] if one_sided else []), whole]
        if all(not _size(v) >= ROUND_OFF for v, _ in (falling, rising, whole)):
            figures = [(0.0, 0.0)] * len(figures)
        texts = [good(*figure) for figure in figures]
        if one_sided and item.key not in one_sided:
            texts[1] = ""
        value = f"{item.value.number:.6g} {item.value.unit}".strip()
        rows.append((item.key, value, *texts))
    heads = ("input", "value", *sides, "dΩ over its value")
    show("Sensitivity of the system's Ω, by group mean", table(heads, rows, words=heads[:2]))
    say("Every figure is accurate to one unit of its last digit.")
    if len(found.inputs) > SHOWN:
        say(f"Not shown: {counted(len(found.inputs) - SHOWN, 'input')} of less effect.")
    if one_sided:
        say("A value under falling means that the derivative to that side differs.")
    say_all(
        f"Position {kink.position} is on the verge of another active set: "
        f"{', '.join(kink.elements)}. Each of its derivatives holds to one side only."
        for kink in found.kinks
    )
    say_all(_remarks(found, {item.key for item in ordered}), whole=True)
    say_all((f"Left out: {key}: {why}." for key, why in found.skipped), whole=True)


def _figure(found: Sensitivity, item: Input, side: str) -> tuple[float, float]:
    """Return the derivative of the system's Ω per unit of an input, and its stated error."""
    of = item.key, side
    rate, error = found.pair_omega[of]["system"], found.pair_omega_error[of]["system"]
    return rate * item.value.factor, error * item.value.factor


def _size(value: float) -> float:
    return 0.0 if math.isnan(value) else abs(value)


def _remarks(found: Sensitivity, keys: set[str]) -> list[str]:
    """Return the remarks on some inputs, each with all its positions."""
    positions: dict[tuple[str, str], list[int]] = {}
    for remark in found.remarks:
        if remark.key in keys:
            positions.setdefault((remark.key, remark.message), []).append(remark.position)
    lines = []
    for (key, message), at in positions.items():
        known = sorted(set(at))
        where = "" if len(known) == len(found.positions) else f" at {', '.join(map(str, known))}"
        lines.append(f"{key}{where}: {message}.")
    return lines


def _apart(found: Sensitivity, item: Input) -> bool:
    """Return whether the derivatives to both sides differ, or there is one only."""
    (falling, low), (rising, high) = (_figure(found, item, side) for side in SIDES)
    if math.isnan(falling) or math.isnan(rising):
        return not (math.isnan(falling) and math.isnan(rising))
    return abs(falling - rising) > low + high + ALIKE * max(abs(falling), abs(rising))


def _whole(found: Sensitivity, item: Input) -> float:
    """Return the change of Ω over an input's whole value, to first order; 0 where it has none."""
    rates = [_figure(found, item, side)[0] for side in SIDES]
    return max(_size(rate * item.value.number) for rate in rates)


def good(value: float, error: float) -> str:
    """Return a figure with as many digits, four at most, as are good to one unit of the last.

    Rounding takes half a unit; the error must not take more than the other half.
    """
    if math.isnan(value):
        return "–"
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
