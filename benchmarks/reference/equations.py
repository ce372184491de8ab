"""The equations of an active set: balances, contacts, ties, pieces of graphs, friction bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from benchmarks.reference.elements import Graph
from benchmarks.reference.elimination import Sparse
from benchmarks.reference.machine import Machine

CURVED = frozenset({"step", "wall"})
"""Places at which the force of a graph is an unknown of its own."""


@dataclass(frozen=True, slots=True)
class Guess:
    """An active set and the unknowns.

    Attributes
    ----------
    x : list
        Coordinates.
    forces : dict of contact to number
        Of the closed contacts; the others are open.
    ties : list
        Torques of the rigid shafts.
    places : dict of graph to str
    pulls : dict of graph to list
        Force vectors against the offsets.
    bounds : dict of graph to number
        Friction bounds.
    """

    x: list[Any]
    forces: dict[str, Any]
    ties: list[Any]
    places: dict[str, str]
    pulls: dict[str, list[Any]]
    bounds: dict[str, Any]


class Equations:
    """Residuals and their derivatives at a guess.

    Attributes
    ----------
    rows : list of dict
        Derivatives by unknown: coordinates, contact forces, tie torques, pulls, bounds.
    right : list
        Negative residuals.
    force_at, pull_at, bound_at : dict
        Indices of the unknowns of contacts, of graphs on a step or wall, and of bounds that follow
        the torque.
    tie_at : list of int
    count : int
    """

    def __init__(self, machine: Machine, at: Guess) -> None:
        self.machine, self.at = machine, at
        n = machine.size
        self.force_at = {name: n + k for k, name in enumerate(at.forces)}
        self.count = n + len(self.force_at)
        self.tie_at = [self._new() for _ in machine.ties]
        self.pull_at = {
            name: [self._new() for _ in range(2 if pinned(graph, at) else 1)]
            for name, graph in machine.graphs.items()
            if at.places[name] in CURVED
        }
        self.bound_at = {n: self._new() for n, g in machine.graphs.items() if g.torque_of}
        zero = machine.arithmetic.mpf(0)
        self.rows: Sparse = [{} for _ in range(n)]
        self.right = [machine.load.get(i, zero) for i in range(n)]
        self._springs_and_ties()
        self._contacts()
        for graph in machine.graphs.values():
            self._pull(graph)
        self._bounds()

    def _new(self) -> int:
        self.count += 1
        return self.count - 1

    @property
    def residual(self) -> Any:
        """Largest residual."""
        return max((abs(r) for r in self.right), default=0)

    def _equation(self, row: dict[int, Any], right: Any) -> None:
        self.rows.append(row)
        self.right.append(right)

    def _stiff(self, i: int, j: int, value: Any) -> None:
        if value:
            self.rows[i][j] = self.rows[i].get(j, 0) + value

    def _springs_and_ties(self) -> None:
        x = self.at.x
        for direction, stiffness, preset in self.machine.springs:
            stretch = sum(v * x[i] for i, v in direction.items()) - preset
            for i, v in direction.items():
                self.right[i] -= stiffness * stretch * v
                for j, w in direction.items():
                    self._stiff(i, j, stiffness * v * w)
        for (direction, preset), k, torque in zip(
            self.machine.ties, self.tie_at, self.at.ties, strict=True
        ):
            for i, v in direction.items():
                self.right[i] -= torque * v
                self._stiff(i, k, v)
            apart = sum(v * x[i] for i, v in direction.items()) - preset
            self._equation(dict(direction), -apart)

    def _contacts(self) -> None:
        for name, force in self.at.forces.items():
            contact, k = self.machine.contacts[name], self.force_at[name]
            approach, gradient, curvature = contact.approach(self.at.x)
            compression, slope = contact.law.at(force)
            for i, v in gradient.items():
                self.right[i] -= force * v
                self._stiff(i, k, v)
            for (i, j), v in curvature.items():
                self._stiff(i, j, force * v)
            row = {i: v for i, v in gradient.items() if v}
            if slope:
                row[k] = -slope
            self._equation(row, compression - approach)

    def _pull(self, graph: Graph) -> None:
        """Add a graph to the balance, and its constraint if it is on a step or wall."""
        at, name = self.at, graph.name
        place, bound, pull = at.places[name], at.bounds[name], at.pulls[name]
        q, radius = offset(self.machine, graph, at.x)
        i, one = graph.indices, 1 + 0 * bound
        if place not in CURVED:
            force, tangent, by_bound = on_piece(graph, place, q, radius, bound)
            for a in (0, 1):
                self.right[i[a]] -= force[a]
                for b in (0, 1):
                    self._stiff(i[a], i[b], tangent[a][b])
                if name in self.bound_at:
                    self._stiff(i[a], self.bound_at[name], by_bound[a])
            return
        unknown = self.pull_at[name]
        if len(unknown) == 2:
            for a in (0, 1):
                self.right[i[a]] -= pull[a]
                self._stiff(i[a], unknown[a], one)
                self._equation({i[a]: one}, -q[a])
            return
        edge = edge_of(graph, place, bound)
        if not radius:
            size = self.machine.arithmetic.sqrt(pull[0] ** 2 + pull[1] ** 2)
            q = [edge * v / size for v in pull] if size else [edge, 0 * edge]
            radius = edge
        e = [v / radius for v in q]
        size = pull[0] * e[0] + pull[1] * e[1]
        for a in (0, 1):
            self.right[i[a]] -= size * e[a]
            self._stiff(i[a], unknown[0], e[a])
            for b in (0, 1):
                across = (1 if a == b else 0) - e[a] * e[b]
                self._stiff(i[a], i[b], size / radius * across)
        row = {i[a]: e[a] for a in (0, 1) if e[a]}
        if name in self.bound_at and place == "step" and graph.stick is None:
            row[self.bound_at[name]] = -one / graph.stiffness
        self._equation(row, edge - radius)

    def _bounds(self) -> None:
        for name, k in self.bound_at.items():
            graph, forces = self.machine.graphs[name], self.at.forces
            total = sum(arm * forces.get(f, 0) for f, arm in graph.torque_of.items())
            sign = 1 if total >= 0 else -1
            row = {k: 1 + 0 * self.at.bounds[name]}
            for f, arm in graph.torque_of.items():
                if f in self.force_at:
                    row[self.force_at[f]] = -sign * graph.per_torque * arm
            self._equation(row, graph.per_torque * abs(total) - self.at.bounds[name])


def offset(machine: Machine, graph: Graph, x: list[Any]) -> tuple[list[Any], Any]:
    """Return the offset of a graph's gear from its centre, and its size."""
    q = [x[i] - c for i, c in zip(graph.indices, graph.centre, strict=True)]
    return q, machine.arithmetic.sqrt(q[0] * q[0] + q[1] * q[1])


