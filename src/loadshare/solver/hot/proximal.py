r"""The proximal method of multipliers on elements, for samples without a set from exchange.

Every pass adds a small stiffness and a small compliance that pull towards the previous pass,

.. math:: \tfrac{\varepsilon}{2}\lVert x - x_k\rVert^2, \qquad
          a_e\cdot x - \delta_e(F_e) - \varepsilon (F_e - F_{e,k}) \le g_e ,

so that its energy is strictly convex and has a gradient everywhere, even if elements oppose or
repeat one another. Newton's method with a line search always arrives at its minimum, and the passes
converge to an equilibrium if there is one. Arcs, as faces, and friction bounds are renewed between
passes. Each pass ends on a set, and gives a start for the exact solve on it.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from loadshare.array_types import Array, Flags, States
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import HOT, SEARCH
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.elements import arcs_at, arcs_of
from loadshare.solver.hot.exchange import ExchangeResult, exchange, first_sets
from loadshare.solver.hot.iterate import Iterate, at_rest
from loadshare.solver.hot.radials import beyond
from loadshare.solver.hot.softened import Laws

_HALVES = 0.5 ** np.arange(SEARCH.halvings, -1, -1)


@dataclass(slots=True)
class _Point:
    """Coordinates of a pass, with the forces and the gradient there.

    Attributes
    ----------
    x : ndarray, shape (n,)
    pressed : ndarray, shape (m,)
        Compression of every element, or its extension.
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
    structure : Structure
    loading : Loading
        Loading of this sample alone.
    """

    def __init__(self, structure: Structure, loading: Loading) -> None:
        self.structure, self.loading, self.rows = structure, loading, np.zeros(1, dtype=int)
        self.springs, self.scalar = structure.springs, structure.columns.contacts.stop
        self.load = loading.load[0]
        self.gap = np.array(loading.gap[0])
        self.vectors = np.array(structure.vectors)
        self.x = np.zeros(structure.size)
        self.force = np.zeros(len(self.vectors))
        self.looks = 0
        self.pull = SEARCH.stiffer[0]
        self.laws = Laws(structure, loading, self.force, SEARCH.softer, self.pull)

    def passes(self) -> Iterator[States]:
        """Make one pass after another; yield the set (switches,) on which each ends."""
        for self.pull in SEARCH.stiffer:
            extent = max(float(np.abs(v).max(initial=1.0)) for v in (self.gap, self.x))
            softer = max(SEARCH.softer, SEARCH.resolved * np.finfo(float).eps * extent)
            self._face_arcs()
            # Radial elements yield as much as the rest is held: if they were stiffer, a float that
            # has far to roll would do so in tiny steps, each out of the round wall and back again.
            # A remembered slip may have less room than this compliance would resolve.
            yielding = 0.0 if self.structure.train.slip is not None else self.pull
            rounded = max(SEARCH.shared * softer, yielding)
            self.laws = Laws(self.structure, self.loading, self.force, softer, rounded)
            if not self.laws.graph.valid.all():
                return
            found = self._minimise()
            if self.looks > SEARCH.looks:
                return
            states = self._code(found)
            self.x, self.force = found.x, found.force
            yield states

    def store(self, iterate: Iterate) -> None:
        """Store the coordinates and forces at which the passes are."""
        iterate.x[0], iterate.force[0], iterate.stays[0] = self.x, self.force, True
        iterate.root[0] = np.maximum(np.cbrt(np.maximum(self.force, 0.0)), iterate.floor[0])

    def without_idle(self, states: States) -> States:
        """Return a set in which elements are open that carry almost nothing in the last pass."""
        idle = np.abs(self.force) <= SEARCH.idle * np.abs(self.force).max(initial=0.0)
        apart = idle[self.scalar :].reshape(-1, 2).all(axis=1)
        law = self.laws.graph
        free = (law.bound == 0.0) & (law.stick == 0.0) & (law.reach > 0.0)
        opened = np.append(idle[self.springs : self.scalar], apart & free)
        return np.where(opened, at.OPEN, states).astype(np.int8)

    def _face_arcs(self) -> None:
        """Replace arcs by their faces at the last pass."""
        first = self.structure.columns.arcs.start
        normals, margins = arcs_at(arcs_of(self.loading, self.rows), self.x[None, :])
        for a in range(len(self.structure.arcs)):
            self.vectors[first + a] = -normals[0, a] @ self.loading.relative[a]
            self.gap[first + a] = margins[0, a] + self.vectors[first + a] @ self.x

    def _minimise(self) -> _Point:
        """Minimise the energy of a pass by Newton's method."""
        here = self._at(self.x)
        least, since = np.inf, 0
        for _ in range(SEARCH.newton):
            largest = max(1.0, float(np.abs(here.force).max(initial=0.0)))
            flat = float(np.abs(here.gradient).max(initial=0.0))
            least, since = (flat, 0) if flat < 0.5 * least else (least, since + 1)
            tired = since > SEARCH.patience or self.looks > SEARCH.looks
            if tired or flat <= SEARCH.flat * largest:
                break
            step = self._rolled(here, self._step(here))
            work = float(np.abs(here.force) @ np.abs(here.pressed))
            if -(here.gradient @ step) <= SEARCH.gain * work:
                break
            here = self._along(here, step)
            if np.abs(step).max() <= SEARCH.still * np.abs(here.x).max():
                break
        return here

    def _at(self, x: Array) -> _Point:
        """Return forces and gradient at coordinates."""
        self.looks += 1
        pressed = self.vectors @ x - self.gap + self.laws.lean
        force = self.laws.forces(pressed)
        gradient = self.vectors.T @ force - self.load + self.pull * (x - self.x)
        return _Point(x, pressed, force, gradient)

    def _step(self, here: _Point, led: Flags | None = None, ways: Array | None = None) -> Array:
        """Return the Newton step of the coordinates, from a system that is always regular.

        Parameters
        ----------
        here : _Point
        led : ndarray of bool, shape (radials,), optional
            Radial elements whose step is given; none by default.
        ways : ndarray, shape (radials, 2), optional
            Their steps.
        """
        compliance, stiffness = self.laws.tangents(here.pressed, here.force)
        compliance = np.append(compliance, np.full(len(here.pressed) - self.scalar, np.inf))
        if led is not None:
            stiffness[led] = 0.0
            compliance[self.scalar :][np.repeat(led, 2)] = SEARCH.softer
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
        if led is not None and ways is not None:
            right[len(right) - 2 * led.sum() :] = ways[led].ravel()
        return np.asarray(np.linalg.solve(matrix, right)[:size])

    def _rolled(self, here: _Point, step: Array) -> Array:
        """Bend a step along the round walls on which floats roll, if the energy falls that way.

        A straight step leads out of the wall, which the line search hardly allows: a float that has
        far to roll would do so in tiny steps. It is taken in the direction of the step's end, to
        the radius of the tangent, and all else follows: on this chord no wall is pressed deeper.
        """
        offset = here.pressed[self.scalar :].reshape(-1, 2)
        ends = offset + (self.vectors[self.scalar :] @ step).reshape(-1, 2)
        radius, there = (np.sqrt((v * v).sum(axis=1)) for v in (offset, ends))
        with np.errstate(divide="ignore", invalid="ignore"):
            tangent = (offset * ends).sum(axis=1) / radius
            deeper = there - tangent > SEARCH.rolls * (radius - self.laws.level)
            led = (radius > self.laws.level) & (tangent > 0.0) & deeper
            ends *= (tangent / there)[:, None]
        if not led.any():
            return step
        chord = self._step(here, led, ends - offset)
        return chord if here.gradient @ chord < 0.0 else step

    def _along(self, here: _Point, step: Array) -> _Point:
        """Go along a step until the slope of the energy has nearly vanished.

        The slope rises along the step, smoothly between two kinks: all kinks on the way are
        evaluated together, and the place is sought between two of them.
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
        for shares in self.laws.kinks(here.pressed, speed), _HALVES:
            if abs(at_high) <= enough:
                break
            between = np.asarray(low + (high - low) * shares if shares is _HALVES else shares)
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
            # The slope at the end that stays is halved, so that this end moves as well next time.
            if slope > 0.0:
                high, at_high, at_low = share, slope, 0.5 * at_low
            else:
                low, at_low, at_high = share, slope, 0.5 * at_high
        return self._at(here.x + share * step)

    def _code(self, found: _Point) -> States:
        """Return the set on which a pass ended."""
        structure, laws = self.structure, self.laws
        law = laws.graph
        states = np.zeros(structure.switches, dtype=np.int8)
        states[: structure.rows] = found.force[self.springs : self.scalar] > 0.0
        radius = laws.radii(found.pressed)
        idle = (law.bound == 0.0) & (law.stick == 0.0)
        states[structure.rows :] = np.select(
            [radius <= laws.rise, radius <= laws.jump, radius <= laws.level],
            [
                np.where(idle, at.OPEN, np.where(law.stick > 0.0, at.STICK, at.PINNED)),
                np.where(idle, at.OPEN, np.where(law.stick > 0.0, at.CORNER, at.PINNED)),
                np.where(law.bound > 0.0, at.SLIP, at.OPEN),
            ],
            beyond(law),
        )
        return states


def search(structure: Structure, loading: Loading) -> tuple[Iterate, ExchangeResult]:
    """Find a consistent set for a single sample from the ends of the proximal passes.

    Parameters
    ----------
    structure : Structure
    loading : Loading
        Of one sample.

    Returns
    -------
    Iterate, Found
        Not solved where the sample has no equilibrium, or the passes find none.
    """
    iterate, passes, before = at_rest(structure, loading), Proximal(structure, loading), b""
    found = ExchangeResult(
        np.zeros(1, bool), first_sets(structure, loading), np.zeros(1, int), np.zeros(1, bool)
    )
    tried: list[bytes] = []
    for states in passes.passes():
        # A set on which two passes in a row end is worth an exact solve, and a few sets near it.
        key = states.tobytes()
        if key == before and tried.count(key) < SEARCH.tries:
            tried.append(key)
            # Where a set fails, elements that carry nothing may be the only reason.
            lean = passes.without_idle(states)
            for start in (states, lean) if (lean != states).any() else (states,):
                passes.store(iterate)
                more = exchange(
                    structure,
                    loading,
                    iterate,
                    vectorised.settle,
                    start[None, :],
                    singly=True,
                    limit=SEARCH.exchanges,
                )
                found.put(np.zeros(1, dtype=int), more)
                if found.solved[0]:
                    return _with_idle_open(structure, loading, iterate, found)
        before = key
    return iterate, found


def _with_idle_open(
    structure: Structure, loading: Loading, iterate: Iterate, found: ExchangeResult
) -> tuple[Iterate, ExchangeResult]:
    """Open contacts that carry round-off, if the set is consistent without them at the same place.

    With many such contacts no bound could show which of them act.
    """
    pushes = np.abs(iterate.force[0])
    idle = pushes[structure.columns.contacts] <= HOT.sign * pushes.max(initial=0.0)
    states = found.states.copy()
    states[0, : structure.rows][idle] = at.OPEN
    if (states == found.states).all():
        return iterate, found
    lean = deepcopy(iterate)
    more = exchange(structure, loading, lean, vectorised.settle, states, singly=True, limit=1)
    if not more.solved[0]:
        return iterate, found
    return lean, replace(more, turns=found.turns + more.turns)
