"""Teeth for tests of the mechanics, from first principles: an involute spur gear with a smooth
fillet, and two such gears in mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.tooth.unloaded.positions import ContactLine, MeshPosition


@dataclass(frozen=True)
class SpurTooth:
    """External involute spur tooth [m, rad] with a cubic fillet."""

    teeth: int
    module: float
    face_width: float
    rim: float
    shift: float = 0.0
    alpha: float = np.radians(20.0)
    addendum: float = 1.0
    dedendum: float = 1.25
    youngs_modulus: float = 206e9
    poisson: float = 0.3
    foot: float = 0.4
    shape: str = "external"
    axial_pitches: float = 0.0

    @property
    def gear(self):
        """Its dimensions: the tooth is its own gear."""
        return self

    @property
    def pitch_radius(self):
        return 0.5 * self.teeth * self.module

    @property
    def base_radius(self):
        return self.pitch_radius * np.cos(self.alpha)

    @property
    def tip_radius(self):
        return self.pitch_radius + self.module * (self.addendum + self.shift)

    @property
    def root_radius(self):
        return self.pitch_radius - self.module * (self.dedendum - self.shift)

    @property
    def start_radius(self):
        """Radius where the involute begins: a quarter module above the root, or the base circle."""
        return max(1.0005 * self.base_radius, self.root_radius + 0.25 * self.module)

    def half_angle(self, radius):
        """Return the angle from the tooth's middle to its flank."""
        inv = lambda a: np.tan(a) - a  # noqa: E731
        at = np.arccos(np.minimum(self.base_radius / radius, 1.0))
        half = (0.5 * np.pi + 2.0 * self.shift * np.tan(self.alpha)) / self.teeth
        return half + inv(self.alpha) - inv(at)

    def outline(self, u, w, side):
        u, w = np.broadcast_arrays(np.asarray(u, float), np.asarray(w, float))
        radius, angle = self._polar(u)
        z = (w - 0.5) * self.face_width
        return np.stack([radius * np.cos(angle), side * radius * np.sin(angle), z], axis=-1)

    def _polar(self, u):
        s = np.clip(u / self.foot, 0.0, 1.0)
        t = np.clip((u - self.foot) / (1.0 - self.foot), 0.0, None)
        start = self.start_radius
        radius = np.sqrt(start**2 + t * (self.tip_radius**2 - start**2))
        angle = self.half_angle(radius)
        r0, a0 = self.root_radius, np.pi / self.teeth
        r1, a1 = start, self.half_angle(start)
        slope = -np.sqrt(max(start**2 - self.base_radius**2, 0.0)) / (start * self.base_radius)
        # A cubic that is tangent to the root circle and to the involute.
        dr, length = r1 - r0, 1.5 * (r1 - r0)
        radius_f = r0 + s**2 * (3 * dr - length) + s**3 * (length - 2 * dr)
        da = 3.0 * (a1 - a0) / 2.0
        angle_f = self._cubic(s, a0, a1, da, slope * length)
        low = u < self.foot
        return np.where(low, radius_f, radius), np.where(low, angle_f, angle)

    @staticmethod
    def _cubic(s, y0, y1, d0, d1):
        return (
            y0 * (1 - s) ** 2 * (1 + 2 * s)
            + y1 * s**2 * (3 - 2 * s)
            + d0 * s * (1 - s) ** 2
            - d1 * s**2 * (1 - s)
        )

    def flank_u(self, radius):
        """Return u of a point of the involute at `radius`."""
        start = self.start_radius
        t = (radius**2 - start**2) / (self.tip_radius**2 - start**2)
        return self.foot + (1.0 - self.foot) * t


@dataclass(frozen=True)
class SpurPair:
    """Two spur teeth in mesh at the sum of their pitch radii, with optional lead crowning."""

    driver: SpurTooth
    driven: SpurTooth
    crowning: float = 0.0
    helices: int = 1
    overlap_ratio: float = 0.0
    driven_side: int = 1
    driven_step: int = -1

    @property
    def arm(self):
        return self.driver.base_radius

    @property
    def ratio(self):
        return self.driven.teeth / self.driver.teeth

    @property
    def _path(self):
        """Return the ends of the path of contact, from the pitch point [m], and the base pitch."""
        a, b = self.driver, self.driven
        leave = np.sqrt(a.tip_radius**2 - a.base_radius**2) - a.base_radius * np.tan(a.alpha)
        enter = np.sqrt(b.tip_radius**2 - b.base_radius**2) - b.base_radius * np.tan(b.alpha)
        return -enter, leave, np.pi * a.module * np.cos(a.alpha)

    @property
    def contact_ratio(self):
        enter, leave, pitch = self._path
        return (leave - enter) / pitch

    def positions(self, phases, points_per_line):
        return tuple(self._position(phase, points_per_line) for phase in phases)

    def _position(self, phase, points_per_line):
        a, b = self.driver, self.driven
        enter, leave, pitch = self._path
        n, width = points_per_line, a.face_width
        z = (np.arange(n) + 0.5) / n * width - 0.5 * width
        lines = []
        normal = np.array([np.sin(a.alpha), np.cos(a.alpha), 0.0])
        for k in range(-3, 4):
            g = (phase - k) * pitch
            if not enter < g < leave:
                continue
            rho = a.base_radius * np.tan(a.alpha) + g, b.base_radius * np.tan(b.alpha) - g
            r = np.hypot(a.base_radius, rho[0]), np.hypot(b.base_radius, rho[1])
            points = np.array([a.pitch_radius, 0.0, 0.0]) + g * normal + np.outer(z, [0, 0, 1])
            along = 8.0 * self.crowning / width**2
            w = z / width + 0.5
            lines.append(
                ContactLine(
                    pair=k,
                    points=points,
                    normals=np.tile(normal, (n, 1)),
                    length=np.full(n, width / n),
                    gap=self.crowning * (2.0 * z / width) ** 2,
                    curvature=np.full(n, 1.0 / rho[0] + 1.0 / rho[1]),
                    curvature_along=np.full(n, along),
                    driver_uw=np.column_stack([np.full(n, a.flank_u(r[0])), w]),
                    driven_uw=np.column_stack([np.full(n, b.flank_u(r[1])), w]),
                )
            )
        return MeshPosition(
            phase=phase,
            driver_rotation=phase * 2.0 * np.pi / a.teeth,
            driven_rotation=-phase * 2.0 * np.pi / b.teeth,
            transmission_error=0.0,
            lines=tuple(lines),
        )