def edge_of(graph: Graph, place: str, bound: Any) -> Any:
    """Return the radius of a step or wall."""
    return graph.reach if place == "wall" else graph.stick_end(bound)


def pinned(graph: Graph, at: Guess) -> bool:
    """Whether a graph is on a step or wall at radius zero, where its force has no direction."""
    place = at.places[graph.name]
    return place in CURVED and not edge_of(graph, place, at.bounds[graph.name]) > 0


def on_piece(
    graph: Graph, place: str, q: list[Any], radius: Any, bound: Any
) -> tuple[list[Any], list[list[Any]], list[Any]]:
    """Return the force on a rising or level piece and its derivatives by offset and bound."""
    zero = 0 * bound
    if place == "stick":
        k = graph.stiffness
        return [k * v for v in q], [[k, zero], [zero, k]], [zero, zero]
    beyond, rise = graph.wall(radius) if place == "stop" else (zero, zero)
    if not radius:
        return [zero, zero], [[rise, zero], [zero, rise]], [zero, zero]
    size = bound + beyond
    e = [v / radius for v in q]
    tangent = [
        [rise * e[i] * e[j] + size / radius * ((1 if i == j else 0) - e[i] * e[j]) for j in (0, 1)]
        for i in (0, 1)
    ]
    return [size * v for v in e], tangent, e
