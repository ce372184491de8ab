"""Patterns over key paths, as `assumed` uses them."""

from __future__ import annotations

from fnmatch import fnmatchcase

from loadshare.case.keys import Path


def covers(pattern: Path, path: Path) -> bool:
    """Tell whether a pattern names a key or a table above it.

    Parameters
    ----------
    pattern : tuple of str or int
        A key path in which a star stands for any part of one name.
    path : tuple of str or int
        The key.

    Returns
    -------
    bool
        Whether it does.
    """
    return len(pattern) <= len(path) and all(
        fnmatchcase(str(step), str(wanted)) for wanted, step in zip(pattern, path, strict=False)
    )
