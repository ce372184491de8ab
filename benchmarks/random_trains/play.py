"""The places of a reference equilibrium that are open, and how far they may move.

This is independent of the reference's own null vectors, which only give the directions in which a
place may begin to move: a coordinate with play that rests on a limit without pressing on it is open
all the same, and one in a limit without play is not. The largest moves are linear programmes in
doubles, along directions found in 50 digits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.reference.elements import Graph
from benchmarks.reference.elimination import solve_sparse
from benchmarks.reference.equations import Equations, Guess, offset
from benchmarks.reference.machine import Machine

FACETS = 32
"""Number of sides of the polygon that replaces a disc in which a gear may move freely."""
PIVOT = 1e-14
"""Pivot that counts as zero: the rounding of directions that should be opposite."""


def play(machine: Machine, at: Guess, force: float) -> dict[str, float]:
    """Return how far every coordinate may move without any force, in length units.

    Parameters
    ----------
    machine : Machine
    at : Guess
        A settled equilibrium.
    force : float
        Force [loads] up to which a contact counts as not pressed.

    Returns
    -------
    dict of coordinate name to float
        Distance from one end to the other over which no force changes, for every coordinate that
        can move; infinite if nothing limits it.
    """
    pressed = {n: f for n, f in at.forces.items() if f > force}
    places = {n: _released(g, at, force) for n, g in machine.graphs.items()}
    equations = Equations(machine, replace(at, forces=pressed, places=places))
    none = [0 * r for r in equations.right]
    _, spans = solve_sparse(equations.rows, none, equations.count, PIVOT)
    free = [s[: machine.size] for s in spans]
    moves = np.array([[float(v) for v in s] for s in free if any(s)])
    if not len(moves):
        return {}
    moves /= np.abs(moves).max(axis=1)[:, None]
    rows, room = _limits(machine, at, pressed, places, moves)
    return {
        name: span
        for i, name in enumerate(machine.names)
        if np.abs(moves[:, i]).max() > PIVOT and (span := _furthest(moves[:, i], rows, room)) > 0.0
    }


def _released(graph: Graph, at: Guess, force: float) -> str:
    """Return the piece of a graph; if it does not press, the piece without force instead."""
    place = at.places[graph.name]
    size = float(sum(p * p for p in at.pulls[graph.name])) ** 0.5
    loose = place in ("wall", "stop") and not graph.torque_of and graph.bound == 0
    # A power law has no stiffness at its start, but still holds the gear.
    moves = graph.reach > 0 or graph.power != 1
    return "slip" if loose and moves and size <= force else place


def _limits(
    machine: Machine,
    at: Guess,
    pressed: Mapping[str, Any],
    places: Mapping[str, str],
    moves: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return rows and bounds that keep moves from closing a contact or leaving a disc."""
    rows, room = [], []
    for name, contact in machine.contacts.items():
        if name in pressed:
            continue
        approach, gradient, _ = contact.approach(at.x)
        rows.append(moves @ _dense(gradient, machine.size))
        room.append(max(-float(approach), 0.0))
    for name, graph in machine.graphs.items():
        if places[name] != "slip":
            continue
        q, _ = offset(machine, graph, at.x)
        here = np.array([float(v) for v in q])
        for angle in np.arange(FACETS) * (2.0 * np.pi / FACETS):
            way = np.array([np.cos(angle), np.sin(angle)])
            rows.append(way @ moves[:, list(graph.indices)].T)
            room.append(max(float(graph.reach) * np.cos(np.pi / FACETS) - float(way @ here), 0.0))
    return np.array(rows).reshape(-1, len(moves)), np.array(room)


def _dense(gradient: Mapping[int, Any], size: int) -> NDArray[np.float64]:
    row = np.zeros(size)
    for i, value in gradient.items():
        row[i] = float(value)
    return row


def _furthest(
    along: NDArray[np.float64], rows: NDArray[np.float64], room: NDArray[np.float64]
) -> float:
    """Return how far a coordinate may move, from one end to the other."""
    from scipy.optimize import linprog

    ends = []
    for sign in (1.0, -1.0):
        found = linprog(
            -sign * along, A_ub=rows if len(rows) else None, b_ub=room if len(rows) else None,
            bounds=(None, None), method="highs",
        )  # fmt: skip
        if found.status == 3:
            return float("inf")
        ends.append(0.0 if found.fun is None or found.status else -float(found.fun))
    return sum(ends)
