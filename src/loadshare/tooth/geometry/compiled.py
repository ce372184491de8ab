"""Points of tooth flanks, and the valleys of the gap between them, compiled with Numba.

The equations are explained where the numbers are made: :mod:`loadshare.tooth.cylindrical.flank`,
:mod:`loadshare.tooth.face.flank` and `valley`. A point is an array (6, 3): the position, the unit
normal, and the derivatives of both with respect to both surface parameters.
"""

from __future__ import annotations

import numpy as np

from loadshare.compilation import jit

compiled = jit(nogil=True, error_model="numpy")


@compiled
def profile(gear, roll):  # type: ignore[no-untyped-def]
    """Return the material taken off at a length of roll [m], and its first two derivatives."""
    taken, half = gear.taken, 0.5 * (gear.tip - gear.root)
    middle = roll - 0.5 * (gear.tip + gear.root)
    bend = taken.profile_crowning / half**2
    height, slope, second = bend * middle**2, 2.0 * bend * middle, 2.0 * bend
    if taken.tip_relief != 0.0:
        # Grows towards the tip, where the roll of an internal gear is shortest.
        length, n = np.sign(half) * taken.tip_relief_length, taken.tip_relief_exponent
        into = (roll - gear.tip) / length + 1.0
        if into > 0.0:
            height += taken.tip_relief * into**n
            slope += taken.tip_relief * n * into ** (n - 1) / length
            second += taken.tip_relief * n * (n - 1) / length**2
    return height, slope, second


@compiled
def lead(gear, axial):  # type: ignore[no-untyped-def]
    """Return the material taken off at ζ [m], and its first two derivatives."""
    taken = gear.taken
    bend = 4.0 * taken.lead_crowning / gear.width**2
    height, slope, second = bend * axial**2, 2.0 * bend * axial, 2.0 * bend
    if taken.end_relief != 0.0:
        into = (abs(axial) - 0.5 * gear.width) / taken.end_relief_length + 1.0
        if into > 0.0:
            height += taken.end_relief * into
            slope += taken.end_relief / taken.end_relief_length * np.sign(axial)
    return height, slope, second


@compiled
def helicoid(gear, roll, axial, turn, point):  # type: ignore[no-untyped-def]
    """Compute one point of a cylindrical gear's flank, turned about z."""
    s, radius, twist, sine, cosine = gear.side, gear.radius, gear.twist, gear.sine, gear.cosine
    per_roll = -s * gear.kind
    phi = turn + s * gear.half_angle + per_roll * roll + twist * axial

    # Components along e_r, e_t and e_z, which turn with φ: the generator of the helicoid is
    # (0, sin β_b, cos β_b), the plain normal s (0, cos β_b, −sin β_b).
    across, up, arc = s * cosine, -s * sine, -per_roll * radius * roll
    taken, by_roll, by_roll2 = profile(gear, radius * roll)
    by_roll, by_roll2 = radius * by_roll, radius**2 * by_roll2
    more, by_axial, by_axial2 = lead(gear, axial)
    taken += more
    reach = radius * roll - gear.kind * cosine * taken
    # Along e_r, generator and plain normal, the normal is (tilt, lean, 1), normalised.
    tilt = by_roll / reach
    lean = cosine * (by_axial - twist * per_roll * by_roll)
    over = 1.0 / np.sqrt(1.0 + tilt**2 + lean**2)
    _put(point, 0, radius, arc - across * taken, axial - up * taken)
    _put(point, 1, tilt * over, (lean * sine + across) * over, (lean * cosine + up) * over)
    _put(point, 2, reach, -across * by_roll, -up * by_roll)
    tangential = sine / cosine - across * by_axial
    _put(point, 3, twist * per_roll * reach, tangential, 1.0 - up * by_axial)
    # Its derivatives over ξ and ζ follow from those of tilt, lean and φ; its length is constant.
    tilts = (by_roll2 - tilt * (radius - gear.kind * cosine * by_roll)) * (over / reach)
    leans = -cosine * twist * per_roll * by_roll2 * over
    _bend(point, 4, tilts, sine * leans, cosine * leans, per_roll)
    tilts = tilt * gear.kind * cosine * by_axial * (over / reach)
    leans = cosine * by_axial2 * over
    _bend(point, 5, tilts, sine * leans, cosine * leans, twist)
    _spin(point, phi)


@compiled
def face(gear, roll, phi, turn, point):  # type: ignore[no-untyped-def]
    """Compute one point of a face gear's flank, in its own frame, turned about z."""
    s, base = -gear.side, gear.base
    cosine, sine = np.cos(phi), np.sin(phi)
    x, y = base * (cosine - s * roll * sine), base * (sine + s * roll * cosine)
    u = gear.scale / cosine
    # In the gear's frame, everything also turns back about z = (−sin Γ, 0, cos Γ) by m φ_s.
    k, n = gear.ratio * gear.axes[2, 2], gear.ratio * gear.axes[2, 0]
    _put(point, 0, x, y, u)
    _put(point, 1, s * sine, -s * cosine, 0.0)
    _put(point, 2, s * (k * y - base * sine), s * (base * cosine - k * x + n * u), -s * n * y)
    _put(point, 3, (k - 1.0) * y, (1.0 - k) * x + n * u, u * sine / cosine - n * y)
    _put(point, 4, -k * cosine, -k * sine, n * cosine)
    _put(point, 5, s * (1.0 - k) * cosine, s * (1.0 - k) * sine, s * n * cosine)
    _carry(point, gear.axes)
    shaper_turn = phi - s * gear.half_angle + s * roll
    _spin(point, turn - gear.ratio * shaper_turn + gear.side * np.pi / gear.teeth)


