"""Compliance of a gear without finite elements: slices of the tooth, coupled as a plate.

A slice of the tooth across its face width is Weber and Banaschek's cantilever: bending, shear and
axial compression along its middle line from the potential energy of the true thickness, on a root
that yields by the half-plane formulas. Neighbouring slices pull on one another by bending across,
by twist and by shear, which makes the tooth a Mindlin plate of variable thickness on an elastic
root. Its deflections are polynomials along the tooth's height and over its width (Ritz), so under
a load that is even over the width each slice is exactly the cantilever.

Left out: the coupling of slices through the root, the influence of a tooth on its neighbours and
the yielding of a thin rim. Sources: C. Weber and K. Banaschek (1953); R. W. Cornell, Compliance
and stress sensitivity of spur gear teeth, J. Mech. Des. 103 (1981), for the root; P. Gagnon,
C. Gosselin and L. Cloutier, J. Mech. Des. 119 (1997), for gear teeth as Mindlin plates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.tooth.body import Array, ToothBody
from loadshare.tooth.compliance.interface import Flank
from loadshare.tooth.compliance.middle import STEP, MiddleSurface, waist_of
from loadshare.tooth.compliance.sheet import Sheet

HEIGHT_DEGREE = 6
"""Degree of the polynomials along the tooth's height."""
ROOT_TANGENT = 60.0
"""Angle [degrees] between fillet and chord at the root section: the standard's 30° tangent."""
SHEAR_FACTOR = 5.0 / 6.0
FLAT = 0.01
"""Least rise of the middle surface, over that of the flank."""


@dataclass(frozen=True, slots=True, eq=False)
class _Station:
    """The middle surface at some places: unit vectors (n, 3), slopes and thickness (n,).

    `up` points to the tip, `out` to side +1; `rise` and `run` are lengths per unit of u and of w.
    """

    up: Array
    out: Array
    rise: Array
    run: Array
    thickness: Array


