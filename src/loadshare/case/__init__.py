"""Cases: what a user writes about a transmission, read, checked, and kept as it was written."""

from loadshare.case.content import Content
from loadshare.case.gear_errors import Eccentricity, Errors, Offset, Pin
from loadshare.case.gears import STEEL_EXPANSION, Gear, PinSupport, Polar
from loadshare.case.links import Backlashes, Bearing, Range, Ring, Shaft, Spline
from loadshare.case.mass import mass_of
from loadshare.case.measured import Measurement
from loadshare.case.meshes import Law, Mesh, Table
from loadshare.case.model import Case
from loadshare.case.operation import March, Operating, Stage
from loadshare.case.quantity import Quantity
from loadshare.case.reader import load_case
from loadshare.case.schema import case_schema
from loadshare.case.starter import starter_case
from loadshare.case.study import Study

__all__ = [
    "STEEL_EXPANSION",
    "Backlashes",
    "Bearing",
    "Case",
    "Content",
    "Eccentricity",
    "Errors",
    "Gear",
    "Law",
    "March",
    "Measurement",
    "Mesh",
    "Offset",
    "Operating",
    "Pin",
    "PinSupport",
    "Polar",
    "Quantity",
    "Range",
    "Ring",
    "Shaft",
    "Spline",
    "Stage",
    "Study",
    "Table",
    "case_schema",
    "load_case",
    "mass_of",
    "starter_case",
]
