"""Compliance of a gear without finite elements: slices of the tooth, coupled as a plate, on a ring.

A slice of the tooth across its face width is Weber and Banaschek's cantilever: bending, shear and
axial compression along its middle line from the potential energy of the true thickness, on a root
that yields by the half-plane formulas. Transverse bending, twist and shear couple neighbouring
slices, which makes the tooth a Mindlin plate of variable thickness on an elastic root. Its
deflections are polynomials along the tooth's height and over its width (Ritz), so under a load
that is uniform over the width each slice is exactly the cantilever.

The gear's body is a ring that carries the root's load averaged over the width, which follows from
statics alone. For that mean the ring's compliance replaces the half-plane's, so nothing counts
twice; for the neighbours of the loaded tooth, which the half-plane does not move, it is added.

Left out: the effect on the body of a load that varies over the width. Sources: C. Weber and
K. Banaschek (1953); R. W. Cornell, Compliance and stress sensitivity of spur gear teeth, J. Mech.
Des. 103 (1981), for the root; P. Gagnon, C. Gosselin and L. Cloutier, J. Mech. Des. 119 (1997), for
gear teeth as Mindlin plates; for the ring see :mod:`loadshare.tooth.compliance.ring`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, cached_property

import numpy as np

from loadshare.tooth.compliance.interface import Compliance, Flank
from loadshare.tooth.compliance.middle import under, waist_of
from loadshare.tooth.compliance.plate import ROOT_TANGENT, Plate, root_compliance
from loadshare.tooth.compliance.ring import Ring
from loadshare.tooth.compliance.sheet import Sheet
from loadshare.tooth.compliance.smooth import SmoothMiddle
from loadshare.tooth.geometry.body import Array, ToothBody

LEAN = 18.0 / np.pi
"""Lean of a half-plane's edge under a linear traction, from its work as in `Ring`."""
ROUND = 40.0
"""Radius, in rim depths, of the ring that replaces the flat body of a face gear."""


class Slices(Compliance):
    """Bending, shear, compression, root and body of one gear by closed forms.

    Parameters
    ----------
    body : ToothBody
    side : {+1, −1}
        The flank that carries load.
    width_degree : int, optional
        Degree of the polynomials over the width; by default it follows from the width over the
        height and the number of axial pitches.
    rigid_body : bool
        Whether the teeth are on half-planes instead of the gear's body: Weber and Banaschek's
        plane theory.
    """

    def __init__(
        self,
        body: ToothBody,
        side: int,
        width_degree: int | None = None,
        *,
        rigid_body: bool = False,
    ) -> None:
        self.body, self.side, self.rigid_body = body, side, rigid_body
        self.middle = SmoothMiddle(body, waist_of(body, ROOT_TANGENT))
        self._plate = Plate(self.middle, width_degree)
        self._flank = Sheet(np.linspace(body.foot, 1.0, 9), np.linspace(0.0, 1.0, 9))
        self._feet = self.middle.feet(self._flank.places, side)
        self._loads = np.hstack([self._on_plate(), self._at_root()])
        self._moved = cache(self._through_body)

    def bulks(self, positions: Sequence[tuple[Flank, ...]]) -> list[Array]:
        """See :meth:`loadshare.tooth.compliance.interface.Compliance.bulks`."""
        uw = np.concatenate([flank.uw for flanks in positions for flank in flanks])
        loads = self._flank.weights(uw) @ self._loads
        fields, start, found = self._plate.fields(*loads[:, :4].T), 0, []
        for flanks in positions:
            lengths = [len(flank.uw) for flank in flanks]
            part = slice(start, start := start + sum(lengths))
            tooth = np.array([flank.tooth for flank in flanks])
            line = np.repeat(np.arange(len(flanks)), lengths)
            same = tooth[line][:, None] == tooth[line]
            total = np.where(same, fields[part] @ fields[part].T, 0.0)
            if not self.rigid_body:
                carried = loads[part, 4:, None] * (line[:, None, None] == np.arange(len(flanks)))
                carried = carried.reshape(len(line), -1)
                moved = np.array([[self._moved(int(a - b)) for b in tooth] for a in tooth])
                moved = moved.transpose(2, 0, 3, 1).reshape(carried.shape[1], -1)
                total += carried @ moved @ carried.T
            found.append(0.5 * (total + total.T))
        return found

    def _on_plate(self) -> Array:
        """Return height, w, and components across and along the tooth (nodes, 4) of unit forces.

        A force whose line meets the middle surface below the root section acts at the root section.
        """
        zw = self._feet.zw.copy()
        zw[:, 0] = np.maximum(zw[:, 0], self.middle.waist)
        at = self._plate.station(zw)
        parts = (np.sum(self._feet.inward * unit, axis=1) for unit in (at.out, at.up))
        return np.column_stack([self.middle.height(zw[:, 0])[0], zw[:, 1], *parts])

    def _at_root(self) -> Array:
        """Return shear, moment over thickness and pull (nodes, 3) at the root from unit forces."""
        zw = self._flank.places.copy()
        zw[:, 0] = self.middle.waist
        at = self._plate.station(zw)
        arm = self._feet.flank - at.middle
        shear, pull = (np.sum(self._feet.inward * unit, axis=1) for unit in (at.out, at.up))
        moment = shear * np.sum(arm * at.up, axis=1) - pull * np.sum(arm * at.out, axis=1)
        return np.column_stack([shear, moment / self._ring.thickness, pull])

    @cached_property
    def _ring(self) -> Ring:
        """The gear's body, with the root section at mid-width."""
        middle = np.array([[self.middle.waist, 0.5]])
        root = self.middle.points(middle)
        radius = float(np.hypot(root[0, 0], root[0, 1]))
        depth = float(np.linalg.norm(under(self.body, root) - root))
        loaded = ROUND * depth if self.body.gear.shape == "face" else radius
        return Ring(
            loaded=loaded,
            held=loaded + depth if self.body.gear.shape == "internal" else loaded - depth,
            thickness=float(self._plate.station(middle).thickness[0]),
            width=self._plate.width,
            teeth=self.body.gear.teeth * loaded / radius,
            poisson=self.body.gear.poisson,
        )

    def _through_body(self, k: int) -> Array:
        """Return the compliance (3, 3) [m/N, …] that the body adds between teeth `k` apart."""
        found, nu = self._ring.root(k), self.body.gear.poisson
        if k == 0:
            local = root_compliance(nu)
            local[1, 1] = LEAN
            found = found - local
        return found * (1.0 - nu**2) / (self.body.gear.youngs_modulus * self._plate.width)
