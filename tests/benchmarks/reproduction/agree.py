"""Comparison of two texts; numbers agree to within one unit of the last digit shown."""

from __future__ import annotations

import re
from pathlib import Path

NUMBER = re.compile(r"\d+(?:\.\d+)?")
PAGE = Path(__file__).parents[3] / "docs" / "reproduction.md"


def disagreement(fresh: str, kept: str, least: float = 0.0) -> str:
    """Return the first difference between two texts; empty if they agree.

    Parameters
    ----------
    fresh, kept : str
    least : float
        Difference of two numbers that does not count, if it is more than the last digit.
    """
    if NUMBER.split(fresh) != NUMBER.split(kept):
        pairs = zip(NUMBER.split(fresh), NUMBER.split(kept), strict=False)
        return next((f"{a!r} is now, {b!r} was" for a, b in pairs if a != b), "one is longer")
    for a, b in zip(NUMBER.findall(fresh), NUMBER.findall(kept), strict=True):
        # Rounding may go either way, but no further.
        digit = 10.0 ** -len(b.partition(".")[2]) if "." in b else 1.0 * (a != b)
        if abs(float(a) - float(b)) > max(1.001 * digit, least):
            return f"{a} is now, {b} was"
    return ""


def section(title: str) -> str:
    """Return the committed page's chapter, without its pictures."""
    text = PAGE.read_text(encoding="utf-8")
    _, found, rest = text.partition(f"## {title}\n\n")
    assert found, f"the committed page has no chapter {title!r}: make reproduce"
    blocks = rest.partition("\n\n## ")[0].split("\n\n")
    return "\n\n".join(b for b in blocks if not b.startswith("!["))
