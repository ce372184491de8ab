"""The active set of an equilibrium: closed contacts, and the piece of each radial element."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array, States
from loadshare.contact.radial import GraphPart, nearest
from loadshare.scene.structure import Structure
from loadshare.settings import FOLLOW
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.numbers import Numbers
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import Situations


@dataclass(frozen=True, slots=True)
class WorkingSet:
    """Closed contacts and pieces of the radial laws.

    Attributes
    ----------
    states : tuple of int
        Of all elements; see `loadshare.solver.hot.contact_states`.
    pieces : tuple of int
        Which piece of its table each closed tabulated contact is on.
    tied : frozenset of int
        Closed contacts, by number, that are treated as rigid: those that begin to carry under a law
        that is infinitely soft at first (c > 0), where nothing else can.
    """

    states: tuple[int, ...]
    pieces: tuple[int, ...] = ()
    tied: frozenset[int] = frozenset()

    def changes(self, other: WorkingSet, structure: Structure) -> list[int]:
        """Return the numbers of the elements whose state differs, contacts first, by name."""
        names, rows = structure.row_names, structure.rows
        changed = np.flatnonzero(np.not_equal(self.states, other.states)).tolist()
        return sorted(changed, key=lambda k: (k >= rows, names[k] if k < rows else ""))


def switch_names(structure: Structure) -> tuple[str, ...]:
    """Return the names of contacts and radial elements, in the order of an active set."""
    return (*structure.row_names, *(radial.name for radial in structure.radials))


def coordinates(structure: Structure, situation: Situations, found: Equilibrium) -> Array:
    """Return the coordinates x of an equilibrium, in the units of the elements."""
    at, order = structure.coordinates, structure.train.order
    x, turned = np.zeros(at.size), structure.turned(situation)[0]
    for gear, where in at.displacement.items():
        x[where] = at.frame[gear] @ found.displacement[gear]
    for gear, rotation in at.rotation.items():
        if rotation.index is not None:
            x[rotation.index] = (found.rotation[gear] - turned[order[gear]]) / rotation.rate
    return x / structure.length


def read_states(structure: Structure, numbers: Numbers, found: Equilibrium, x: Array) -> States:
    """Read the contact states from the forces and radii of an equilibrium.

    Parameters
    ----------
    structure : Structure
    numbers : Numbers
        At one value.
    found : Equilibrium
        Certified.
    x : ndarray, shape (n,)
        Its coordinates, in the units of the elements.
    """
    pushes = {**found.flank_force, **found.ring_force}
    force = np.array([pushes[name] for name in structure.row_names]) / structure.force
    states = np.zeros(structure.switches, dtype=np.int8)
    states[: structure.rows][force > FOLLOW.carries * max(1.0, force.max(initial=0.0))] = at.CLOSED
    rows = structure.columns.contacts
    transmitted = numbers.carried[0, :, rows] @ force
    for j, radial in enumerate(structure.radials):
        column = structure.radial_column(j)
        both = slice(column, column + 2)
        radius = float(np.linalg.norm(numbers.vectors[0, both] @ x - numbers.gap[0, both]))
        size = float(np.linalg.norm(found.radial_reaction[radial.name])) / structure.force
        law = at.graph(numbers.radial[:, j], transmitted[[j]], radius)
        states[structure.rows + j] = nearest(_parts(law), radius, size)
    return states


def _parts(law: at.Graph) -> Iterator[GraphPart]:
    """Yield the pieces and steps of a radial law."""
    first, stick, bound, reach, last = (float(v[0]) for v in law[:5])
    if np.isinf(stick):
        yield GraphPart(at.STICK, 0.0, np.inf, 0.0, 0.0, first)
        return
    if stick > 0.0:
        yield GraphPart(at.STICK, 0.0, stick, 0.0, 0.0, first)
    if reach > stick:
        # Inside a ring nothing acts; a spline without friction may have some at nearby values.
        yield GraphPart(at.SLIP if first > 0.0 else at.OPEN, stick, reach, bound, bound, 0.0)
    if np.isfinite(last):
        yield GraphPart(at.STOP, reach, np.inf, bound, bound, last)
    if bound > first * stick:
        yield GraphPart(
            at.CORNER if stick > 0.0 else at.PINNED, stick, stick, first * stick, bound, 0.0
        )
    if np.isinf(last):
        yield GraphPart(at.WALL if reach > 0.0 else at.PINNED, reach, reach, bound, np.inf, 0.0)


def set_of(
    structure: Structure,
    numbers: Numbers,
    states: tuple[int, ...],
    x: Array,
    tied: frozenset[int] = frozenset(),
) -> WorkingSet:
    """Return the set of given states at one value; pieces of tabulated contacts are read from x."""
    found, tabulated = [], numbers.tabulated[0]
    for k in np.flatnonzero(tabulated >= 0).tolist():
        if states[k - structure.springs] == at.CLOSED:
            approach = float(numbers.vectors[0, k] @ x - numbers.gap[0, k])
            points = numbers.tables[0, tabulated[k], 1]
            last = int(np.isfinite(points).sum()) - 2
            found.append(int(np.clip(np.searchsorted(points, approach) - 1, 0, last)))
    return WorkingSet(states, tuple(found), tied)
