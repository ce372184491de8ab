"""The JSON form of a result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass
from math import isfinite, isinf
from typing import TYPE_CHECKING, Any

from loadshare.json_text import json_text
from loadshare.output import netcdf_of
from loadshare.results.digest import DIGEST, digest_of, sealed
from loadshare.results.laws import law_lines

if TYPE_CHECKING:
    from loadshare.certify import Certificate
    from loadshare.results.result import Position, Result

FORMAT = 5
"""Format of the files that are written; it changes when the content of a file changes."""
OLDER = {4: ("elastic",)}
"""Older formats that are also read, with the keys that their positions lack."""
_FIELDS = (
    "position",
    "torque",
    "coast_torque",
    "mesh_position",
    "share",
    "pair_share",
    "rotation",
    "displacement",
    "floats",
    "undetermined",
    "effort",
    "claim",
)
"""Attributes of a position that are written as they are; others are written in more detail."""

_LOADS = ("meshes", "shafts", "gears", "bearings")
_ELASTIC = (
    "transmission_error",
    "torsional_stiffness",
    "mesh_transmission_error",
    "mesh_stiffness",
    "mesh_torsional_stiffness",
)


def to_document(result: Result, form: int = FORMAT) -> dict[str, Any]:
    """Return the result as plain data: the documented JSON form, self-contained, with a digest.

    Parameters
    ----------
    result : Result
    form : int
        A format that is read.
    """
    lacking = OLDER.get(form, ())
    document = {
        "format": form,
        "case": result.stamp.case,
        "version": result.stamp.version,
        "stamp": as_data(result.stamp),
        "input": result.solved.to_dict(),
        "frames": as_data(result.frames),
        "stages": as_data(result.stages),
        "positions": [
            {key: value for key, value in _position_document(p).items() if key not in lacking}
            for p in result.positions
        ],
        "omega": dict(result.omega),
        "pair_omega": dict(result.pair_omega),
    }
    if law_lines(result.laws):
        document["laws"] = as_data(result.laws)
    return document | {DIGEST: digest_of(document)}


DOCUMENT = "loadshare_result"
"""Attribute of a netCDF file that holds the whole result."""


def netcdf_content(result: Result) -> bytes:
    """Return a netCDF file: arrays for any reader, and the whole result as an attribute."""
    text = json_text(to_document(result))
    return sealed(netcdf_of(result.dataset.assign_attrs({DOCUMENT: text})))


def as_data(given: Any) -> Any:
    """Return dataclasses, mappings and tuples as data for JSON; infinite numbers become null."""
    if isinstance(given, float):
        return None if isinf(given) else given
    if given is None or isinstance(given, str | int):
        return given
    # Most are numbers, and a call takes longer than checking one.
    if isinstance(given, list | tuple):
        return [v if type(v) is float and isfinite(v) else as_data(v) for v in given]
    if isinstance(given, Mapping):
        return {
            key: v if type(v) is float and isfinite(v) else as_data(v) for key, v in given.items()
        }
    if is_dataclass(given):
        return {name: as_data(getattr(given, name)) for name in given.__dataclass_fields__}
    return given


def _position_document(p: Position) -> dict[str, Any]:
    """Return the document of a position, in which the certificate is split into parts."""
    document = {name: as_data(getattr(p, name)) for name in _FIELDS}
    document["validity"] = {"verdict": p.validity.verdict} | as_data(p.validity)
    document["uniqueness"] = as_data(p.uniqueness) | {"told": p.uniqueness.text}
    document["loads"] = {name: as_data(getattr(p.loads, name)) for name in _LOADS}
    document["elastic"] = {name: as_data(getattr(p.elastic, name)) for name in _ELASTIC}
    return document | _judged(p.certificate)


def _judged(certificate: Certificate) -> dict[str, Any]:
    verdict: dict[str, Any] = {"passed": certificate.passed}
    verdict |= {name: r.scaled for name, r in certificate.residuals.items()}
    scales = {name: getattr(certificate, name) for name in ("load", "deflection", "tolerance")}
    verdict["bound"] = as_data(certificate.bound)
    residuals = as_data(certificate.residuals)
    return {"certificate": verdict, "residuals": residuals, "scales": scales}
