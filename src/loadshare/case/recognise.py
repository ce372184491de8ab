"""What a file is that was given in place of another, by its beginning and not by its name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from loadshare.case.words import did_you_mean

TAKEN_BY = {
    "result": "is a result and no case; `loadshare check` certifies it again",
    "netCDF": "is netCDF and no case; if it is a result, `loadshare check` certifies it again",
    "study": "is the answer of a study and no case; pandas reads its rows",
    "REXS": "is a gear unit in REXS; `loadshare import` makes a case of it",
    "REXS archive or workbook": "is a workbook or an archive; `loadshare import` makes a case of "
    "the tables or the gear unit in it",
    "tables": "is a folder of tables; `loadshare import` makes a case of them",
    "table": "is a table and no case; `loadshare import` takes the folder of all tables of a case",
    "cases": "is a folder; name a case in it, or give it to `loadshare batch`, `check` or `report`",
    "picture": "is a picture and no case",
    "page": "is a page and no case",
    "JSON": "is JSON and no case, which is TOML",
    "nothing": "is empty; `loadshare new NAME` writes a case to start from",
    "UTF-16": "is UTF-16 text; save it as UTF-8",
    "case": "is a case; `loadshare run` solves it",
}
"""What a file is, and which command takes it."""
KINDS = {
    "helicoid": "is a pair of gears; `loadshare ltca` analyses it, and a mesh names it by geometry",
    "face-gear": "is a pair with a face gear; `loadshare ltca` analyses it, and a mesh names it by "
    "geometry",
    "law": "is the law of a mesh, which names it by law_file",
}
"""TOML files that are no cases, by what they say of themselves."""
_STARTS = (
    (b"\x89HDF", "netCDF"),
    (b"PK\x03\x04", "REXS archive or workbook"),
    (b"\x89PNG", "picture"),
    (b"%PDF", "picture"),
    (b"PAR1", "table"),
    (b"\xff\xfe", "UTF-16"),
    (b"\xfe\xff", "UTF-16"),
    (b"<svg", "picture"),
    (b"<!doctype", "page"),
    (b"<html", "page"),
)
_REXS = re.compile(rb'<model|"relations"')
_HEAD = 4096
"""Bytes at the beginning of a file by which it is known."""
_FEW = 64
"""Bytes at the beginning of a text in which letters of other scripts are rare."""
CASE = ("operating", "gears", "meshes")
"""Sections one of which at least every case has, or inherits."""


def what_is(content: bytes, name: str = "") -> str | None:
    """Return what a file is that is no TOML, and which command takes it.

    Parameters
    ----------
    content : bytes
        What it holds.
    name : str
        Its name, for a table, which has no beginning of its own.

    Returns
    -------
    str or None
        None for what may be TOML.
    """
    if _is_utf16(content[:_HEAD]):
        return TAKEN_BY["UTF-16"]
    head = content[:_HEAD].lstrip(b"\xef\xbb\xbf \t\r\n")
    if not head:
        return TAKEN_BY["nothing"]
    for start, kind in _STARTS:
        if head[: len(start)].lower() == start.lower():
            return TAKEN_BY[kind]
    if head[:1] in b"{<" and _REXS.search(content):
        return TAKEN_BY["REXS"]
    if head[:1] == b"{":
        known = (b'"question"', "study"), (b'"positions"', "result")
        return TAKEN_BY[next((kind for word, kind in known if word in content), "JSON")]
    if name.endswith(".csv"):
        return TAKEN_BY["table"]
    return None


def _is_utf16(head: bytes) -> bool:
    """Whether every other byte of a text is zero: UTF-16, of which not all programs put a mark."""
    even, odd = head[0:_FEW:2], head[1:_FEW:2]
    return bool(odd) and any(
        all(one) and not any(other) for one, other in ((even, odd), (odd, even))
    )


def what_folder_is(folder: Path) -> str:
    """Return what a folder holds, and which command takes it."""
    held = {file.suffix for file in folder.iterdir()}
    kind = "tables" if ".csv" in held and ".toml" not in held else "cases"
    return TAKEN_BY[kind]


def near_names(path: Path) -> str:
    """Return a sentence that proposes a file next to one that is not there, or nothing."""
    try:
        files = [file for file in path.parent.iterdir() if file.suffix == path.suffix]
        # A link that leads nowhere has the very name.
        names = [file.name for file in files if file.name != path.name]
    except OSError:
        return ""
    return did_you_mean(path.name, names)


def is_case(data: Mapping[str, Any]) -> bool:
    """Tell whether TOML says, or inherits, anything that only a case does."""
    return "extends" in data or all(section in data for section in CASE)
