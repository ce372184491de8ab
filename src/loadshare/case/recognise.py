"""Recognition of files given in place of a case, by their content rather than their name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from loadshare.case.words import did_you_mean

TAKEN_BY = {
    "result": "is a result, not a case; `loadshare check` certifies it again",
    "netCDF": "is netCDF, not a case; if it is a result, `loadshare check` certifies it again",
    "study": "is the answer of a study, not a case; pandas reads its rows",
    "REXS": "is a gear unit in REXS; `loadshare import` makes a case of it",
    "REXS archive or workbook": "is a workbook or an archive; `loadshare import` makes a case of "
    "the tables or the gear unit in it",
    "tables": "is a folder of tables; `loadshare import` makes a case of them",
    "table": "is a table, not a case; `loadshare import` takes the folder of all tables of a case",
    "cases": "is a folder; name a case in it, or give it to `loadshare batch`, `check` or `report`",
    "picture": "is a picture, not a case",
    "page": "is a page, not a case",
    "JSON": "is JSON, but a case is TOML",
    "nothing": "is empty; `loadshare new NAME` writes a case to start from",
    "UTF-16": "is UTF-16 text; save it as UTF-8",
    "case": "is a case; `loadshare run` solves it",
}
"""What a file is, and which command takes it."""
OTHER_FILES = {
    "helicoid": "is a pair of gears; `loadshare ltca` analyses it, and a mesh names it under its "
    "key geometry",
    "face-gear": "is a pair with a face gear; `loadshare ltca` analyses it, and a mesh names it "
    "under its key geometry",
    "law": "is the law of a mesh, which names it under its key law_file",
}
"""TOML files that are not cases, by their key `kind`."""
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
"""Number of bytes at the beginning of a file by which it is recognised."""
_FEW = 64
"""Number of bytes at the beginning of a text where letters of other scripts are rare."""
CASE = ("operating", "gears", "meshes")
"""Sections that every case has or inherits."""


def what_is(content: bytes, name: str = "") -> str | None:
    """Return what a file is that is not TOML, and which command takes it.

    Parameters
    ----------
    content : bytes
        Its bytes.
    name : str
        Its name, needed for a CSV table, which has no typical beginning.

    Returns
    -------
    str or None
        None if it may be TOML.
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
    """Return whether every other byte is zero, as in UTF-16 without a byte order mark."""
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
    """Return a hint at a file in the same folder with a similar name, or an empty text."""
    try:
        files = [file for file in path.parent.iterdir() if file.suffix == path.suffix]
        # A broken link has the very same name.
        names = [file.name for file in files if file.name != path.name]
    except OSError:
        return ""
    return did_you_mean(path.name, names)


def is_case(data: Mapping[str, Any]) -> bool:
    """Tell whether TOML data are a case: they extend another, or hold all sections of `CASE`."""
    return "extends" in data or all(section in data for section in CASE)
