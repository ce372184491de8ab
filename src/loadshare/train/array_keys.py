"""Which keys of a case become arrays when they vary from sample to sample.

Such a key moves right-hand sides, bounds or compliances (errors, loads, clearances, gaps,
stiffnesses of what is elastic anyway). Any other key decides which elements there are, or where
they push, and changes the machine itself.
"""

from __future__ import annotations

from loadshare import case as spec
from loadshare.case.checks.meshing import turning_is_given
from loadshare.train.columns import Column

_LENGTH = "m"
_SPLINE = {
    "bending_stiffness": "N/m",
    "stick_limit": _LENGTH,
    "clearance": _LENGTH,
    "friction_force": "N",
    "friction": "",
    "normal_force": "N",
}
_BEARING = {
    "stiffness": "N/m",
    "ball_stiffness": "N/m^1.5",
    "roller_stiffness": "N/m^(10/9)",
}
_MESH = {
    ("stiffness",): "N*m/rad",
    ("gap",): "rad",
    ("law", "a"): "rad",
    ("law", "b"): "rad/(N*m)",
    ("law", "c"): "rad/(N*m)^(2/3)",
    ("backlash",): _LENGTH,
    ("normal_backlash",): _LENGTH,
}


def array_unit(case: spec.Case, column: Column) -> str | None:
    """SI unit of a key that becomes an array; None if it changes the machine.

    Parameters
    ----------
    case : Case
        With a value for every key that varies.
    column : Column
        Loads may press other flanks than those of the case: see `pressed_flanks`.
    """
    match column.path:
        case ("operating", "external", _):
            return "N*m"
        case ("operating", "forces", _, int()):
            return "N"
        case ("operating", "gravity", int()):
            return "m/s^2"
        case ("operating", "torque" | "power" as what):
            return {"torque": "N*m", "power": "W"}[what]
        case ("errors", gear, "installation", "amount" | "direction" as what):
            polar = isinstance(case.errors[str(gear)].installation, spec.Offset)
            return (_LENGTH if what == "amount" else "rad") if polar else None
        case ("errors", _, "pin", "angular"):
            return "rad"
        case ("errors", _, "installation", int()) | ("errors", _, "pin", _):
            return _LENGTH
        case ("errors", _, "eccentricity", "amount"):
            # Where it is not known how far gears turn, only an eccentricity of 0 has an answer.
            return _LENGTH if turning_is_given(case.operating, case.march, case.gears) else None
        case ("errors", _, "eccentricity", "direction" | "phase"):
            return "rad"
        case ("rings", gear, "float") | ("rings", gear, "float", "up" | "down"):
            derived = isinstance(case.rings[str(gear)].float_, spec.Backlashes)
            return None if derived else _LENGTH
        case ("rings" | "bearings", _, "clearance", *_) | ("rings", _, "radius"):
            return _LENGTH
        case ("bearings", bearing, key) if key in _BEARING:
            words = isinstance(case.bearings[str(bearing)].stiffness, str)
            return _BEARING[str(key)] if column.is_positive and not words else None
        case ("splines", _, key):
            return _SPLINE.get(str(key))
        case ("meshes", mesh, *tail):
            return _mesh_unit(case, str(mesh), tuple(map(str, tail)), column)
        case ("shafts", shaft, "stiffness"):
            words = isinstance(case.shafts[str(shaft)].stiffness, str)
            return "N*m/rad" if column.has_numbers and not words else None
        case ("shafts", shaft, "clocking"):
            return None if isinstance(case.shafts[str(shaft)].stiffness, str) else "rad"
        case ("gears", gear, "support"):
            words = isinstance(case.gears[str(gear)].support, str)
            return "N/m" if column.is_positive and not words else None
    return None


def _mesh_unit(case: spec.Case, mesh: str, tail: tuple[str, ...], column: Column) -> str | None:
    """Unit of a mesh's key; None where it decides which elements there are."""
    unit = _MESH.get(tail)
    if tail[0] in ("backlash", "normal_backlash"):
        derived = any(isinstance(r.float_, spec.Backlashes) for r in case.rings.values())
        return None if derived else unit
    if tail == ("law", "c") and column.has_numbers:
        # Without a Hertz part the law is linear: a set of its own.
        return unit if column.is_positive else None
    if tail == ("law", "a") and case.meshes[mesh].gap is not None:
        return None
    return unit
