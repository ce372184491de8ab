"""The exact solve on an identified active set, and the exchange of wrongly identified elements.

An interior-point answer tells roughly which contacts are closed and where radial elements are on
their graphs. Here this active set is fixed, the remaining (smooth) equations are solved to
round-off by Newton's method, the signs are checked, and rows or graph states with a wrong sign are
exchanged. Kinks therefore never depend on a small interior-point number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.findings import StepBudget
from loadshare.contact.kkt import solve_symmetric
from loadshare.contact.programme import Cone, Point, Programme
from loadshare.contact.radial import nearest
from loadshare.settings import CONTACT

_NONE, _BOTH = np.zeros((0, 2)), np.eye(2)


@dataclass(frozen=True, slots=True)
class GraphState:
    """Where a radial element is on its graph: on a piece, or on the step in front of one."""

    piece: int
    corner: bool = False


@dataclass(frozen=True, slots=True)
class ActiveSet:
    """Closed rows, and the states of the radial elements on their graphs."""

    closed: tuple[bool, ...]
    graph_states: tuple[GraphState, ...]

    def fits(self, programme: Programme) -> bool:
        """Return whether the set fits the rows and graphs of a programme."""
        graphs = [len(cone.law.pieces) for cone in programme.cones]
        return (
            len(self.closed) == len(programme.gaps)
            and len(self.graph_states) == len(graphs)
            and all(
                graph_state.piece < size + graph_state.corner
                for graph_state, size in zip(self.graph_states, graphs, strict=True)
            )
        )


def first_guess(programme: Programme) -> ActiveSet:
    """Return the set with assumed rows closed, all others open, graphs on their first part."""
    start = (GraphState(0, corner=cone.law.step(0)[1] > 0.0) for cone in programme.cones)
    return ActiveSet(tuple(bool(c) for c in programme.assumed_closed), tuple(start))


def identify(programme: Programme, point: Point) -> ActiveSet:
    """Read the active set from an approximate answer.

    A row is closed if its force, turned into a length by the row's compliance, exceeds its gap. A
    radial element is put on the nearest part of its graph.
    """
    forces = np.maximum(point.forces, 0.0)
    compressed = programme.linear * forces + programme.hertz * np.cbrt(forces) ** 2
    slack = programme.gaps + compressed - programme.rows @ point.x
    closed = programme.assumed_closed | (forces * (programme.linear + 1.0) > slack)
    graph_states = (
        GraphState(*nearest(cone.law.parts(), _size(cone.offset(point.x)), _size(force)))
        for cone, force in zip(programme.cones, point.cone_forces, strict=True)
    )
    return ActiveSet(tuple(bool(c) for c in closed), tuple(graph_states))


def solve_exact(
    programme: Programme,
    guess: ActiveSet,
    start: Point | None = None,
    rounds: int = 0,
    work: StepBudget | None = None,
    stay: bool = False,
    shared: bool = False,
) -> tuple[Point, ActiveSet] | None:
    """Solve on an active set and exchange until every sign is right.

    All wrong signs are exchanged at once; once a set recurs, one at a time by least index, which
    terminates for a positive definite programme.

    Parameters
    ----------
    programme : Programme
    guess : ActiveSet
    start : Point, optional
        Where Newton's method begins; it matters only for nonlinear parts (radial graphs, Hertz
        laws).
    rounds : int
        Exchanges allowed; 0 allows as many as the programme's size justifies.
    work : StepBudget, optional
        Newton steps allowed; unlimited by default.
    stay : bool
        Leave coordinates that a set does not determine where they are; by default they take their
        least norm, which may violate contacts that carry nothing.
    shared : bool
        Leave forces that a set does not determine as `start` shares them; by default they take
        their least norm, at which friction may exceed its bound.

    Returns
    -------
    (Point, ActiveSet) or None
        None if the exchange finds no consistent set.
    """
    start = start or at_rest(programme)
    limit = rounds or 20 + 6 * (len(programme.gaps) + len(programme.cones))
    active, seen, one_only = guess, {guess}, False
    held: list[ActiveSet] = []
    for _ in range(limit):
        solved = _solve_fixed(programme, active, start, work, stay, shared)
        point, settled = solved or (start, False)
        better = _exchange(programme, active, point, one_only) if solved else active
        if better == active:
            if settled and _balances(programme, point):
                return point, active
            sets = (*held, *_held_again(programme, active), *_held_again(programme, guess))
            held = [one for one in dict.fromkeys(sets) if one not in seen]
            if not held:
                return None
            active = held.pop(0)
            seen.add(active)
            continue
        if better in seen and not one_only:
            one_only = True
            better = _exchange(programme, active, point, one_only)
        elif better in seen and not settled:
            # Newton's method does not converge if an element that counts as slipping does not move.
            better = next((s for s in _held_again(programme, better) if s not in seen), better)
        seen.add(better)
        active, start = better, point
    return None


def _balances(programme: Programme, point: Point) -> bool:
    """Return whether forces balance within the tolerance of a claim.

    The force of a slipping element has no direction if others hold it at its centre: Newton's
    method may then end anywhere.
    """
    pushed = [programme.load, -programme.stiffness @ point.x, -programme.rows.T @ point.forces]
    pushed += [-c.matrix.T @ f for c, f in zip(programme.cones, point.cone_forces, strict=True)]
    sizes = np.abs(pushed).max(initial=1.0)
    return bool(np.abs(sum(pushed)).max(initial=0.0) <= CONTACT.tolerance * sizes)


def _held_again(programme: Programme, active: ActiveSet) -> Iterator[ActiveSet]:
    """Yield sets in which elements that slip from the first stick again: all, then each alone.

    Under a force of exactly its friction, an element is also in equilibrium at rest, and nothing
    determines how far it slips. Of two that hold the same body at different places only one can be
    at rest.
    """
    states = active.graph_states
    slipping = [
        k
        for k, (cone, state) in enumerate(zip(programme.cones, states, strict=True))
        if state == GraphState(0) and cone.law.step(0)[1] > 0.0
    ]
    for chosen in (slipping, *([k] for k in slipping if len(slipping) > 1)):
        if chosen:
            places = (
                GraphState(0, corner=True) if k in chosen else s for k, s in enumerate(states)
            )
            yield replace(active, graph_states=tuple(places))


def at_rest(programme: Programme) -> Point:
    """Return the point without any displacement or force."""
    return Point(
        np.zeros(programme.stiffness.shape[0]),
        np.zeros(len(programme.gaps)),
        np.zeros((len(programme.cones), 2)),
    )


def _solve_fixed(
    programme: Programme,
    active: ActiveSet,
    start: Point,
    work: StepBudget | None,
    stay: bool,
    shared: bool,
) -> tuple[Point, bool] | None:
    """Solve the smooth equations of an active set by Newton's method, and say whether it settled.

    On a wrong active set the equations may have no solution; the point that the steps reach still
    shows what to exchange.
    """
    x, forces, cone_forces = start.x, start.forces, start.cone_forces
    curved = bool(programme.cones) or bool(programme.hertz.any())
    previous = np.inf
    for _ in range(CONTACT.newton_steps if curved else 1):
        if work is not None:
            work.step()
        solved = _newton_system(programme, active, Point(x, forces, cone_forces), stay, shared)
        if solved is None:
            return None
        point = solved
        step = max(_relative(point.x, x), _relative(point.forces, forces))
        x, forces, cone_forces = point.x, point.forces, point.cone_forces
        slow = step <= CONTACT.settled and step >= 0.5 * previous
        if not curved or step <= CONTACT.still or slow:
            return point, True
        previous = step
    return point, previous <= CONTACT.near


def _relative(after: Array, before: Array) -> float:
    """Return the largest change of values, over the largest of them or 1."""
    largest = 1.0 + float(np.abs(after).max(initial=0.0))
    return float(np.abs(after - before).max(initial=0.0)) / largest


def _newton_system(
    programme: Programme, active: ActiveSet, at: Point, stay: bool, shared: bool
) -> Point | None:
    """Take one Newton step, in the absolute form that solves a linear problem at once."""
    size = programme.stiffness.shape[0]
    closed = np.array(active.closed, dtype=bool)
    stiffness, load = programme.stiffness.copy(), programme.load.copy()
    compliance, gaps = _row_tangents(programme, at.forces)
    columns = [programme.rows[closed].T]
    bounds = [gaps[closed]]
    multipliers: list[tuple[int, Array]] = []  # cone number and the directions of its multiplier
    for j, (cone, graph_state) in enumerate(zip(programme.cones, active.graph_states, strict=True)):
        tangent, residual_force, directions, bound = _cone_tangent(
            cone, graph_state, at.x, at.cone_forces[j]
        )
        stiffness += cone.matrix.T @ tangent @ cone.matrix
        load += cone.matrix.T @ (tangent @ (cone.matrix @ at.x) - residual_force)
        if len(directions):
            columns.append((directions @ cone.matrix).T)
            bounds.append(bound + directions @ cone.centre)
            multipliers.append((j, directions))
    border = np.hstack(columns)
    count = border.shape[1]
    matrix = np.zeros((size + count, size + count))
    matrix[:size, :size] = stiffness
    matrix[:size, size:] = border
    matrix[size:, :size] = border.T
    flanks = int(closed.sum())
    diagonal = matrix.reshape(-1)[:: size + count + 1]
    diagonal[size : size + flanks] = -compliance[closed]
    solved = solve_symmetric(matrix, np.concatenate([load, *bounds]), size)
    if solved is None:
        return None
    x = solved.values[:size]
    if not np.abs(x).max(initial=0.0) <= CONTACT.far:
        return None
    if stay:
        x = x + solved.moves @ (solved.moves.T @ (at.x - x))
    carried = solved.values[size:]
    if shared and solved.stresses.shape[1]:
        held = [directions @ at.cone_forces[j] for j, directions in multipliers]
        wanted = np.concatenate([at.forces[closed], *held])
        carried = carried + _nearest_share(solved.stresses, wanted - carried)
    forces = np.zeros(len(programme.gaps))
    forces[closed] = carried[:flanks]
    cone_forces = np.zeros((len(programme.cones), 2))
    for j, (cone, graph_state) in enumerate(zip(programme.cones, active.graph_states, strict=True)):
        if not graph_state.corner:
            cone_forces[j] = _piece_force(cone, graph_state, cone.offset(x))
    at_multiplier = flanks
    for j, directions in multipliers:
        width = len(directions)
        cone_forces[j] = carried[at_multiplier : at_multiplier + width] @ directions
        at_multiplier += width
    return Point(x, forces, cone_forces)


def _nearest_share(stresses: Array, wanted: Array) -> Array:
    """Return the combination of self-balanced forces that is nearest to what is wanted."""
    return np.asarray(stresses @ np.linalg.lstsq(stresses, wanted, rcond=None)[0])


def _row_tangents(programme: Programme, forces: Array) -> tuple[Array, Array]:
    """Return tangent compliances and gaps of the rows at the current forces."""
    if not programme.hertz.any():
        return programme.linear, programme.gaps
    root = np.cbrt(np.maximum(forces, CONTACT.least_force))
    return (
        programme.linear + 2.0 / 3.0 * programme.hertz / root,
        programme.gaps + programme.hertz * root**2 / 3.0,
    )


def _piece_force(cone: Cone, graph_state: GraphState, offset: Array) -> Array:
    """Return the force of a radial element on a piece, as a vector along its offset."""
    piece = cone.law.pieces[graph_state.piece]
    begin = cone.law.start(graph_state.piece)
    radius = _size(offset)
    if piece.force == piece.stiffness * begin or radius == 0.0:
        return np.asarray(piece.stiffness * offset)
    return np.asarray((piece.force + piece.stiffness * (radius - begin)) / radius * offset)


def _cone_tangent(
    cone: Cone, graph_state: GraphState, x: Array, force: Array
) -> tuple[Array, Array, Array, Array]:
    """Return tangent (2, 2), force at x (2,), multiplier directions (d, 2) and their bounds."""
    offset = cone.offset(x)
    radius = _size(offset)
    if graph_state.corner:
        limit = cone.law.start(graph_state.piece)
        if limit == 0.0:
            return np.zeros((2, 2)), np.zeros(2), _BOTH, np.zeros(2)
        along = offset / radius if radius > 0.0 else _direction(force)
        across = _BOTH - along[:, None] * along
        size = max(float(along @ force), 0.0)
        # The step's multiplier turns with the offset: its share of the tangent is λ/R across the
        # radius.
        tangent = size / limit * across
        return tangent, tangent @ offset, along[None, :], np.array([limit])
    piece = cone.law.pieces[graph_state.piece]
    begin = cone.law.start(graph_state.piece)
    if piece.force == piece.stiffness * begin:
        return piece.stiffness * _BOTH, piece.stiffness * offset, _NONE, np.zeros(0)
    if radius == 0.0:
        radius = max(begin, CONTACT.least_offset)
        offset = _direction(force) * radius
    along = offset / radius
    size = piece.force + piece.stiffness * (radius - begin)
    tangent = piece.stiffness * (along[:, None] * along)
    # Beyond the piece the true tangent across the radius is too soft for Newton's method to return.
    near = min(radius, begin + piece.length) or CONTACT.least_offset
    tangent = tangent + max(size, 0.0) / near * (_BOTH - along[:, None] * along)
    return tangent, size * along, _NONE, np.zeros(0)


def _size(vector: Array) -> float:
    """Return the length of a vector, without the checks of `numpy.linalg.norm`."""
    return math.sqrt(vector @ vector)


def _direction(force: Array) -> Array:
    size = _size(force)
    return force / size if size > 0.0 else np.array([1.0, 0.0])


def _exchange(programme: Programme, active: ActiveSet, point: Point, one_only: bool) -> ActiveSet:
    """Flip rows with the wrong sign and move radial elements off states that they have left."""
    force_band = CONTACT.sign + CONTACT.sign_of_size * float(np.abs(point.forces).max(initial=0.0))
    length_band = CONTACT.sign + CONTACT.sign_of_size * float(np.abs(point.x).max(initial=0.0))
    wrong: list[tuple[float, int]] = []
    approach = programme.rows @ point.x - programme.gaps
    for e, closed in enumerate(active.closed):
        if programme.assumed_closed[e]:
            continue
        excess = -point.forces[e] / force_band if closed else approach[e] / length_band
        if excess > 1.0:
            wrong.append((float(excess), e))
    count = len(active.closed)
    moves: dict[int, GraphState] = {}
    for j, (cone, graph_state) in enumerate(zip(programme.cones, active.graph_states, strict=True)):
        excess, moved = _misplaced(cone, graph_state, point, j, force_band, length_band)
        if excess > 1.0:
            wrong.append((excess, count + j))
            moves[count + j] = moved
    if one_only and wrong:
        wrong = [min(wrong, key=lambda w: w[1])]
    rows, graph_states = list(active.closed), list(active.graph_states)
    for _, k in wrong:
        if k < count:
            rows[k] = not rows[k]
        else:
            graph_states[k - count] = moves[k]
    return replace(active, closed=tuple(rows), graph_states=tuple(graph_states))


def _misplaced(
    cone: Cone, graph_state: GraphState, point: Point, j: int, force_band: float, length_band: float
) -> tuple[float, GraphState]:
    """Return by how many bands a radial element is off its graph state, and its proper state."""
    law, k = cone.law, graph_state.piece
    offset = cone.offset(point.x)
    if graph_state.corner:
        low, high = law.step(k)
        along = _direction(offset) if law.start(k) > 0.0 else _direction(point.cone_forces[j])
        size = float(along @ point.cone_forces[j])
        if size > high:
            return (size - high) / force_band, GraphState(k)
        return (low - size) / force_band, GraphState(k - 1) if k > 0 else graph_state
    radius = _size(offset)
    begin, end = law.start(k), law.start(k + 1)
    if radius > end:
        low, high = law.step(k + 1)
        return (radius - end) / length_band, GraphState(k + 1, corner=high > low)
    if radius < begin and k > 0:
        low, high = law.step(k)
        back = GraphState(k, corner=True) if high > low else GraphState(k - 1)
        return (begin - radius) / length_band, back
    if k == 0 and law.pieces[0].force > 0.0 and offset @ point.cone_forces[j] <= 0.0:
        return 2.0, GraphState(0, corner=True)
    return 0.0, graph_state
