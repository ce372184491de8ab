"""A chapter of the page: one figure of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from loadshare.report.figure import Figure


@dataclass(frozen=True)
class Chapter:
    """The text of the page on one figure of the paper.

    Attributes
    ----------
    title : str
        "Fig. 8: installation errors, one gear at a time".
    verdict : str
        One line for the summary: what agrees and what does not.
    standing : str
        "fitted" or "predicted", or both in words.
    blocks : tuple of str
        Markdown; ``{picture}`` stands for the picture of that name.
    pictures : mapping of name to Figure
    """

    title: str
    verdict: str
    standing: str
    blocks: tuple[str, ...]
    pictures: Mapping[str, Figure] = field(default_factory=dict)
