"""One tooth as a plate of coupled slices on an elastic root, by Ritz's method."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from math import ceil

import numpy as np
from numpy.polynomial.legendre import legder, leggauss, legvander

from loadshare.errors import Refused
from loadshare.tooth.compliance.smooth import SmoothMiddle
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import dot

HEIGHT_DEGREE = 6
"""Degree of the polynomials along the tooth's height."""
FEWEST, STRAIGHT, MOST = 6, 18, 128
"""Degrees of the polynomials over the width: the least, the largest for straight teeth, whose load
is uniform, and the largest of all."""
PER_PITCH = 6
"""Degrees per axial pitch of the face width: the load on a helical face varies once per pitch."""
ROOT_TANGENT = 60.0
"""Angle [degrees] between fillet and chord at the root section: the standard's 30° tangent."""
OVER = 2
"""Number of Gauss points over the width beyond the degree of the polynomials."""
SHEAR_FACTOR = 5.0 / 6.0
FLAT = 0.01
"""Least rise of the middle surface per unit of u, relative to the tooth's height."""


@dataclass(frozen=True, slots=True, eq=False)
class Station:
    """The middle surface at some places: points and unit vectors (n, 3), slopes, thickness (n,).

    `up` points to the tip, `out` to side +1; `rise` and `run` are lengths per unit of u and of w.
    """

    middle: Array
    up: Array
    out: Array
    rise: Array
    run: Array
    thickness: Array

    def rows(self, part: slice) -> Station:
        """Return some of the places."""
        return Station(*(getattr(self, name)[part] for name in self.__slots__))


def root_compliance(poisson: float) -> Array:
    """Return the compliance of Weber and Banaschek's half-plane under a slice, in Cornell's form.

    Returns
    -------
    array (3, 3)
        In units of (1 − ν²)/E per width: deflection, lean times thickness, and lift, for shear
        force, moment over thickness, and pull.
    """
    slip = (1.0 - 2.0 * poisson) / (1.0 - poisson)
    lift = 1.534 / (2.4 * (1.0 + poisson))
    return np.array([[1.534, slip, 0.0], [slip, 16.67 / np.pi, 0.0], [0.0, 0.0, lift]])


