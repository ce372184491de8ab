"""Teeth: unloaded contact, and contact under load."""

from __future__ import annotations

import math
from typing import NamedTuple

from loadshare.settings.precision import EPS


class Teeth(NamedTuple):
    """Where flanks touch, and how they share a load."""

    tolerance: float = 1e-9
    """Largest scaled residual of a certified contact of flanks."""
    passes: int = 60
    """Passes after which a contact that does not settle is given up."""
    settled: float = 1e-12
    """Distance of closed points, in deflections, at which a contact has settled."""
    round_off: float = 16.0 * EPS
    """Part of a gap that counts as zero."""
    exchanges: int = 40
    """Exchanges in one pass before the solver interface is used instead."""
    band: float = 1e-13
    """Violation of a sign, in loads and deflections, that counts as round-off."""
    faint: float = 1e-12
    """Part of a line's whole load below which a point's strip is not narrowed further: its effect
    is 0."""
    longest: float = 1e-7
    """Axis ratio below which an ellipse counts as a line."""
    first_knot: float = 1e-7
    """First knot τ of the table of strips."""
    last_knot: float = 1e9
    """Last knot."""
    terms: int = 5
    """Powers of b² that are kept of a strip."""
    far: float = 4.0
    """Distance, in half-widths, from which they are accurate to 4e-11."""
    last_step: float = 1e-9
    """Newton step [m] after which no other is made: the error is its square over a radius of
    curvature, below round-off."""
    last_turn: float = 1e-8
    """The same of an angle [rad]."""
    near_edge: float = 1e-7
    """The same [m] where a line leaves the flanks: the error is picometres."""
    steps: int = 30
    """Most Newton steps to a point of a face gear."""
    from_anchor: int = 10
    """Most Newton steps from one point of a valley to the next: three to six are taken from the
    anchor, two or three from a neighbour; a point that takes longer lies beyond the edge of
    regression of the driven flank or inside the driver's base circle."""
    sure: int = 3
    """Steps after which each must be a quarter of the one before, or Newton's method will not
    converge in time."""
    touching: float = 1e-12
    """Least gap [m] of flanks that touch: a hundredth of the gap that a transmission error of
    1e-9 rad makes at a base radius of 0.1 m."""
    looked_at: int = 16
    """Positions of the mesh cycle at which the teeth of a misaligned pair must meet."""
    level: float = 1e-9
    """Rise of a gap along a line [m/m] below which it is level: an unmodified line contact."""
    near: float = 1e-9
    """Distance [m] within which the least gap on a line and the one at the point of contact
    agree."""
    same_edge: float = 50e-6
    """Distance [m] within which ends of two gears are one edge, named after the driver."""
    fits: float = 1e-9
    """Part of a dimension, or of an angle [rad], by which it may differ from its partner's by
    rounding; the same for how far tips reach."""
    rounding: float = 1e-9
    """Sum of profile shifts beyond the range of a formula that is rounding."""
    closing: float = 1e-6
    """Sum [m] of the single pitch deviations around a gear that is rounding."""
    radius: float = 1e-3
    """Part of a base radius by which a case may differ from the pair that it names."""
    angle: float = math.radians(0.05)
    """The same of an angle [rad]."""
    zero: float = 1e-14
    """Precision of a limit of a face gear, relative and in radians or metres."""
    beside: float = 1e-6
    """Distance [rad] from 0 and 90 degrees between which such a limit is sought."""
    meets: int = 30
    """Most Newton steps to where a line or a normal meets a surface: five are usual."""
    circle: float = 1e-5
    """Axis ratio, less one, within which a contact ellipse counts as a circle."""
    least_deflection: float = 1e-6
    """Deflection [m] of flanks that do not yield at all."""
    shortest: float = 1e-4
    """Part of a face width below which a contact line is ignored: the force that it carries falls
    with its length."""
    at_end: float = 1e-12
    """Distance [m] within which a station is the end of its line."""


TEETH = Teeth()
