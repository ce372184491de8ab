"""Contacts solved one by one, compiled with Numba: surfaces, exchange of points, Newton's method.

What the numbers mean is explained where the arrays are made: `problem` for the strips, `programme`
for the programme. Limits are arguments, so that nothing that is compiled depends on another file.
Arrays are copied by loops, because assigning to a slice would take seconds to compile, for its
message on wrong shapes.
"""

from __future__ import annotations

import numpy as np

from loadshare.compilation import jit

compiled = jit(nogil=True, error_model="numpy")


@compiled
def shape(tau, table):  # type: ignore[no-untyped-def]
    """Return g(τ) and τ g'(τ) of a strip, both odd."""
    size = abs(tau)
    faded = np.sign(tau) * min(size / table.first, 1.0)
    step = (np.log(table.last) - np.log(table.first)) / (len(table.values) - 1)
    # Written so that NaN stays within the table.
    within = size if size > table.first else table.first
    within = table.last if within > table.last else within
    x = (np.log(within) - np.log(table.first)) / step
    k = min(int(x), len(table.values) - 2)
    s = x - k
    v0, m0, m1 = table.values[k], step * table.slopes[k], step * table.slopes[k + 1]
    rise = table.values[k + 1] - v0
    bend, lean = m0 + m1 - 2.0 * rise, 3.0 * rise - 2.0 * m0 - m1
    g = v0 + s * (m0 + s * (lean + s * bend))
    slope = (m0 + s * (2.0 * lean + 3.0 * s * bend)) / step
    return faded * g, faded * slope


@compiled
def add_below(place, length, scale, depth, poisson, total):  # type: ignore[no-untyped-def]
    """Add the compliance (N, N) of a half-space under strips, at the depths of the points."""
    for i in range(len(place)):
        for j in range(len(place)):
            away, half, between = place[i] - place[j], 0.5 * length[j], 0.5 * (depth[i] + depth[j])
            far, near = (
                _below((away + half) / between, poisson),
                _below((away - half) / between, poisson),
            )
            total[i, j] += scale[j] * (far - near)


@compiled
def _below(tau, poisson):  # type: ignore[no-untyped-def]
    """Return the integral over τ of z²/R³ + 2(1 − ν)/R, z = 1: Boussinesq's displacement."""
    return tau / np.sqrt(1.0 + tau**2) + 2.0 * (1.0 - poisson) * np.arcsinh(tau)


@compiled
def expand(strips, coefficients, series):  # type: ignore[no-untyped-def]
    """Fill the series (K, terms, N, N) in b² of the compliance between strips far apart."""
    for n in range(len(strips.number)):
        number, place, half = strips.number[n], strips.place[n], strips.half[n]
        for i in range(len(number)):
            for j in range(len(number)):
                if i == j or number[i] != number[j]:
                    series[n, :, i, j] = 0.0
                    continue
                away = place[i] - place[j]
                far, near = away + half[j], away - half[j]
                side = strips.scale[n, j] * np.sign(away)  # g is odd
                series[n, 0, i, j] = side * np.log(abs(far / near))
                far, near = 1.0 / far**2, 1.0 / near**2
                by_far, by_near = far, near
                for k in range(1, len(coefficients)):
                    series[n, k, i, j] = coefficients[k] * side * (by_far - by_near)
                    by_far *= far
                    by_near *= near


@compiled
def surface(strips, n, force, least, secant, tangent):  # type: ignore[no-untyped-def]
    """Compute the compliance (N, N) of the surfaces of one position, at any forces (N,)."""
    number, place, half = strips.number[n], strips.place[n], strips.half[n]
    scale, count, terms = strips.scale[n], len(force), strips.series.shape[1]
    square = np.minimum(np.maximum(force, least) * strips.square[n], strips.widest[n])
    width, grows = np.sqrt(square), square < strips.widest[n]
    for i in range(count):
        secant[i], tangent[i] = 0.0, 0.0
        for k in range(terms - 1, -1, -1):
            # b² grows as p, so p ∂S/∂p multiplies every power of b² by its exponent.
            for j in range(count):
                term = strips.series[n, k, i, j]
                secant[i, j] = secant[i, j] * square[j] + term
                tangent[i, j] = tangent[i, j] * square[j] + (1.0 + k * grows[j]) * term
        for j in range(count):
            away = place[i] - place[j]
            beside = abs(abs(away) - half[j]) if i != j else 0.0
            if number[i] == number[j] and beside < strips.far * width[j]:
                far = shape((away + half[j]) / width[j], strips.table)
                near = shape((away - half[j]) / width[j], strips.table)
                secant[i, j] = scale[j] * (far[0] - near[0])
                # b grows as √p, so p ∂S/∂p = −½ Σ ± τ g'(τ).
                tangent[i, j] = secant[i, j] - 0.5 * grows[j] * scale[j] * (far[1] - near[1])
        if strips.alone[n, i] > 0.0:
            depth = strips.level[n, i] - 0.5 * np.log(max(force[i], least))
            secant[i, i] += strips.alone[n, i] * depth
            tangent[i, i] += strips.alone[n, i] * (depth - 0.5)


