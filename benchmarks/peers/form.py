"""The common problem that every peer is given, dimensionless and with rows of unit norm.

It is the whole scene of one sample, except that coordinates that only springs touch are condensed:
nothing else is left out and nothing is decided. Peers that need an outer loop share one (`loop`);
their answer is turned back into an equilibrium of the train, and judged like any other.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from loadshare.contact.law import PowerLaw
from loadshare.contact.problem import ArcRow, Row
from loadshare.contact.radial import RadialLaw
from loadshare.scene.scene import GearRadial, Scene
from loadshare.train.equilibrium import Equilibrium

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """Exclusion arcs: |start + relative x| ≥ allowed.

    Attributes
    ----------
    rows : ndarray of int, shape (k,)
        Indices of their rows in the form.
    start : ndarray, shape (k, 3)
    relative : ndarray, shape (k, 3, n)
    allowed : ndarray, shape (k,)
    margin_at_rest : ndarray, shape (k,)
        Computed without cancellation.
    sagitta : ndarray, shape (k,)
        Space that the arc leaves free beyond its face at rest.
    """

    rows: NDArray[np.intp]
    start: Array
    relative: Array
    allowed: Array
    margin_at_rest: Array
    sagitta: Array

    def faces(self, x: Array) -> tuple[Array, Array]:
        """Return the tangent faces at x: rows (k, n) before normalisation, and gaps (k,)."""
        moved = self.relative @ x
        d = self.start + moved
        here = np.sqrt(np.einsum("ki,ki->k", d, d))
        rest = np.sqrt(np.einsum("ki,ki->k", self.start, self.start))
        grown = 2.0 * np.einsum("ki,ki->k", self.start, moved) + np.einsum("ki,ki->k", moved, moved)
        margin = self.margin_at_rest + grown / (here + rest)
        normal = d / here[:, None]
        vectors = -np.einsum("ki,kin->kn", normal, self.relative)
        return vectors, margin + vectors @ x


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """A radial element on q = P x − m; if `follows`, its law depends on the torque."""

    radial: GearRadial
    matrix: Array
    centre: Array
    follows: bool


@dataclass(frozen=True, slots=True, eq=False)
class Form:
    """One sample as every peer receives it.

    Attributes
    ----------
    scene : Scene
    stiffness : ndarray, shape (n, n)
    load : ndarray, shape (n,)
    names : tuple of str
        Of the rows.
    rows : ndarray, shape (m, n)
        Of unit norm; an arc is represented by its face at rest.
    gaps : ndarray, shape (m,)
    linear, hertz : ndarray, shape (m,)
        Coefficients b and c; both zero for a rigid contact.
    arcs : Arcs
    graphs : tuple of Graph
    driven : ndarray of bool, shape (m,)
        Drive flanks.
    force, length : float
        Units [N], [m].
    norms : ndarray, shape (m,)
        Of the SI rows.
    """

    scene: Scene
    stiffness: Array
    load: Array
    names: tuple[str, ...]
    rows: Array
    gaps: Array
    linear: Array
    hertz: Array
    arcs: Arcs
    graphs: tuple[Graph, ...]
    driven: NDArray[np.bool_]
    force: float
    length: float
    norms: Array

    @property
    def kind(self) -> str:
        """Class of its programmes, "QP" or "SOCP"."""
        return "SOCP" if self.graphs else "QP"

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.load)

    @property
    def curved(self) -> bool:
        """Whether an outer loop is needed."""
        follows = any(g.follows for g in self.graphs)
        return bool(self.hertz.any() or len(self.arcs.rows) or follows)

    def forces_in_newton(self, forces: Array) -> dict[str, float]:
        """Return the row forces [N] by name."""
        values = forces * self.force / self.norms
        return {n: float(f) for n, f in zip(self.names, values, strict=True)}

    def laws(self, forces: Array) -> tuple[RadialLaw, ...]:
        """Return the radial laws at the torques that row forces produce."""
        found: dict[str, float] = {}
        if any(g.follows for g in self.graphs):
            found = self.forces_in_newton(forces)
        train = self.scene.train
        return tuple(
            g.radial.law(train.transmitted(g.radial.gear, found) if g.follows else 0.0).scaled(
                self.force, self.length
            )
            for g in self.graphs
        )

    def only(self, names: Collection[str]) -> Form:
        """Return the same form with only the named rows."""
        kept = np.array([k for k, n in enumerate(self.names) if n in names], dtype=np.intp)
        arcs = np.isin(self.arcs.rows, kept)
        some = {
            f.name: getattr(self.arcs, f.name)[arcs] for f in fields(self.arcs) if f.name != "rows"
        }
        return replace(
            self,
            names=tuple(self.names[k] for k in kept),
            arcs=Arcs(rows=np.searchsorted(kept, self.arcs.rows[arcs]), **some),
            **{
                name: getattr(self, name)[kept]
                for name in ("rows", "gaps", "linear", "hertz", "driven", "norms")
            },
        )

    def equilibrium(self, x: Array, forces: Array, pulls: Sequence[Array]) -> Equilibrium:
        """Return an answer as an equilibrium in SI units; negative forces count as zero.

        Parameters
        ----------
        x : ndarray, shape (n,)
        forces : ndarray, shape (m,)
        pulls : sequence of ndarray, shape (2,)
            Force of every graph against its offset.
        """
        scene, train = self.scene, self.scene.train
        full = scene.condensation.expand(np.asarray(x) * self.length)
        carried = self.forces_in_newton(np.asarray(forces))
        flanks = {r.name for r in scene.rows if r.kind.endswith("flank")}
        rings = [r.name for r in scene.rows if r.kind == "stop"] + [a.name for a in scene.arcs]
        return Equilibrium(
            index=scene.position,
            rotation={g: scene.angle(g, full) for g in train.gears},
            displacement={g: scene.moved(g, full) for g in train.gears},
            flank_force={n: max(carried.get(n, 0.0), 0.0) for n in flanks},
            ring_force={n: max(carried.get(n, 0.0), 0.0) for n in rings},
            radial_reaction={
                g.radial.name: -np.asarray(p) * self.force @ train.gears[g.radial.gear].frame
                for g, p in zip(self.graphs, pulls, strict=True)
            },
        )


def form_of(scene: Scene, like: Form | None = None) -> Form:
    """Return a scene as the common problem, in its own units or those of another sample.

    Raises
    ------
    TypeError
        If a mesh law is a table.
    """
    force = like.force if like else scene.force_unit()
    length = like.length if like else scene.length_unit()
    condensed = scene.condensation
    expansion = condensed.expansion
    rows: list[Row | ArcRow] = [r for r in scene.rows if r.vector.any()]
    rows += scene.arcs
    at_rest = np.zeros(scene.size)
    written = [r.row(at_rest) if isinstance(r, ArcRow) else r for r in rows]
    vectors = np.array([r.vector for r in written]).reshape(len(rows), scene.size) @ expansion
    norms = np.linalg.norm(vectors, axis=1)
    # Condensed coordinates are a linear function of the others; its constant part shifts the gaps.
    shift = np.array([float(r.vector @ condensed.constant) for r in written])
    linear, hertz = np.zeros(len(rows)), np.zeros(len(rows))
    for e, (row, norm) in enumerate(zip(rows, norms, strict=True)):
        if not isinstance(row.law, PowerLaw):
            raise TypeError(f"{row.name}: peers are not given tables")
        law = row.law.scaled(force / norm, length * norm)
        linear[e], hertz[e] = law.b, law.c
    gaps = np.array([r.gap for r in written])
    load = expansion.T @ (scene.load - scene.stiffness @ condensed.constant)
    return Form(
        scene=scene,
        stiffness=expansion.T @ scene.stiffness @ expansion * length / force,
        load=load / force,
        names=tuple(r.name for r in rows),
        rows=vectors / norms[:, None],
        gaps=(gaps - shift) / (length * norms),
        linear=linear,
        hertz=hertz,
        arcs=_arcs(scene, len(rows) - len(scene.arcs), expansion, length),
        graphs=tuple(
            Graph(r, r.matrix @ expansion, r.centre / length, r.follows_torque)
            for r in scene.radials
        ),
        driven=np.array([isinstance(r, Row) and r.kind == "drive flank" for r in rows], dtype=bool),
        force=force,
        length=length,
        norms=norms,
    )


def _arcs(scene: Scene, first: int, expansion: Array, length: float) -> Arcs:
    count, size = len(scene.arcs), expansion.shape[1]
    none = np.zeros(3)
    return Arcs(
        rows=np.arange(first, first + count),
        start=np.array([a.arc.start for a in scene.arcs]).reshape(count, 3) / length,
        relative=np.array([a.relative @ expansion for a in scene.arcs]).reshape(count, 3, size),
        allowed=np.array([a.arc.distance - a.arc.clearance for a in scene.arcs]) / length,
        margin_at_rest=np.array([a.arc.margin(none) for a in scene.arcs]) / length,
        sagitta=np.array([a.sagitta for a in scene.arcs]) / length,
    )