@compiled
def helicoids(gear, roll, axial, turn, points):  # type: ignore[no-untyped-def]
    """Compute points (6, 3, n) of a cylindrical gear's flank."""
    point = np.empty((6, 3))
    for k in range(len(roll)):
        helicoid(gear, roll[k], axial[k], turn[k], point)
        _keep(point, points, k)


@compiled
def faces(gear, roll, phi, turn, points):  # type: ignore[no-untyped-def]
    """Compute points (6, 3, n) of a face gear's flank."""
    point = np.empty((6, 3))
    for k in range(len(roll)):
        face(gear, roll[k], phi[k], turn[k], point)
        _keep(point, points, k)


@compiled
def find(flanks, start, turns, known, stations, last, limits, found):  # type: ignore[no-untyped-def]
    """Find the unknowns (m, n, 5) of valleys at stations (m, n), NaN where there are none."""
    own, other, work, step = np.empty((6, 3)), np.empty((6, 3)), np.empty((7, 3)), np.empty(5)
    slope = np.empty(5)
    for i in range(len(stations)):
        here = start.at[i]
        _both(flanks, here[0], here[1], here[2], here[3], turns[i], own, other)
        work[6] = 0.0
        _solve(own, other, 0.0, start.major[i], start.minor[i], 1.0, 0.0, work, slope)
        for j in range(stations.shape[1]):
            at = found[i, j]
            _interpolate(known, i, stations[i, j], at)
            for k in range(5):
                if not np.isfinite(at[k]):
                    at[k] = slope[k] * stations[i, j] + (here[k] if k < 4 else 0.0)
            before, done = np.inf, False
            for number in range(limits.from_anchor):
                moved = _newton(
                    flanks, start, i, turns[i], stations[i, j], at, own, other, work, step
                )
                done = moved <= last
                if done or not np.isfinite(moved):
                    break
                # Newton's method fails if later steps do not shrink to a quarter of the one before.
                if number >= limits.sure and not moved < 0.25 * before:
                    break
                before = moved
            if not done:
                at[:] = np.nan


@compiled
def interpolate(known, stations, found):  # type: ignore[no-untyped-def]
    """Interpolate the unknowns (m, n, 5) at stations (m, n) from those at evenly spaced ones."""
    for i in range(len(stations)):
        for j in range(stations.shape[1]):
            _interpolate(known, i, stations[i, j], found[i, j])


@compiled
def trace(flanks, start, turns, found, own, other, tangent):  # type: ignore[no-untyped-def]
    """Compute both flanks (6, 3, m·n) and the driver points' derivatives (m, n, 3) by station."""
    first, second, work, slope = np.empty((6, 3)), np.empty((6, 3)), np.zeros((7, 3)), np.empty(5)
    for i in range(found.shape[0]):
        for j in range(found.shape[1]):
            a, b, c, d, gap = found[i, j]
            _both(flanks, a, b, c, d, turns[i], first, second)
            work[6] = 0.0
            _solve(first, second, gap, start.major[i], start.minor[i], 1.0, 0.0, work, slope)
            _keep(first, own, i * found.shape[1] + j)
            _keep(second, other, i * found.shape[1] + j)
            for k in range(3):
                tangent[i, j, k] = slope[0] * first[2, k] + slope[1] * first[3, k]


@compiled
def _interpolate(known, i, station, at):  # type: ignore[no-untyped-def]
    """Interpolate the unknowns (5,) of valley `i` cubically; NaN where none are known."""
    count = known.stations.shape[1]
    if count == 0:
        at[:] = np.nan
        return
    first, end = known.stations[i, 0], known.stations[i, count - 1]
    x = (station - first) * (count - 1) / (end - first)
    k = min(max(int(x) - 1, 0), count - 4)
    x -= k
    low, high = (x - 1.0) * (x - 2.0), x * (x - 3.0)
    near = known.found[i]
    for n in range(5):
        at[n] = 0.5 * (high * ((x - 2.0) * near[k + 1, n] - (x - 1.0) * near[k + 2, n]))
        at[n] += low * (x * near[k + 3, n] - (x - 3.0) * near[k, n]) / 6.0


@compiled
def _both(flanks, a, b, c, d, turns, own, other):  # type: ignore[no-untyped-def]
    """Compute the points of the driver's and of the driven flank in the fixed frame."""
    helicoid(flanks.driver, a, b, turns[0], own)
    face(flanks.driven, c, d, turns[1], other)
    _carry(other, flanks.axes)
    for k in range(3):
        other[0, k] += flanks.origin[k]


