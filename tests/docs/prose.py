"""Numbers in the prose of the documentation, found and classified by their source.

A number may be *computed* (a rule of `figures.py` computes it), *printed elsewhere* (a case, a
paper, a standard: a pattern of `figures.py` with the reason), or part of something other than
prose: blocks and inline code, formulas, links, headings. Any other number is an error of the page.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

NUMBER = re.compile(r"(?<![\w.,⟦])[+−-]?\d+(?:[.,]\d+)*(?:e[-−+]?\d+)?(?![\w])")
SILENT = (
    re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL),
    re.compile(r"<!--.*?-->", re.DOTALL),
    re.compile(r"^\$\$.*?^\$\$$", re.MULTILINE | re.DOTALL),
    re.compile(r"\$[^$\n]+\$"),
    re.compile(r"`[^`\n]+`"),
    re.compile(r"\]\([^)\n]*\)"),
    re.compile(r"^#+ .*$", re.MULTILINE),
    re.compile(r"^:::.*$", re.MULTILINE),
    re.compile(r"^ *\d+\. ", re.MULTILINE),
)
"""Parts of a page that are not prose."""


@dataclass(frozen=True)
class Found:
    """A number of a page.

    Attributes
    ----------
    text : str
        As it is printed.
    start : int
    line : str
        The line that it is on.
    """

    text: str
    start: int
    line: str


def numbers(page: str) -> Iterator[Found]:
    """Yield the numbers in the prose and the tables of a page."""
    plain = page
    for pattern in SILENT:
        plain = pattern.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), plain)
    for match in NUMBER.finditer(plain):
        begin = page.rfind("\n", 0, match.start()) + 1
        end = page.find("\n", match.start())
        yield Found(match[0], match.start(), page[begin : end if end >= 0 else None])


def template(text: str) -> re.Pattern[str]:
    """Return the pattern of a text in which ``{}`` stands for a number; any white space matches."""
    parts = [r"\s+".join(map(re.escape, part.split(" "))) for part in text.split("{}")]
    return re.compile(r"([+−-]?\d+(?:\.\d+)?(?:e[-−+]?\d+)?)".join(parts))


def same(shown: str, computed: float) -> bool:
    """Return whether a computed number, rounded as on the page, is the one shown."""
    plain = shown.replace("−", "-")
    if "e" in plain:
        mantissa = plain.partition("e")[0]
        digits = len(mantissa.partition(".")[2])
        return float(f"{computed:.{digits}e}") == float(plain)
    decimals = len(plain.partition(".")[2])
    return float(f"{computed:.{decimals}f}") == float(plain)


def uncovered(page: str, spans: Iterable[tuple[int, int]]) -> list[str]:
    """Return the numbers that are in none of the spans, each with its line."""
    covered = list(spans)
    return [
        f"{found.text} in: {found.line.strip()}"
        for found in numbers(page)
        if not any(first <= found.start < last for first, last in covered)
    ]


def matches(rule: Any, page: str) -> list[re.Match[str]]:
    """Return all matches of a rule's text: in its section, or anywhere in the page."""
    first, last = 0, len(page)
    if rule.section:
        first = page.index(f"# {rule.section}\n")
        following = page.find("\n#", first + 1)
        last = following if following >= 0 else last
    return list(template(rule.text).finditer(page, first, last))
