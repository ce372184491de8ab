r"""The proximal method of multipliers on the elements: for samples that exchange finds no set for.

Every pass adds a small stiffness and a small compliance that pull towards the pass before,

.. math:: \tfrac{\varepsilon}{2}\lVert x - x_k\rVert^2, \qquad
          a_e\cdot x - \delta_e(F_e) - \varepsilon (F_e - F_{e,k}) \le g_e ,

so that its energy is strictly convex and has a gradient everywhere, whatever opposes or repeats
itself. Newton's method with a line search always arrives at its minimum, and the passes converge to
an equilibrium if there is one. Arcs, as faces, and friction bounds are renewed between passes. What
a pass ends at is a set, and a start for the exact solve on it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from loadshare.scene.data import Data
from loadshare.scene.elements import Elements
from loadshare.scene.scene import Array
from loadshare.solver.hot import places as at
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.exchange import Codes, Found, exchange, first_sets
from loadshare.solver.hot.state import State, at_rest
from loadshare.solver.hot.vectorised import arc_at, beyond, piece, root_of

STIFFER = (1e-2, 1e-3, 1e-4, 1e-5, *[1e-6] * 3, *[1e-7] * 3, *[1e-8] * 6)
"""Stiffness that every pass adds, in units of the elements: what one moves is load/ε at most."""
SOFTER = 1e-11
"""Compliance that every pass adds: each brings forces nearer by ε over the compliance they meet.

