"""A result file of its own for every case."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

SUMMARY = "summary"
"""Name that no case may take: the batch's own file bears it."""


def result_names(cases: Sequence[Path]) -> list[str]:
    """Return one name per case: that of its file, or its relative path if two are called alike.

    Parameters
    ----------
    cases : sequence of Path
        Different files.

    Returns
    -------
    list of str
        Different names, also on a file system that takes capitals for small letters.
    """
    absolute = [path.absolute() for path in cases]
    root = os.path.commonpath([path.parent for path in absolute]) if absolute else ""
    stems = Counter(path.stem.casefold() for path in cases)
    taken = {SUMMARY}
    names = []
    for path in absolute:
        name = path.stem
        if stems[name.casefold()] > 1:
            name = path.relative_to(root).with_suffix("").as_posix()
        while name.casefold() in taken:
            name += "_"
        taken.add(name.casefold())
        names.append(name)
    return names
