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
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from loadshare.scene.data import Data
from loadshare.scene.elements import Elements
from loadshare.scene.scene import Array
from loadshare.settings import HOT, SEARCH
from loadshare.solver.hot import places as at
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.exchange import Codes, Found, exchange, first_sets
from loadshare.solver.hot.softened import Laws
from loadshare.solver.hot.state import State, at_rest
from loadshare.solver.hot.vectorised import arc_at, beyond

HALVES = 0.5 ** np.arange(48, -1, -1)
"""Shares of the way between two kinks that are looked at together: a slope may rise by orders."""


@dataclass(slots=True)
class _Point:
    """Coordinates of a pass and what follows from them.

    Attributes
    ----------
    x : ndarray, shape (n,)
    pressed : ndarray, shape (m,)
        How far every element is pressed, or pulled out.
    force : ndarray, shape (m,)
    gradient : ndarray, shape (n,)
    """

    x: Array
    pressed: Array
    force: Array
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
        self.springs, self.scalar = elements.springs, elements.columns.contacts.stop
        self.load = data.load[0]
        self.gap = np.array(data.gap[0])
        self.vectors = np.array(elements.vectors)
        self.x = np.zeros(elements.size)
        self.force = np.zeros(len(self.vectors))
        self.looks = 0
        self.pull = SEARCH.stiffer[0]
        self.laws = Laws(elements, data, self.force, SEARCH.softer, self.pull)

    def passes(self) -> Iterator[Codes]:
        """Make one pass after another; each gives the set (switches,) where it ends."""
        for self.pull in SEARCH.stiffer:
            extent = max(float(np.abs(v).max(initial=1.0)) for v in (self.gap, self.x))
            softer = max(SEARCH.softer, SEARCH.resolved * np.finfo(float).eps * extent)
            self._face_arcs()
            # A radius that gives way as much as the rest is held: steeper, and a float that has far
            # to roll would do so in tiny steps, each pressed out of the round and back again.
            # Slip that is remembered may have less room than that would tell apart.
            yielding = 0.0 if self.elements.train.slip is not None else self.pull
            rounded = max(SEARCH.shared * softer, yielding)
            self.laws = Laws(self.elements, self.data, self.force, softer, rounded)
            if not self.laws.graph.valid.all():
                return
            found = self._minimise()
            if self.looks > SEARCH.looks:
                return
            code = self._code(found)
            self.x, self.force = found.x, found.force
            yield code

    def store(self, state: State) -> None:
        """Write down where the passes stand."""
        state.x[0], state.force[0], state.stays[0] = self.x, self.force, True
        state.root[0] = np.maximum(np.cbrt(np.maximum(self.force, 0.0)), state.floor[0])

    def without_idle(self, code: Codes) -> Codes:
        """Open what carries all but nothing where the passes stand."""
        idle = np.abs(self.force) <= SEARCH.idle * np.abs(self.force).max(initial=0.0)
        apart = idle[self.scalar :].reshape(-1, 2).all(axis=1)
        law = self.laws.graph
        free = (law.bound == 0.0) & (law.stick == 0.0) & (law.reach > 0.0)
        opened = np.append(idle[self.springs : self.scalar], apart & free)
        return np.where(opened, at.OPEN, code).astype(np.int8)

    def _face_arcs(self) -> None:
        """Replace arcs by their faces at the last pass."""
        first = self.elements.columns.arcs.start
        for a in range(len(self.elements.arcs)):
            normal, margin = arc_at(self.data, a, self.rows, self.x[None, :])
            self.vectors[first + a] = -normal[0] @ self.data.relative[a]
            self.gap[first + a] = margin[0] + self.vectors[first + a] @ self.x

    def _minimise(self) -> _Point:
        """Newton's method on the energy of a pass."""
        here = self._at(self.x)
        least, since = np.inf, 0
        for _ in range(SEARCH.newton):
            largest = max(1.0, float(np.abs(here.force).max(initial=0.0)))
            flat = float(np.abs(here.gradient).max(initial=0.0))
            least, since = (flat, 0) if flat < 0.5 * least else (least, since + 1)
            tired = since > SEARCH.patience or self.looks > SEARCH.looks
            if tired or flat <= SEARCH.flat * largest:
                break
            step = self._step(here)
            here = self._along(here, step)
            if np.abs(step).max() <= SEARCH.still * np.abs(here.x).max():
                break
        return here

    def _at(self, x: Array) -> _Point:
        """Forces and gradient at coordinates."""
        self.looks += 1
        pressed = self.vectors @ x - self.gap + self.laws.lean
        force = self.laws.forces(pressed)
        gradient = self.vectors.T @ force - self.load + self.pull * (x - self.x)
        return _Point(x, pressed, force, gradient)

    def _step(self, here: _Point) -> Array:
        """Newton step, of coordinates and the forces that act: regular, whatever acts."""
        compliance, stiffness = self.laws.tangents(here.pressed, here.force)
        acts = np.flatnonzero(np.isfinite(compliance))
        size, count = len(here.x), len(acts)
        matrix = np.zeros((size + count, size + count))
        diagonal = matrix.reshape(-1)[:: size + count + 1]
        diagonal[:size] = self.pull
        diagonal[size:] = -compliance[acts]
        two = self.vectors[self.scalar :].reshape(-1, 2, size)
        turned = (stiffness @ two).reshape(-1, size)
        matrix[:size, :size] += self.vectors[self.scalar :].T @ turned
        matrix[:size, size:] = self.vectors[acts].T
        matrix[size:, :size] = self.vectors[acts]
        right = np.zeros(size + count)
        right[:size] = -here.gradient
        return np.asarray(np.linalg.solve(matrix, right)[:size])

    def _along(self, here: _Point, step: Array) -> _Point:
        """Go along a step until the slope of the energy has all but gone.

        The slope rises, and between two kinks it does so smoothly: the kinks on the way are looked
        at together, and the place is sought between two of them.
        """
        start = float(here.gradient @ step)
        enough = SEARCH.slope * abs(start)
        there = self._at(here.x + step)
        slope = float(there.gradient @ step)
        if slope <= enough:
            return there
        speed = self.vectors @ step
        given = float(self.pull * (here.x - self.x) @ step - self.load @ step)
        stiff = float(self.pull * step @ step)

        def slopes(shares: Array) -> Array:
            force = self.laws.forces(here.pressed + shares[:, None] * speed)
            return np.asarray(force @ speed + given + stiff * shares)

        low, high, at_low, at_high = 0.0, 1.0, start, slope
        for shares in self.laws.kinks(here.pressed, speed), HALVES:
            if abs(at_high) <= enough:
                break
            between = np.asarray(low + (high - low) * shares if shares is HALVES else shares)
            self.looks += 1
            found = slopes(between)
            k = int(np.searchsorted(found > 0.0, True))
            if k < len(between):
                high, at_high = float(between[k]), float(found[k])
            if k > 0:
                low, at_low = float(between[k - 1]), float(found[k - 1])
        share, slope = high, at_high
        for _ in range(SEARCH.secants):
            if abs(slope) <= enough or high - low <= SEARCH.still * high:
                break
            share = low - at_low * (high - low) / (at_high - at_low)
            self.looks += 1
            slope = float(slopes(np.array([share]))[0])
            # The end that stays counts for half, so that it moves as well the next time.
            if slope > 0.0:
                high, at_high, at_low = share, slope, 0.5 * at_low
            else:
                low, at_low, at_high = share, slope, 0.5 * at_high
        return self._at(here.x + share * step)

    def _code(self, found: _Point) -> Codes:
        """The set on which a pass ended."""
        elements, laws = self.elements, self.laws
        law = laws.graph
        code = np.zeros(elements.switches, dtype=np.int8)
        code[: elements.rows] = found.force[self.springs : self.scalar] > 0.0
        radius = laws.radii(found.pressed)
        idle = (law.bound == 0.0) & (law.stick == 0.0)
        code[elements.rows :] = np.select(
            [radius <= laws.rise, radius <= laws.jump, radius <= laws.level],
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
        if key == before and tried.count(key) < SEARCH.tries:
            tried.append(key)
            # What carries nothing where a set fails may only be in the way.
            lean = passes.without_idle(code)
            for start in (code, lean) if (lean != code).any() else (code,):
                passes.store(state)
                more = exchange(
                    elements,
                    data,
                    state,
                    vectorised.settle,
                    start[None, :],
                    singly=True,
                    limit=SEARCH.exchanges,
                )
                found = found.completed(more)
                if found.solved[0]:
                    return _with_idle_open(elements, data, state, found)
        before = key
    return state, found


def _with_idle_open(
    elements: Elements, data: Data, state: State, found: Found
) -> tuple[State, Found]:
    """Open contacts that carry round-off, if the set holds without them where the gears are.

    Of many no bound could tell whether they act.
    """
    pushes = np.abs(state.force[0])
    idle = pushes[elements.columns.contacts] <= HOT.sign * pushes.max(initial=0.0)
    code = found.code.copy()
    code[0, : elements.rows][idle] = at.OPEN
    if (code == found.code).all():
        return state, found
    lean = deepcopy(state)
    more = exchange(elements, data, lean, vectorised.settle, code, singly=True, limit=1)
    if not more.solved[0]:
        return state, found
    return lean, replace(more, turns=found.turns + more.turns)