Small from the first pass on, so that rigid arcs hold a gear on its side of a narrow wedge."""
RESOLVED = 1e3
"""Round-offs of the lengths at hand by which the compliance presses a contact in at least."""
SHARED = 1e3
"""How much softer a radial element is made than a contact, so that what both could hold is held by
the contact: friction is bounded, a contact is not."""
NEWTON = 60
"""Newton steps of a pass."""
SLOPE = 0.1
"""Part of the slope at its beginning to which a line search brings a step."""
HALVINGS = 12
"""Steps of a line search."""
LOOKS = 1500
"""Points at which a search looks in all: more than ever led to an answer, and half a second."""
FLAT = 1e-11
"""Gradient, over the largest force, at which a pass has arrived."""
STILL = 1e-15
"""Step, over the largest coordinate, that is round-off."""
TRIES = 3
"""Passes from which a set is solved exactly: a later one may stand nearer."""
EXCHANGES = 6
"""Sets that an exact solve visits from where the passes stand."""


@dataclass(slots=True)
class _Point:
    """Coordinates of a pass and what follows from them.

    Attributes
    ----------
    x : ndarray, shape (n,)
    force : ndarray, shape (m,)
    compliance : ndarray, shape (scalar elements,)
        Tangent; infinite where nothing pushes.
    stiffness : ndarray, shape (radial elements, 2, 2)
        Tangent.
    gradient : ndarray, shape (n,)
    """

    x: Array
    force: Array
    compliance: Array
    stiffness: Array
    gradient: Array


class Proximal:
    """The passes of one sample.

    Parameters
    ----------
    elements : Elements
    data : Data
        Of the sample alone.
    """

    def __init__(self, elements: Elements, data: Data) -> None:
        self.elements, self.data, self.rows = elements, data, np.zeros(1, dtype=int)
        self.springs, self.scalar = elements.springs, elements.springs + elements.rows
        self.load = data.load[0]
        self.gap = np.array(data.gap[0])
        self.vectors = np.array(elements.vectors)
        self.bending = data.bending[0][: self.scalar]
        self.hertz = data.hertz[0][: self.scalar]
        self.power = np.flatnonzero(self.hertz > 0.0)
        self.x = np.zeros(elements.scene.size)
        self.force = np.zeros(len(self.vectors))
        self.looks = 0
        self.pull, self.softer, self.graph = STIFFER[0], SOFTER, self._graphs()

    def passes(self) -> Iterator[Codes]:
        """Make one pass after another; each gives the set (switches,) where it ends."""
        for self.pull in STIFFER:
            extent = max(float(np.abs(v).max(initial=1.0)) for v in (self.gap, self.x))
            self.softer = max(SOFTER, RESOLVED * np.finfo(float).eps * extent)
            self._face_arcs()
            self.graph = self._graphs()
            if not self.graph.valid.all():
                return
            found = self._minimise()
            if self.looks > LOOKS:
                return
            code = self._code(found)
            self.x, self.force = found.x, found.force
            yield code

    def store(self, state: State) -> None:
        """Write down where the passes stand."""
        state.x[0], state.force[0], state.stays[0] = self.x, self.force, True
        state.root[0] = np.maximum(np.cbrt(np.maximum(self.force, 0.0)), state.floor[0])

    def _face_arcs(self) -> None:
        """Replace arcs by their faces at the last pass."""
        first = self.springs + len(self.elements.scene.rows)
        for a in range(len(self.elements.scene.arcs)):
            normal, margin = arc_at(self.data, a, self.rows, self.x[None, :])
            self.vectors[first + a] = -normal[0] @ self.data.relative[a]
            self.gap[first + a] = margin[0] + self.vectors[first + a] @ self.x

    def _graphs(self) -> at.Graph:
        """Radial laws at the torques of the last pass, with one element after another."""
        return at.graph(self.data.radial[0], self.data.carried @ self.force)

    def _minimise(self) -> _Point:
        """Newton's method on the energy of a pass."""
        here = self._at(self.x)
        for _ in range(NEWTON):
            largest = max(1.0, float(np.abs(here.force).max(initial=0.0)))
            if np.abs(here.gradient).max(initial=0.0) <= FLAT * largest:
                break
            step = self._step(here)
            here = self._along(here, step)
            if np.abs(step).max() <= STILL * np.abs(here.x).max() or self.looks > LOOKS:
                break
        return here

    def _at(self, x: Array) -> _Point:
        """Forces, tangents and gradient at coordinates."""
        scalar, pull = self.scalar, self.softer
        self.looks += 1
        u = self.vectors @ x - self.gap
        u[:scalar] += pull * self.force[:scalar]
        pushed = u[:scalar] > 0.0
        pushed[: self.springs] = True
        compliance = self.bending + pull
        force = np.zeros(len(u))
        force[:scalar] = u[:scalar] / compliance
        if len(self.power):
            b, c = compliance[self.power], self.hertz[self.power]
            root = root_of(b, c, np.where(pushed[self.power], u[self.power], 1.0))
            force[self.power] = root**3
            compliance[self.power] += 2.0 / 3.0 * c / root
        for k in np.flatnonzero(self.data.tabulated >= 0).tolist():
            force[k], compliance[k] = self._by_table(k, float(u[k]))
        force[:scalar][~pushed] = 0.0
        compliance[~pushed] = np.inf
        reaction, stiffness = self._radials(u[scalar:].reshape(-1, 2))
        force[scalar:] = reaction.ravel()
        gradient = self.vectors.T @ force - self.load + self.pull * (x - self.x)
        return _Point(x, force, compliance, stiffness, gradient)

    def _by_table(self, k: int, u: float) -> tuple[float, float]:
        """Force and tangent compliance of a tabulated law."""
        table = self.data.tables[:, self.data.tabulated[k]]
        forces, compressions = table[:, 0], table[:, 1] + self.softer * table[:, 0]
        start, value, slope = piece(compressions, forces, compressions, np.array([u]))
        return float(value[0] + slope[0] * (u - start[0])), float(1.0 / slope[0])

    def _radials(self, offset: Array) -> tuple[Array, Array]:
        """Forces (j, 2) and tangent stiffnesses (j, 2, 2) of radial elements."""
        pull = self.softer * SHARED
        u = offset + pull * self.force[self.scalar :].reshape(-1, 2)
        radius = np.sqrt((u * u).sum(axis=1))
        size, slope = self._on_graphs(radius, pull)
        along = u / np.where(radius > 0.0, radius, 1.0)[:, None]
        across = np.where(radius > 0.0, size / np.where(radius > 0.0, radius, 1.0), slope)
        dyad = along[:, :, None] * along[:, None, :]
        stiffness = slope[:, None, None] * dyad + across[:, None, None] * (np.eye(2) - dyad)
        return size[:, None] * along, stiffness

    def _corners(self, pull: float) -> tuple[Array, Array, Array]:
        """Radii at which the first rise, the jump and the level piece of the graphs end."""
        law = self.graph
        with np.errstate(invalid="ignore"):
            rise = np.where(law.first > 0.0, law.stick * (1.0 + pull * law.first), 0.0)
        jump = np.maximum(law.stick + pull * law.bound, rise)
        return rise, jump, np.maximum(law.reach + pull * law.bound, jump)

    def _on_graphs(self, radius: Array, pull: float) -> tuple[Array, Array]:
        """Force and slope of the graphs, made softer by the pull, at radii."""
        law = self.graph
        rise, jump, level = self._corners(pull)
        with np.errstate(invalid="ignore"):
            first = law.first / (1.0 + pull * law.first)
            last = np.where(np.isinf(law.last), 1.0 / pull, law.last / (1.0 + pull * law.last))
            pieces = [radius <= rise, radius <= jump, radius <= level]
            size = np.select(
                pieces,
                [first * radius, (radius - law.stick) / pull, law.bound],
                law.bound + last * (radius - level),
            )
        return size, np.select(pieces, [first, np.full_like(first, 1.0 / pull), 0.0 * first], last)

    def _step(self, here: _Point) -> Array:
        """Newton step, of coordinates and the forces that act: regular, whatever acts."""
        acts = np.flatnonzero(np.isfinite(here.compliance))
        size, count = len(here.x), len(acts)
        matrix = np.zeros((size + count, size + count))
        matrix[range(size), range(size)] = self.pull
        for j, stiffness in enumerate(here.stiffness):
            two = self.vectors[self.scalar + 2 * j : self.scalar + 2 * j + 2]
            matrix[:size, :size] += two.T @ stiffness @ two
        matrix[:size, size:] = self.vectors[acts].T
        matrix[size:, :size] = self.vectors[acts]
        matrix[range(size, size + count), range(size, size + count)] = -here.compliance[acts]
        return np.asarray(
            np.linalg.solve(matrix, np.concatenate([-here.gradient, np.zeros(count)]))[:size]
        )

    def _along(self, here: _Point, step: Array) -> _Point:
        """Go along a step until the slope of the energy has all but gone."""
        low, high = 0.0, 1.0
        at_low = float(here.gradient @ step)
        enough = SLOPE * abs(at_low)
        there = self._at(here.x + step)
        slope = at_high = float(there.gradient @ step)
        for _ in range(HALVINGS):
            if slope <= enough and (high == 1.0 or slope >= -enough):
                break
            share = low - at_low * (high - low) / (at_high - at_low)
            share = min(max(share, low + 0.05 * (high - low)), high - 0.05 * (high - low))
            there = self._at(here.x + share * step)
            slope = float(there.gradient @ step)
            if slope > 0.0:
                high, at_high = share, slope
            else:
                low, at_low = share, slope
        return there

    def _code(self, found: _Point) -> Codes:
        """The set on which a pass ended."""
        elements, law, pull = self.elements, self.graph, self.softer * SHARED
        code = np.zeros(elements.switches, dtype=np.int8)
        code[: elements.rows] = found.force[self.springs : self.scalar] > 0.0
        offset = (self.vectors @ found.x - self.gap)[self.scalar :].reshape(-1, 2)
        offset = offset + pull * self.force[self.scalar :].reshape(-1, 2)
        radius = np.sqrt((offset * offset).sum(axis=1))
        rise, jump, level = self._corners(pull)
        idle = (law.bound == 0.0) & (law.stick == 0.0)
        code[elements.rows :] = np.select(
            [radius <= rise, radius <= jump, radius <= level],
            [
                np.where(idle, at.OPEN, np.where(law.stick > 0.0, at.STICK, at.PINNED)),
                np.where(idle, at.OPEN, np.where(law.stick > 0.0, at.CORNER, at.PINNED)),
                np.where(law.bound > 0.0, at.SLIP, at.OPEN),
            ],
            beyond(law),
        )
        return code


def search(elements: Elements, data: Data) -> tuple[State, Found]:
    """Lead a single sample to a consistent set from where the proximal passes end.

    Parameters
    ----------
    elements : Elements
    data : Data
        Of one sample.

    Returns
    -------
    State, Found
        Not solved where the sample has no equilibrium, or the passes find none.
    """
    state, passes, before = at_rest(elements, data), Proximal(elements, data), b""
    found = Found(
        np.zeros(1, bool), first_sets(elements, data), np.zeros(1, int), np.zeros(1, bool)
    )
    tried: list[bytes] = []
    for code in passes.passes():
        # A set that a pass confirms is worth an exact solve; near it, so are a few others.
        key = code.tobytes()
        if key == before and tried.count(key) < TRIES:
            tried.append(key)
            passes.store(state)
            more = exchange(
                elements,
                data,
                state,
                vectorised.settle,
                code[None, :],
                singly=True,
                limit=EXCHANGES,
            )
            found = found.completed(more)
            if found.solved[0]:
                break
        before = key
    return state, found
