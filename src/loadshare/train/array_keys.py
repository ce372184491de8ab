"""Which keys of a case become arrays when they vary from sample to sample.

Such a key changes only right-hand sides, bounds or compliances (errors, loads, clearances, gaps,
stiffnesses of elements that are elastic anyway). Any other key decides which elements there are or
in which directions they push, and so changes the machine itself.
"""

from __future__ import annotations

from loadshare import case as spec
from loadshare.case.checks.meshing import turning_is_given
from loadshare.case.counts import dimension_of
from loadshare.train.columns import Column

_OF_SPLINES = (
    *("bending_stiffness", "stick_limit", "clearance", "radius"),
    *("friction_force", "friction", "normal_force"),
)


def array_unit(case: spec.Case, column: Column) -> str | None:
    """Return the SI unit of a key that becomes an array; None if the key changes the machine.

    Parameters
    ----------
    case : Case
        It has a value for every key that varies.
    column : Column
        Its loads may press other flanks than those of the case: see `pressed_flanks`.
    """
    if not _becomes_array(case, column):
        return None
    dimension = dimension_of(column.path)
    return dimension.unit if dimension else ""


def _becomes_array(case: spec.Case, column: Column) -> bool:
    match column.path:
        case ("operating", "torque" | "power" | "speed") | ("operating", "external", _):
            return True
        case ("operating", "torque" | "power", int()):
            # Loads of both signs may press flanks that the first sample does not have.
            return column.is_positive
        case ("operating", "forces", _, int()) | ("operating", "gravity", int()):
            return True
        case ("errors", gear, "installation", "amount" | "direction"):
            return isinstance(case.errors[str(gear)].installation, spec.Offset)
        case ("errors", _, "installation", int()) | ("errors", _, "pin", _):
            return True
        case ("errors", _, "eccentricity", "amount"):
            # If it is not known how far gears turn, only an eccentricity of 0 has an answer.
            return turning_is_given(case.operating, case.march, case.gears)
        case ("errors", _, "eccentricity", "direction" | "phase"):
            return True
        case ("rings", gear, "float") | ("rings", gear, "float", "up" | "down"):
            return not isinstance(case.rings[str(gear)].float_, spec.Backlashes)
        case ("rings", _, "clearance") | ("rings", _, "clearance", int()) | ("rings", _, "radius"):
            return True
        case ("bearings", _, "clearance") | ("rings" | "bearings", _, "offset", int()):
            return True
        case ("rings", ring, "stiffness"):
            return column.is_positive and not isinstance(case.rings[str(ring)].stiffness, str)
        case ("bearings", bearing, "stiffness" | "ball_stiffness" | "roller_stiffness"):
            words = isinstance(case.bearings[str(bearing)].stiffness, str)
            return column.is_positive and not words
        case ("splines", _, key):
            return key in _OF_SPLINES
        case ("meshes", _, "stiffness" | "gap", *_) | ("meshes", _, "law", "b", *_):
            return True
        case ("meshes", mesh, "law", "a", *_):
            return case.meshes[str(mesh)].gap is None
        case ("meshes", _, "law", "c", *_):
            # Without a Hertz part the law is linear, and the machine another one.
            return column.is_positive or not column.has_numbers
        case ("meshes", _, "backlash" | "normal_backlash"):
            return column.has_numbers or "teeth" not in column.values
        case ("shafts", shaft, "stiffness"):
            words = isinstance(case.shafts[str(shaft)].stiffness, str)
            return column.has_numbers and not words
        case ("shafts", _, "clocking"):
            return True
        case ("shafts", _, "diameter" | "length" | "shear_modulus", *_):
            # Bores are left out: only with its own diameter can each be judged.
            return column.is_positive
        case ("gears", gear, "support") | ("gears", gear, "support", int()):
            return column.is_positive and not isinstance(case.gears[str(gear)].support, str)
        case ("gears", _, "support", "radial" | "tangential"):
            return True
    return False
