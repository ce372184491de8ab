"""Results to disk, written whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from loadshare.json_text import json_text
from loadshare.output import netcdf_of, write_whole
from loadshare.results.digest import sealed
from loadshare.results.document import to_document

if TYPE_CHECKING:
    from loadshare.results.result import Result

DOCUMENT = "loadshare_result"
"""Attribute of a netCDF file that holds the whole result."""


def write_json(result: Result, path: str | Path | None = None) -> str:
    """Return the JSON text of a result, and write it to `path` if given."""
    text = text_of(result)
    if path is not None:
        write_whole(Path(path), text)
    return text


def text_of(result: Result) -> str:
    """Return the JSON text of a result."""
    return json_text(to_document(result))


def write_netcdf(result: Result, path: str | Path) -> None:
    """Write labelled arrays for any reader of netCDF, and the whole result as an attribute."""
    write_whole(Path(path), netcdf_content(result))


def netcdf_content(result: Result) -> bytes:
    """Return the content of a netCDF file of a result."""
    arrays = result.dataset.assign_attrs({DOCUMENT: text_of(result)})
    return sealed(netcdf_of(arrays))
