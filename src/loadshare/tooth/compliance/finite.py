"""Compliance of a gear from finite elements: a few teeth with their rim."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from loadshare.tooth.compliance.block import BlockMesh, Divisions, block_mesh
from loadshare.tooth.compliance.interface import Compliance, Flank
from loadshare.tooth.compliance.middle import MiddleSurface, under
from loadshare.tooth.compliance.sheet import Sheet
from loadshare.tooth.compliance.solid import Solid, build_solid
from loadshare.tooth.geometry.body import Array, ToothBody, turned

REACH = 4.0
"""Distance from the loaded tooth to the cut, in rim depths."""
COARSEST, STEEP = 0.65, 3.0
"""Largest depth of the rim's elements next to the root, over the height of a flank; growth of the
elements' depths where more than the usual number would be required."""


class FiniteElements(Compliance):
    """Bending, shear, root and rim of one gear from quadratic hexahedra.

    Tooth 0 is in the middle of `teeth` teeth, whose rim continues without teeth on either side;
    the rim is clamped on its free side and where it is cut from the gear. Every flank node is
    loaded in turn along its normal, and the displacements of all teeth's middle surfaces are read,
    so the influence of a loaded tooth on its neighbours is included. As all teeth are alike, one
    set of loads serves every tooth.

    Parameters
    ----------
    body : ToothBody
    side : {+1, −1}
        The flank that carries load.
    teeth : int
        Number of teeth in the model, odd; teeth farther apart than half of it do not interact.
    bare : sequence of int, optional
        Lengths in pitches of the elements of bare rim on either side; by default enough for the
        cut to be four rim depths away from the loaded tooth.
    divisions : Divisions, optional
        Of the loaded tooth; by default the number of layers follows from the face width.

    Raises
    ------
    ValueError
        If `teeth` is even, or the number of elements across the tooth is odd (the middle surface
        must be a sheet of nodes).
    """

    def __init__(
        self,
        body: ToothBody,
        side: int,
        teeth: int = 3,
        bare: Sequence[int] | None = None,
        divisions: Divisions | None = None,
    ) -> None:
        n = divisions or default_divisions(body)
        if teeth % 2 == 0 or not 1 <= teeth <= most_teeth(body.gear.teeth):
            raise ValueError(
                f"teeth = {teeth}: the model has tooth 0 in its middle; allowed: odd numbers below "
                f"the {body.gear.teeth} teeth of the gear"
            )
        if n.across % 2:
            raise ValueError(
                f"across = {n.across}: the middle surface must be a sheet of nodes; allowed: even"
            )
        self.body, self.side, self.divisions = body, side, n
        self.middle = MiddleSurface(body)
        bare = _bare_rim(body, teeth) if bare is None else bare
        mesh = block_mesh(self.middle, teeth, bare, n, n.coarser())
        solid = build_solid(mesh, body.gear.youngs_modulus, body.gear.poisson)
        self.size = solid.size
        self._flank = Sheet(n.levels(self.middle)[2 * n.fillet :], n.stations())
        self._feet = self.middle.feet(self._flank.places, side)
        self._influence = self._solve(mesh, solid)

    def bulks(self, positions: Sequence[tuple[Flank, ...]]) -> list[Array]:
        """See :meth:`loadshare.tooth.compliance.interface.Compliance.bulks`."""
        return [self._between(flanks) for flanks in positions]

    def _between(self, flanks: tuple[Flank, ...]) -> Array:
        """Return the compliance between all points of flanks."""
        weights = [self._flank.weights(f.uw) for f in flanks]
        ends = np.cumsum([0] + [w.shape[0] for w in weights])
        total = np.zeros((ends[-1], ends[-1]))
        for i, here in enumerate(flanks):
            for j, there in enumerate(flanks):
                influence = self._influence.get(here.tooth - there.tooth)
                if influence is not None:
                    part = weights[i] @ (weights[j] @ influence.T).T
                    total[ends[i] : ends[i + 1], ends[j] : ends[j + 1]] = part
        # Reading at a depth leaves a small skew part, which contradicts Betti's theorem.
        return 0.5 * (total + total.T)

    def _solve(self, mesh: BlockMesh, solid: Solid) -> dict[int, Array]:
        """Return, by tooth, displacements of all feet along their normals for loads on tooth 0."""
        n, body = self.divisions, self.body
        on_flank = mesh.teeth[0][0 if self.side < 0 else -1, -(2 * n.flank + 1) :]
        loaded = mesh.over_width(on_flank)[self._flank.present]
        forces = np.zeros((solid.size, len(loaded)))
        for axis in range(3):
            forces[solid.free[loaded, axis], np.arange(len(loaded))] = self._feet.inward[:, axis]

        sheets, read = {}, {}
        for k, grid in mesh.teeth.items():
            divisions = n if k == 0 else n.coarser()
            sheets[k] = Sheet(divisions.heights(self.middle), n.stations())
            read[k] = mesh.over_width(grid[divisions.across])[sheets[k].present]
        moved = solid.displacements(forces, np.concatenate(list(read.values())))
        parts = np.split(moved, np.cumsum([len(nodes) for nodes in read.values()])[:-1])
        influence = {}
        for (k, sheet), part in zip(sheets.items(), parts, strict=True):
            weights = sheet.weights(self._feet.zw)
            at_feet = (weights @ part.reshape(len(part), -1)).reshape(-1, *part.shape[1:])
            normals = turned(self._feet.inward, 2.0 * np.pi * k / body.gear.teeth)
            influence[k] = np.einsum("nij,ni->nj", at_feet, normals)
        return influence


def most_teeth(teeth: int) -> int:
    """Return the most teeth that a model can have: odd, with a space left where the rim is cut."""
    return teeth - 1 - teeth % 2


def _bare_rim(body: ToothBody, teeth: int) -> list[int]:
    """Return lengths of the rim's elements, growing by a pitch, to the cut four rim depths away."""
    pitch = float(np.linalg.norm(body.outline(0.0, 0.5, 1) - body.outline(0.0, 0.5, -1)))
    wanted = int(np.ceil(REACH * _rim_depth(body) / pitch)) - teeth // 2
    left = max(0, min(wanted, (body.gear.teeth - teeth - 1) // 2))
    lengths: list[int] = []
    while left > 0:
        # An element may bend through 20° at most, and turn no sliver over to the next.
        longest = min(len(lengths) + 1, max(1, body.gear.teeth // 18))
        lengths.append(min(longest, left))
        left -= lengths[-1]
    return lengths


def default_divisions(body: ToothBody) -> Divisions:
    """Return divisions with 5 to 12 layers, each about as deep as a flank is high.

    A deep rim has more elements than a shallow one: with too deep an element next to the root, the
    body would be too stiff.
    """
    w = np.array([0.0, 1.0])
    ends = body.outline(np.full(2, body.foot), w, 1)
    height = np.linalg.norm(body.outline(1.0, 0.5, 1) - body.outline(body.foot, 0.5, 1))
    layers = int(np.clip(np.ceil(1.2 * np.linalg.norm(ends[1] - ends[0]) / height), 5, 12))
    n = Divisions()
    while n.depths()[2] * _rim_depth(body) > COARSEST * height:
        n = replace(n, rim=n.rim + 1, growth=STEEP)
    return replace(n, width=layers)


def _rim_depth(body: ToothBody) -> float:
    """Return how deep the body is below the middle of a root space [m]."""
    space = body.outline(0.0, 0.5, 1)[None]
    return float(np.linalg.norm(under(body, space) - space))