@compiled
def surfaces(strips, which, force, least, secant, tangent):  # type: ignore[no-untyped-def]
    """Compute `surface` of positions `which` (K,) at forces (K, N)."""
    for c in range(len(which)):
        surface(strips, which[c], force[c], least[c], secant[c], tangent[c])


@compiled
def saddle(matrix, gap, load, closed, force):  # type: ignore[no-untyped-def]
    """Find the forces that make all closed points touch, of any sign; return the approach."""
    unit = matrix.max()  # keeps the bordered matrix well scaled
    unit = unit if unit > 0.0 else 1.0
    at = np.flatnonzero(closed)
    count = len(at)
    system, right = np.empty((count + 1, count + 1)), np.empty(count + 1)
    for i in range(count):
        for j in range(count):
            system[i, j] = matrix[at[i], at[j]] / unit
        system[i, count], system[count, i] = -1.0, 1.0
        right[i] = -gap[at[i]] / unit
    system[count, count], right[count] = 0.0, load
    solved = np.linalg.solve(system, right)
    force[:] = 0.0
    for i in range(count):
        force[at[i]] = solved[i]
    return solved[count] * unit


@compiled
def exchange(matrix, gap, load, closed, limits, force):  # type: ignore[no-untyped-def]
    """Solve a linear contact, starting from closed points (N,); return whether it succeeded."""
    seen = np.empty((limits.exchanges, len(gap)), np.bool_)
    for number in range(limits.exchanges):
        for before in range(number):
            if np.array_equal(seen[before], closed):
                return False
        if not closed.any():
            return False
        for i in range(len(gap)):
            seen[number, i] = closed[i]
        approach = saddle(matrix, gap, load, closed, force)
        yielded = matrix @ force
        pulling, pressing = -limits.band * load, -limits.band * np.abs(yielded).max()
        exchanged = False
        for i in range(len(gap)):
            apart = yielded[i] + gap[i] - approach
            wrong = force[i] < pulling if closed[i] else apart < pressing
            closed[i] ^= wrong
            exchanged |= wrong
        if not exchanged:
            np.maximum(force, 0.0, force)
            return True
    return False


@compiled
def settle(strips, of, found, linear, limits, answered):  # type: ignore[no-untyped-def]
    """Settle all contacts one by one, from number `answered` on, whose programme is solved already.

    Return the number of the next contact whose exchange goes in circles, with its programme in
    `linear`; −1 when all are done.
    """
    for c in range(max(answered, 0), len(of.which)):
        if not _settle_one(strips, of, found, linear, limits, c, c == answered):
            return c
    return -1


@compiled
def _settle_one(strips, of, found, linear, limits, c, answered):  # type: ignore[no-untyped-def]
    """Settle a contact or give it up; return false if the exchange goes in circles."""
    n, load, force = of.which[c], of.load[c], found.force[c]
    gap, secant, tangent = of.gap[c], np.empty_like(linear.matrix), np.empty_like(linear.matrix)
    while found.passes[c] < limits.passes:
        if not answered:
            surface(strips, n, force, limits.faint * force.sum(), secant, tangent)
            secant += of.fixed[n]
            tangent += of.fixed[n]
            yielded = secant @ force
            closed = force > 0.0
            found.approach[c] = ((yielded + gap) * force).sum() / load
            for i in range(len(gap)):
                found.distance[c, i] = yielded[i] + gap[i] - found.approach[c]
            if _in_touch(found.distance[c], closed, yielded, gap, limits):
                found.settled[c] = True
                found.slope[c] = saddle(tangent, np.zeros_like(gap), 1.0, closed, linear.force)
                return True
            # With its tangent at the last forces, the law is a linear contact with a shifted gap.
            shift = yielded - tangent @ force
            for i in range(len(gap)):
                linear.gap[i] = gap[i] + (shift[i] if found.newton[c] else 0.0)
                for j in range(len(gap)):
                    linear.matrix[i, j] = tangent[i, j] if found.newton[c] else secant[i, j]
            if not exchange(linear.matrix, linear.gap, load, closed, limits, linear.force):
                return False
        answered = False
        step = np.abs(linear.force - force).max()
        # Where Newton's method does not converge, a pass at fixed widths does.
        found.newton[c] = not found.newton[c] or step < found.step[c]
        found.step[c] = step
        for i in range(len(gap)):
            force[i] = linear.force[i]
        found.passes[c] += 1
    return True


@compiled
def _in_touch(distance, closed, yielded, gap, limits):  # type: ignore[no-untyped-def]
    """Return whether closed points touch and open ones do not overlap, except for round-off."""
    missed, least = -np.inf, 0.0
    for i in range(len(gap)):
        missed = max(missed, abs(distance[i]) if closed[i] else -distance[i])
        if closed[i]:
            # Light loads deflect less than the gaps they close, which have their own round-off.
            least = max(least, limits.round_off * gap[i])
    return missed < limits.settled * np.abs(yielded).max() + least
