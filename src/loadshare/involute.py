"""Involute teeth: radii and angles of a gear, and of two gears at a distance (ISO 21771).

Tooth numbers are positive, also for internal gears. σ is +1 for teeth that point away from the
axis and −1 for those that point to it; a positive profile shift thickens the tooth of either at
the reference circle, and moves the teeth of an internal gear inwards.
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache


def inv(angle: float) -> float:
    """Return the involute of a pressure angle [rad]: tan α − α."""
    return math.tan(angle) - angle


# Every case made from another one asks for the same pairs again.
@lru_cache(maxsize=1 << 12)
def inverse_inv(value: float) -> float:
    """Return the pressure angle [rad] of an involute value, 0 ≤ α < π/2.

    Parameters
    ----------
    value : float
        inv α, not negative.

    Raises
    ------
    ValueError
        If `value` is negative: no involute reaches inside its base circle.
    """
    from scipy.optimize import brentq

    if value < 0.0:
        raise ValueError(f"inv α = {value:.6g} is negative; no pressure angle has it")
    # In t = tan α the equation is t − atan t = value; both bounds on the root lie above it.
    highest = value + math.pi / 2 if value > 1.0 else (3.0 * value) ** (1 / 3) * (1.0 + value)
    highest *= 2.0  # beyond round-off
    found = brentq(lambda t: t - math.atan(t) - value, 0.0, highest, xtol=1e-300, rtol=1e-15)
    return math.atan(found)


class InvoluteTooth:
    """Radii and angles of involute teeth: of a cylindrical gear, or of the cutter of a face gear.

    Attributes
    ----------
    module : float
        Normal module [m].
    teeth : int
        Number of teeth.
    pressure_angle, helix_angle : float
        Normal pressure angle and reference helix angle [rad].
    profile_shift : float
        Profile shift coefficient x.
    addendum : float
        Height of the tip above the datum line, in modules, alteration of the tip included.
    dedendum : float
        Depth of the root below it, in modules; the cutter of a face gear needs none.
    internal : bool
        Whether the teeth point to the axis.
    thickness_allowance : float
        By how much the tooth is thicker than its rack makes it, negative where it is thinner, along
        the reference circle in the normal section, E_sn [m].
    """

    module: float
    teeth: int
    pressure_angle: float
    profile_shift: float
    addendum: float
    dedendum: float
    helix_angle: float = 0.0
    internal: bool = False
    thickness_allowance: float = 0.0

    @property
    def kind(self) -> int:
        """σ: +1 external, −1 internal."""
        return -1 if self.internal else 1

    @cached_property
    def transverse_angle(self) -> float:
        """Transverse pressure angle α_t [rad]."""
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))

    @cached_property
    def radius(self) -> float:
        """Reference radius [m]."""
        return 0.5 * self.module * self.teeth / math.cos(self.helix_angle)

    @cached_property
    def base_radius(self) -> float:
        """Base radius r_b [m]."""
        return self.radius * math.cos(self.transverse_angle)

    @property
    def tip(self) -> float:
        """Tip radius [m]."""
        return self.radius + self.kind * (self.addendum + self.profile_shift) * self.module

    @property
    def root(self) -> float:
        """Root radius, as the rack leaves it [m]."""
        return self.radius - self.kind * (self.dedendum - self.profile_shift) * self.module

    @cached_property
    def tip_roll(self) -> float:
        """Angle of roll at the tip [rad]."""
        return math.sqrt((self.tip / self.base_radius) ** 2 - 1.0)

    @cached_property
    def base_half_angle(self) -> float:
        """Half the angle of a tooth where its involutes, prolonged, meet the base circle [rad]."""
        thickness = 0.5 * math.pi + 2.0 * self.profile_shift * math.tan(self.pressure_angle)
        thickness += self.thickness_allowance / self.module
        return thickness / self.teeth + self.kind * inv(self.transverse_angle)

    def addendum_to(self, radius: float) -> float:
        """Return the addendum, in modules, of a tip at a radius [m]."""
        return self.kind * (radius - self.radius) / self.module - self.profile_shift

    @cached_property
    def base_helix_angle(self) -> float:
        """Helix angle on the base cylinder β_b [rad]."""
        return math.asin(math.sin(self.helix_angle) * math.cos(self.pressure_angle))

    @cached_property
    def pointed(self) -> float:
        """Radius at which the flanks of a tooth meet [m]: below its tip if the tooth is pointed.

        Raises
        ------
        ValueError
            If they do not meet outside the base circle.
        """
        return self.base_radius / math.cos(inverse_inv(self.kind * self.base_half_angle))

    def half_angle_at(self, pressure_angle: float) -> float:
        """Return half the angle of a tooth at a transverse pressure angle [rad]."""
        return self.base_half_angle - self.kind * inv(pressure_angle)


def base_distance(one: InvoluteTooth, two: InvoluteTooth) -> float:
    """Return the centre distance [m] below which gears lack a line of action, |r_b2 + σ r_b1|."""
    return abs(two.base_radius + one.kind * two.kind * one.base_radius)


def working_angle(one: InvoluteTooth, two: InvoluteTooth, distance: float) -> float:
    """Return the transverse working pressure angle α_wt [rad] at a centre distance [m].

    cos α_wt = |r_b2 + σ r_b1| / a.
    """
    return math.acos(base_distance(one, two) / distance)


def working_angle_without_backlash(one: InvoluteTooth, two: InvoluteTooth) -> float:
    """Return the transverse working pressure angle at which both flanks touch [rad].

    inv α_wt = inv α_t + 2 tan α_n (x1 + x2)/(z1 ± z2), the lower sign with an internal gear
    (ISO 21771, in which z2 < 0).

    Raises
    ------
    ValueError
        If the profile shifts bring the gears closer than their base circles allow, or an internal
        gear has no more teeth than the other.
    """
    teeth = one.kind * one.teeth + two.kind * two.teeth
    if one.kind * two.kind < 0 and teeth >= 0:
        raise ValueError("an internal gear has more teeth than its pinion")
    shift = one.profile_shift + two.profile_shift
    change = 2.0 * math.tan(one.pressure_angle) * shift / teeth
    return inverse_inv(inv(one.transverse_angle) + change)


def distance_without_backlash(one: InvoluteTooth, two: InvoluteTooth) -> float:
    """Return the centre distance at which both flanks touch, |r_b2 + σ r_b1| / cos α_wt [m].

    Raises
    ------
    ValueError
        As `working_angle_without_backlash`.
    """
    return base_distance(one, two) / math.cos(working_angle_without_backlash(one, two))


def contact_ratio(one: InvoluteTooth, two: InvoluteTooth, distance: float) -> float:
    """Return the transverse contact ratio ε_α of two gears at a centre distance [m].

    The paths of contact between pitch point and tips, σ (√(r_a² − r_b²) − r_b tan α_wt) of each,
    over the transverse base pitch.
    """
    slope = math.tan(working_angle(one, two, distance))
    paths = (g.kind * g.base_radius * (g.tip_roll - slope) for g in (one, two))
    return sum(paths) * one.teeth / (2.0 * math.pi * one.base_radius)


def normal_backlash(one: InvoluteTooth, two: InvoluteTooth, distance: float) -> float:
    """Return the normal backlash j_bn at a centre distance [m]; negative where teeth overlap.

    It is the part of the pitch that the teeth leave free on the working pitch circles,
    2 r_w (π/z − ψ) − 2 r_w2 ψ_2 with the half angles ψ of the teeth there, times cos α_wt cos β_b.
    Thickness allowances contribute −(E_sn1 + E_sn2) cos α_n (ISO/TR 10064-2), a centre distance
    above that without backlash the rest.
    """
    angle = working_angle(one, two, distance)
    left = one.base_radius * (math.pi / one.teeth - one.half_angle_at(angle))
    left -= two.base_radius * two.half_angle_at(angle)
    return 2.0 * left * math.cos(one.base_helix_angle)


def tip_limit(gear: InvoluteTooth, other: InvoluteTooth, distance: float) -> float:
    """Return the radius on the other gear that meets the base of an external gear's involute [m].

    r = √(r_b² + (a sin α_wt)²): the tip of an external gear must not reach beyond it, that of an
    internal gear must stay outside it, or the teeth interfere.
    """
    return math.hypot(other.base_radius, distance * math.sin(working_angle(gear, other, distance)))


def root_clearance(gear: InvoluteTooth, other: InvoluteTooth, distance: float) -> float:
    """Return the clearance between the root of a gear and the tip of another [m]."""
    if other.internal:
        # Seen from the internal gear's centre, the pinion's root is at distance + root.
        return other.tip - distance - gear.root
    return gear.kind * (distance - gear.root) - other.tip


def tips_pass(pinion: InvoluteTooth, ring: InvoluteTooth, distance: float) -> bool:
    """Return whether the tips of a pinion and an internal gear pass each other freely.

    Beside the line of action, where the tip circles cross at polar angles θ1 and θ2 from the line
    of centres, the pinion's tip must have passed the ring's (trimming, fouling):
    z1 (inv α_a1 + θ1) − z2 (inv α_a2 + θ2) + (z2 − z1) inv α_wt ≥ 0.
    """
    r1, r2 = pinion.tip, ring.tip
    cosine = (r2**2 - r1**2 - distance**2) / (2.0 * distance * r1)
    if abs(cosine) >= 1.0:
        return True
    theta_1 = math.acos(cosine)
    theta_2 = math.acos((distance**2 + r2**2 - r1**2) / (2.0 * distance * r2))
    passed = pinion.teeth * (inv(math.atan(pinion.tip_roll)) + theta_1)
    passed -= ring.teeth * (inv(math.atan(ring.tip_roll)) + theta_2)
    more = ring.teeth - pinion.teeth
    return passed + more * inv(working_angle(pinion, ring, distance)) >= 0.0
