"""A printed figure next to the computed one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from loadshare.numbers import NONE, fixed


@dataclass(frozen=True, slots=True)
class Entry:
    """One figure of the paper.

    Attributes
    ----------
    quantity : str
        With its unit.
    printed : float or None
        None if the paper prints none.
    computed : float
    places : int
        Decimals shown.
    kind : str
        "fitted" (the computed figure was made to agree) or "predicted".
    """

    quantity: str
    printed: float | None
    computed: float
    places: int
    kind: str = "predicted"

    @property
    def difference(self) -> float | None:
        """Computed minus printed value."""
        return None if self.printed is None else self.computed - self.printed

    @property
    def relative(self) -> float | None:
        """The difference divided by the printed figure."""
        return None if self.printed is None else self.computed / self.printed - 1.0


def entries_table(entries: Sequence[Entry]) -> str:
    """Return the entries as a Markdown table."""
    rows = [
        (
            e.quantity,
            minus(fixed(e.printed, e.places)),
            minus(fixed(e.computed, e.places)),
            signed(e.difference, e.places),
            NONE if e.relative is None else f"{signed(100 * e.relative, 1)} %",
            e.kind,
        )
        for e in entries
    ]
    return table(("quantity", "paper", "computed", "difference", "in %", ""), rows)


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = ["| " + " | ".join(header) + " |", "|---" * len(header) + "|"]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def signed(value: float | None, places: int) -> str:
    """Return a value with its sign, a true minus sign, and no sign for zero."""
    if value is None:
        return NONE
    text = fixed(value, places)
    if float(text) == 0.0:
        return text
    return f"+{text}" if value > 0 else f"−{text.removeprefix('-')}"


def minus(text: str) -> str:
    """Return a number with a true minus sign."""
    return text.replace("-", "−")


def point(place: tuple[float, float], places: int) -> str:
    """Return a point of the plane."""
    return minus(f"({fixed(place[0], places)}, {fixed(place[1], places)})")


def listed(words: Sequence[str]) -> str:
    """Return words as a list in a sentence."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