class Plate:
    """Deflection and compression of a tooth between root section and tip.

    Parameters
    ----------
    middle : SmoothMiddle
        The tooth from the root section up.
    width_degree : int, optional
        Degree of the polynomials over the width; by default it follows from the width over the
        height and the number of axial pitches.

    Raises
    ------
    Refused
        If the face has more axial pitches than the polynomials can follow.
    """

    def __init__(self, middle: SmoothMiddle, width_degree: int | None = None) -> None:
        self.middle = middle
        ends = middle.points(np.array([[middle.waist, 0.0], [middle.waist, 1.0]]))
        slenderness = float(np.linalg.norm(ends[1] - ends[0])) / middle.whole_height
        width = width_degree or _width_degree(slenderness, middle.body.axial_pitches)
        self._degrees = HEIGHT_DEGREE, width
        self.bending, self.compression = self._yielding()

    def station(self, zw: Array) -> Station:
        """Return the middle surface and the thickness across it at places (n, 2)."""
        at = self.middle.sample(*zw.T)
        up, rise = at.middle_u, np.linalg.norm(at.middle_u, axis=1)
        flat = rise < FLAT * self.middle.whole_height
        if flat.any():
            # Where the outline still runs along a flat root the tooth has no height; it is modelled
            # as a very stiff slice that points from the beginning of the flank to its end.
            w, foot = zw[flat, 1], self.middle.body.foot
            ends = (
                self.middle.points(np.column_stack([np.full_like(w, u), w])) for u in (1.0, foot)
            )
            whole = np.subtract(*ends) / (1.0 - foot)
            up, rise = up.copy(), rise.copy()
            up[flat], rise[flat] = FLAT * whole, FLAT * np.linalg.norm(whole, axis=1)
        normal = np.cross(at.middle_w, up)
        normal = normal / np.linalg.norm(normal, axis=1)[:, None]
        thickness = 2.0 * dot(at.half, normal)
        return Station(
            middle=at.middle,
            up=up / rise[:, None],
            out=np.sign(thickness)[:, None] * normal,
            rise=rise,
            run=np.linalg.norm(at.middle_w, axis=1),
            thickness=np.abs(thickness),
        )

    def fields(self, height: Array, w: Array, across: Array, along: Array) -> Array:
        """Return X (n, m) of the compliance X Xᵀ [m/N] between places, given by height share and w.

        `across` and `along` (n,) are the components of unit forces across and along the tooth.
        """
        over_height, over_width = (
            legvander(2.0 * place - 1.0, degree)
            for place, degree in zip((height, w), self._degrees, strict=True)
        )
        value = (over_height[:, :, None] * over_width[:, None, :]).reshape(len(w), -1)
        return np.hstack(
            [across[:, None] * (value @ self.bending), along[:, None] * (value @ self.compression)]
        )

    @cached_property
    def width(self) -> float:
        """Length of the root section along the tooth [m]."""
        _, length = self._over_width
        return float(length @ self.root.run)

    @cached_property
    def root(self) -> Station:
        """The root section at Gauss points over the width."""
        return self._sections[0]

    @cached_property
    def _sections(self) -> tuple[Station, Station]:
        """The root section, and those at Gauss points over the height, each over the width."""
        (z, _), (w, _) = self._over_height, self._over_width
        z = np.concatenate([[self.middle.waist], z])
        at = self.station(np.stack(np.meshgrid(z, w, indexing="ij"), axis=-1).reshape(-1, 2))
        return at.rows(slice(len(w))), at.rows(slice(len(w), None))

    @cached_property
    def _over_height(self) -> tuple[Array, Array]:
        foot = self.middle.body.foot
        z, over_z = np.hstack([_gauss(self.middle.waist, foot, 5), _gauss(foot, 1.0, 8)])
        return z, over_z

    @cached_property
    def _over_width(self) -> tuple[Array, Array]:
        return _gauss(0.0, 1.0, self._degrees[1] + OVER)

    def _yielding(self) -> tuple[Array, Array]:
        """Return the factors X of the compliances X Xᵀ of deflection and of compression."""
        from scipy.linalg import cholesky, solve_triangular

        e, nu = self.middle.body.gear.youngs_modulus, self.middle.body.gear.poisson
        plane, shear = e / (1.0 - nu**2), 0.5 * e / (1.0 + nu)
        (z, over_z), (w, over_w) = self._over_height, self._over_width
        at = self._sections[1]
        rise, run, t = (x.reshape(len(z), len(w)) for x in (at.rise, at.run, at.thickness))
        area = np.outer(over_z, over_w) * rise * run
        bend, stiff = area * plane * t**3 / 12.0, area * SHEAR_FACTOR * shear * t
        place, slope = self.middle.height(z)
        f, df = _legendre(place, self._degrees[0])
        df *= slope[:, None]
        g, dg = _legendre(w, self._degrees[1])

        # Fields: deflection v, rotation p about the tooth line, rotation q about the height, with
        # the strain energy ½ bend (p_z² + q_w² + 2ν p_z q_w + ½(1 − ν)(p_w + q_z)²) and
        # ½ stiff ((v_z − p)² + (v_w − q)²).
        twist = 0.5 * (1.0 - nu)
        zz = _product(bend / rise**2, df, df, g, g)
        ww = _product(bend / run**2, f, f, dg, dg)
        square = _product(stiff, f, f, g, g)
        both = bend / (rise * run)
        vv = _product(stiff / rise**2, df, df, g, g) + _product(stiff / run**2, f, f, dg, dg)
        pp, qq = zz + twist * ww + square, ww + twist * zz + square
        pq = nu * _product(both, df, f, g, dg) + twist * _product(both, f, df, dg, g)
        pv, qv = -_product(stiff / rise, f, df, g, g), -_product(stiff / run, f, f, g, dg)
        axial = _product(area * plane * t / rise**2, df, df, g, g)
        axial += _product(area * shear * t / run**2, f, f, dg, dg)

        springs = np.linalg.inv(root_compliance(nu))
        f = (-1.0) ** np.arange(self._degrees[0] + 1.0)[None]  # Legendre's polynomials at the root
        unit, t = (plane * over_w * self.root.run)[None], self.root.thickness
        vv += _product(springs[0, 0] * unit, f, f, g, g)
        pv += _product(springs[0, 1] * unit * t, f, f, g, g)
        pp += _product(springs[1, 1] * unit * t**2, f, f, g, g)
        axial += _product(springs[2, 2] * unit, f, f, g, g)

        count = len(vv)
        plate = np.block([[qq, pq.T, qv], [pq, pp, pv], [qv.T, pv.T, vv]])
        # Forces act on the deflection alone, so eliminating the rotations leaves its block.
        lower = (
            cholesky(matrix.T, lower=True, overwrite_a=True, check_finite=False)[-count:, -count:]
            for matrix in (plate, axial)
        )
        bending, compression = (
            solve_triangular(root, np.eye(count), lower=True, check_finite=False).T
            for root in lower
        )
        return bending, compression


def _width_degree(slenderness: float, axial_pitches: float) -> int:
    """Return the degree for a face of given tooth heights (slenderness) and axial pitches."""
    follows = max(STRAIGHT, ceil(PER_PITCH * axial_pitches))
    degree = int(np.clip(ceil(3.0 + 2.0 * slenderness), FEWEST, follows))
    if degree > MOST:
        raise Refused(
            f"a face of {axial_pitches:.3g} axial pitches is wider than slices can model; "
            f"allowed: up to {MOST // PER_PITCH}; analyse part of the face, with the same load "
            "per width"
        )
    return degree


def _gauss(low: float, high: float, count: int) -> tuple[Array, Array]:
    """Return Gauss points and weights on an interval."""
    nodes, weights = _leggauss(count)
    half = 0.5 * (high - low)
    return np.asarray(low + half * (nodes + 1.0)), np.asarray(half * weights)


_leggauss = cache(leggauss)


def _legendre(place: Array, degree: int) -> tuple[Array, Array]:
    """Return Legendre polynomials (n, degree + 1) at places from 0 to 1, and their slopes."""
    values = np.asarray(legvander(2.0 * place - 1.0, degree), np.float64)
    return values, 2.0 * values[:, :degree] @ _legder(degree)


@cache
def _legder(degree: int) -> Array:
    """Return coefficients (degree, degree + 1) of the slopes of Legendre polynomials."""
    return np.asarray(legder(np.eye(degree + 1)))


def _product(weight: Array, a: Array, b: Array, c: Array, d: Array) -> Array:
    """Sum weights times products of functions of the height and of the width over all points.

    Entry (ij, kl) is Σ weight(z, w) a_i(z) c_j(w) b_k(z) d_l(w), summed over w first.
    """
    width = (c[:, :, None] * d[:, None, :]).reshape(len(c), -1)
    height = (a[:, :, None] * b[:, None, :]).reshape(len(a), -1)
    found = (height.T @ (weight @ width)).reshape(a.shape[1], b.shape[1], c.shape[1], d.shape[1])
    return np.asarray(found.transpose(0, 2, 1, 3).reshape(a.shape[1] * c.shape[1], -1))
