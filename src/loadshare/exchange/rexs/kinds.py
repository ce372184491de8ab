"""Types of REXS components, as versions name them, and what they do."""

from __future__ import annotations

from loadshare.exchange.rexs.model import Component

GEARS = ("cylindrical_gear", "ring_gear")
COUPLINGS = (
    "coupling",
    "fixed_coupling",
    "switchable_coupling",
    "rigid_connection",
    "involute_spline_connection",
)
FIXED = ("gear_casing", "gear_unit")
BEARINGS = (
    "concept_bearing",
    "rolling_bearing_with_catalog_geometry",
    "rolling_bearing_with_detailed_geometry",
    "plain_bearing",
    "slide_bearing",
    "radial_plain_bearing",
)
READ = {
    *GEARS,
    *COUPLINGS,
    *BEARINGS,
    "gear_unit",
    "gear_casing",
    "shaft",
    "shaft_section",
    "cylindrical_stage",
    "planetary_stage",
    "planet_carrier",
    "external_load",
    "flank_geometry",
    "cylindrical_gear_flank",
    "material",
}
"""Types of components of which something is read, or that hold nothing by themselves."""


def may_turn(load: Component) -> bool:
    """Whether a component is a load that may exert torque."""
    return load.type == "external_load" and load.attributes.get("transmits_torque") is not False


def transmits(coupling: Component) -> bool:
    """Whether a coupling transmits torque: not with a torsional stiffness of zero."""
    return coupling.number("rotational_stiffness") != 0.0