@compiled
def _newton(flanks, start, i, turns, station, at, own, other, work, step):  # type: ignore[no-untyped-def]
    """Make a Newton step of valley `i` on the unknowns `at`; return how far points move [m]."""
    _both(flanks, at[0], at[1], at[2], at[3], turns, own, other)
    gap, ahead, aside = at[4], station, 0.0
    for k in range(3):
        work[6, k] = other[0, k] - own[0, k] - gap * own[1, k]
        ahead -= (own[0, k] - start.point[i, k]) * start.major[i, k]
        aside -= (own[1, k] + other[1, k]) * start.minor[i, k]
    _solve(own, other, gap, start.major[i], start.minor[i], ahead, aside, work, step)
    at += step
    moved = abs(step[4])
    for k in range(2):
        moved = max(moved, abs(step[k]) * np.sqrt(_dot(own[2 + k], own[2 + k])))
        moved = max(moved, abs(step[2 + k]) * np.sqrt(_dot(other[2 + k], other[2 + k])))
    return moved if np.isfinite(step.sum()) else np.nan


@compiled
def _solve(own, other, gap, major, minor, ahead, aside, work, step):  # type: ignore[no-untyped-def]
    """Solve the linearised equations of a valley for the changes (5,) of its unknowns.

    With δ the changes of the driver's parameters a, b, the driven flank's c, d and the gap t,

        (X_a + t n_a) δa + (X_b + t n_b) δb − Y_c δc − Y_d δd + n δt = apart,
        (X_a δa + X_b δb)·e_major = ahead,
        (n_a δa + n_b δb + m_c δc + m_d δd)·e_minor = aside,

    with `apart` in the last row of `work`. The first three equations give δc and δd in terms of δa
    and δb, for which two equations are left.
    """
    normal, ray_a, ray_b, lean, apart = own[1], work[0], work[1], work[5], work[6]
    # Rows that, divided by the determinant, extract δc, δd and −δt from Y_c δc + Y_d δd − n δt.
    reads = work[2:5]
    _cross(other[3], normal, reads[0])
    _cross(normal, other[2], reads[1])
    _cross(other[2], other[3], reads[2])
    over = 1.0 / _dot(reads[2], normal)
    turn_c, turn_d = _dot(other[4], minor) * over, _dot(other[5], minor) * over
    for k in range(3):
        ray_a[k] = own[2, k] + gap * own[4, k]
        ray_b[k] = own[3, k] + gap * own[5, k]
        lean[k] = turn_c * reads[0, k] + turn_d * reads[1, k]
    first_a, first_b = _dot(own[2], major), _dot(own[3], major)
    second_a = _dot(own[4], minor) + _dot(lean, ray_a)
    second_b = _dot(own[5], minor) + _dot(lean, ray_b)
    aside += _dot(lean, apart)
    area = first_a * second_b - first_b * second_a
    step[0] = (second_b * ahead - first_b * aside) / area
    step[1] = (first_a * aside - second_a * ahead) / area
    for k in range(3):
        apart[k] = ray_a[k] * step[0] + ray_b[k] * step[1] - apart[k]
    for k in range(3):
        step[2 + k] = _dot(reads[k], apart) * over
    step[4] *= -1.0


@compiled
def _put(point, row, x, y, z):  # type: ignore[no-untyped-def]
    point[row, 0], point[row, 1], point[row, 2] = x, y, z


@compiled
def _keep(point, points, k):  # type: ignore[no-untyped-def]
    """Store a point as number `k` of points (6, 3, n)."""
    # Assigning to a slice would take seconds to compile, because of its message on wrong shapes.
    for row in range(6):
        for axis in range(3):
            points[row, axis, k] = point[row, axis]


@compiled
def _bend(point, row, x, y, z, turn):  # type: ignore[no-untyped-def]
    """Store the change of the unit normal, which also turns about z, less its part along it."""
    normal = point[1]
    x, y = x - turn * normal[1], y + turn * normal[0]
    along = normal[0] * x + normal[1] * y + normal[2] * z
    _put(point, row, x - along * normal[0], y - along * normal[1], z - along * normal[2])


@compiled
def _spin(point, angle):  # type: ignore[no-untyped-def]
    """Turn a point with its vectors about z."""
    cosine, sine = np.cos(angle), np.sin(angle)
    for row in range(6):
        x, y = point[row, 0], point[row, 1]
        point[row, 0], point[row, 1] = cosine * x - sine * y, sine * x + cosine * y


@compiled
def _carry(point, axes):  # type: ignore[no-untyped-def]
    """Turn a point with its vectors by a rotation (3, 3)."""
    for row in range(6):
        x, y, z = point[row]
        for k in range(3):
            point[row, k] = axes[k, 0] * x + axes[k, 1] * y + axes[k, 2] * z


@compiled
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _cross(a, b, product):  # type: ignore[no-untyped-def]
    product[0] = a[1] * b[2] - a[2] * b[1]
    product[1] = a[2] * b[0] - a[0] * b[2]
    product[2] = a[0] * b[1] - a[1] * b[0]