class Slices:
    """Bending, shear, compression and root of one tooth as a plate of coupled slices.

    Parameters
    ----------
    body : ToothBody
    side : {+1, −1}
        The flank that carries load.
    width_degree : int, optional
        Degree of the polynomials over the width; by default the width over the height decides.
    """

    def __init__(self, body: ToothBody, side: int, width_degree: int | None = None) -> None:
        self.body, self.side = body, side
        self.middle = MiddleSurface(body, waist_of(body, ROOT_TANGENT))
        self._u, self._height = _middle_line(self.middle)
        ends = self.middle.between(np.full(2, body.foot), np.array([0.0, 1.0]))
        slenderness = float(np.linalg.norm(ends[1] - ends[0])) / self._height[-1]
        default = int(np.clip(np.ceil(3.0 + 2.0 * slenderness), 6, 18))
        self._degrees = HEIGHT_DEGREE, width_degree or default
        levels, stations = np.linspace(body.foot, 1.0, 9), np.linspace(0.0, 1.0, 9)
        self._flank = Sheet(levels, stations)
        self._feet = self.middle.feet(self._flank.places, side)
        self._bending, self._axial = self._factors()

    def bulk(self, flanks: tuple[Flank, ...]) -> Array:
        """See :meth:`loadshare.tooth.compliance.interface.Compliance.bulk`."""
        from scipy.linalg import solve_triangular

        ends = np.cumsum([0] + [len(f.uw) for f in flanks])
        total = np.zeros((ends[-1], ends[-1]))
        for tooth in sorted({f.tooth for f in flanks}):
            own = [i for i, f in enumerate(flanks) if f.tooth == tooth]
            rows = np.concatenate([np.arange(ends[i], ends[i + 1]) for i in own])
            across, along = self._loads(np.concatenate([flanks[i].uw for i in own]))
            parts = (
                solve_triangular(factor, loads.T, lower=True, check_finite=False)
                for factor, loads in ((self._bending, across), (self._axial, along))
            )
            total[np.ix_(rows, rows)] = sum(part.T @ part for part in parts)
        return total

    def depth(self, uw: Array) -> Array:
        """See :meth:`loadshare.tooth.compliance.interface.Compliance.depth`."""
        return np.asarray(self._flank.weights(uw) @ self._feet.depth)

    def _loads(self, uw: Array) -> tuple[Array, Array]:
        """What unit forces on flank points do on the fields of the plate and of its compression."""
        weights = self._flank.weights(uw)
        zw = np.asarray(weights @ self._feet.zw)
        zw[:, 0] = np.maximum(zw[:, 0], self.middle.waist)
        inward = np.asarray(weights @ self._feet.inward)
        at = self._station(zw)
        value = self._basis(zw)[0]
        out = np.sum(inward * at.out, axis=1)[:, None] * value
        up = np.sum(inward * at.up, axis=1)[:, None] * value
        nothing = np.zeros_like(value)
        return np.hstack([out, nothing, nothing]), up

    def _station(self, zw: Array) -> _Station:
        """The middle surface and the thickness across it at places (n, 2)."""
        z, w = zw[:, 0], zw[:, 1]
        low, high = np.maximum(z - STEP, self.middle.waist), np.minimum(z + STEP, 1.0)
        before, after = np.maximum(w - STEP, 0.0), np.minimum(w + STEP, 1.0)
        between, outline = self.middle.between, self.body.outline
        up = (between(high, w) - between(low, w)) / (high - low)[:, None]
        run = (between(z, after) - between(z, before)) / (after - before)[:, None]
        # Where the outline still runs along a flat root the tooth has no height, which a very stiff
        # slice stands for; it points to where the flank begins and ends.
        whole = (between(np.ones_like(w), w) - between(np.full_like(w, self.body.foot), w)) / (
            1.0 - self.body.foot
        )
        flat = np.linalg.norm(up, axis=1) < FLAT * np.linalg.norm(whole, axis=1)
        up = np.where(flat[:, None], FLAT * whole, up)
        rise = np.linalg.norm(up, axis=1)
        normal = np.cross(run, up)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        chord = outline(z, w, 1) - outline(z, w, -1)
        thickness = np.sum(chord * normal, axis=1)
        return _Station(
            up=up / rise[:, None],
            out=np.sign(thickness)[:, None] * normal,
            rise=rise,
            run=np.linalg.norm(run, axis=1),
            thickness=np.abs(thickness),
        )

    def _basis(self, zw: Array) -> tuple[Array, Array, Array]:
        """Products of Legendre polynomials at places (n, 2), and their slopes over z and w."""
        from numpy.polynomial import legendre

        z, w = zw[:, 0], zw[:, 1]
        place = np.interp(z, self._u, self._height) / self._height[-1]
        slope = np.interp(z, 0.5 * (self._u[1:] + self._u[:-1]), self._slope) / self._height[-1]
        sets = []
        for at, degree in zip((place, w), self._degrees, strict=True):
            values = legendre.legvander(2.0 * at - 1.0, degree)
            lower = legendre.legder(np.eye(degree + 1))
            slopes = 2.0 * legendre.legvander(2.0 * at - 1.0, degree - 1) @ lower
            sets.append((values, slopes))
        (f, df), (g, dg) = sets

        def products(a: Array, b: Array) -> Array:
            return (a[:, :, None] * b[:, None, :]).reshape(len(a), -1)

        return products(f, g), products(slope[:, None] * df, g), products(f, dg)

    @property
    def _slope(self) -> Array:
        """Height per unit of u between the knots of the middle line."""
        return np.diff(self._height) / np.diff(self._u)

    def _factors(self) -> tuple[Array, Array]:
        """Cholesky factors of the plate's stiffness and of that of its compression."""
        from scipy.linalg import cholesky

        e, nu = self.body.youngs_modulus, self.body.poisson
        plane, shear = e / (1.0 - nu**2), 0.5 * e / (1.0 + nu)
        zw, area = self._quadrature()
        at = self._station(zw)
        value, over_z, over_w = self._basis(zw)
        over_z, over_w = over_z / at.rise[:, None], over_w / at.run[:, None]
        weight = area * at.rise * at.run
        t = at.thickness
        bend, stiff = weight * plane * t**3 / 12.0, weight * SHEAR_FACTOR * shear * t
        zero = np.zeros_like(value)
        # Strains of the fields deflection, rotation about the tooth line, rotation about the
        # height: two curvatures (as sum and difference), twist, two shears.
        plate = _gram(
            (0.5 * (1.0 + nu) * bend, [zero, over_z, over_w]),
            (0.5 * (1.0 - nu) * bend, [zero, over_z, -over_w]),
            (0.5 * (1.0 - nu) * bend, [zero, over_w, over_z]),
            (stiff, [over_z, -value, zero]),
            (stiff, [over_w, zero, -value]),
        )
        axial = _gram((weight * plane * t, [over_z]), (weight * shear * t, [over_w]))

        w, length = _gauss(0.0, 1.0, self._degrees[1] + 2)
        root = np.column_stack([np.full_like(w, self.middle.waist), w])
        at = self._station(root)
        value = self._basis(root)[0]
        zero = np.zeros_like(value)
        length = length * at.run
        unit = plane * length  # the root formulas are compliances over (1 − ν²)/E
        slip = (1.0 - 2.0 * nu) / (1.0 - nu)
        # Of deflection and lean (rotation times thickness) over shear force and moment / thickness.
        springs = np.linalg.inv(np.array([[1.534, slip], [slip, 16.67 / np.pi]]))
        lean = value * at.thickness[:, None]
        plate += _gram(
            (unit * springs[0, 0], [value, zero, zero]),
            (unit * springs[1, 1], [zero, lean, zero]),
        )
        count = value.shape[1]
        mixed = springs[0, 1] * (value * unit[:, None]).T @ lean
        plate[:count, count : 2 * count] += mixed
        plate[count : 2 * count, :count] += mixed.T
        axial += _gram((unit * 2.4 * (1.0 + nu) / 1.534, [value]))
        return cholesky(plate, lower=True), cholesky(axial, lower=True)

    def _quadrature(self) -> tuple[Array, Array]:
        """Gauss points (n, 2) and weights (n,) over tooth height (in two parts) and width."""
        foot = self.body.foot
        low, high = _gauss(self.middle.waist, foot, 5), _gauss(foot, 1.0, 8)
        z, over_z = (np.concatenate(pair) for pair in zip(low, high, strict=True))
        w, over_w = _gauss(0.0, 1.0, self._degrees[1] + 2)
        places = np.stack(np.meshgrid(z, w, indexing="ij"), axis=-1).reshape(-1, 2)
        return places, np.outer(over_z, over_w).ravel()


def _middle_line(middle: MiddleSurface) -> tuple[Array, Array]:
    """Knots in u with the height above the root section, half-way over the width [m]."""
    u = np.linspace(middle.waist, 1.0, 201)
    points = middle.between(u, np.full_like(u, 0.5))
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return u, np.concatenate([[0.0], np.cumsum(steps)])


def _gauss(low: float, high: float, count: int) -> tuple[Array, Array]:
    """Gauss points and weights on an interval."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    half = 0.5 * (high - low)
    return low + half * (nodes + 1.0), half * weights


def _gram(*terms: tuple[Array, list[Array]]) -> Array:
    """Sum of Bᵀ diag(weight) B over terms whose B stands in blocks of columns."""
    stacked = np.vstack([np.sqrt(weight)[:, None] * np.hstack(blocks) for weight, blocks in terms])
    return np.asarray(stacked.T @ stacked)
