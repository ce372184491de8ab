"""From set to set until every sample is consistent.

Samples that stand on the same set are solved together. Of all sets the one with most samples goes
first, so that few visits serve many.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.elements import Basis, Data, Elements
from loadshare.solver.hot import places as at
from loadshare.solver.hot.state import State
from loadshare.solver.hot.vectorised import pick

Codes = NDArray[np.int8]
Engine = Callable[
    [Elements, Data, Basis, Codes, NDArray[np.intp], State, NDArray[np.bool_]],
    tuple[Codes, Codes],
]

TOGETHER = 6
"""Exchanges of all wrong signs at once; after these, one at a time."""
TURNS = 12
"""Turns allowed in all, more for more switches."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What the hot path found.

    Attributes
    ----------
    solved : ndarray of bool, shape (S,)
        Samples with a consistent set.
    code : ndarray of int8, shape (S, switches)
        The sets.
    turns : ndarray of int, shape (S,)
        Sets that each sample visited.
    held : ndarray of bool, shape (S,)
        Whether the set leaves no coordinate loose.
    """

    solved: NDArray[np.bool_]
    code: Codes
    turns: NDArray[np.intp]
    held: NDArray[np.bool_]

    def completed(self, other: Found) -> Found:
        """Return what was found here, and elsewhere what the other found."""
        mine = self.solved
        return Found(
            mine | other.solved,
            np.where(mine[:, None], self.code, other.code),
            self.turns + other.turns,
            np.where(mine, self.held, other.held),
        )


def first_sets(elements: Elements, data: Data) -> Codes:
    """Drive flanks closed under load, other rows open, radial elements on their first piece."""
    count = data.count
    code = np.zeros((count, elements.switches), dtype=np.int8)
    everyone = np.arange(count)
    push = np.abs(pick(data.load, everyone)).max(axis=1, initial=0.0)
    for k, row in enumerate(elements.scene.rows):
        if row.kind == "drive flank":
            code[:, k] = np.where(push > 0.0, at.CLOSED, at.OPEN)
    for j, radial in enumerate(elements.scene.radials):
        gear = elements.scene.train.gears[radial.gear]
        driving = elements.scene.train.gears[elements.scene.train.input]
        torque = np.broadcast_to(push * driving.base_radius / (gear.ratio or 1.0), (count,))
        law = at.graph(pick(data.radial, everyone)[:, j], torque)
        rigid = np.isinf(law.last) & (law.reach == 0.0)
        free = (law.bound == 0.0) & (law.stick == 0.0)
        resting = np.where(law.reach > 0.0, at.OPEN, np.where(rigid, at.PINNED, at.STOP))
        held = np.where(law.stick > 0.0, at.STICK, at.PINNED)
        code[:, elements.rows + j] = np.where(free, resting, held)
    return code


def exchange(
    elements: Elements,
    data: Data,
    state: State,
    engine: Engine,
    code: Codes | None = None,
    only: NDArray[np.bool_] | None = None,
    singly: bool = False,
) -> Found:
    """Lead every sample to a consistent set.

    Parameters
    ----------
    elements : Elements
    data : Data
    state : State
        At the start; renewed in place.
    engine : Engine
        `vectorised.settle` or `compiled.settle`.
    code : ndarray of int8, shape (S, switches), optional
        Sets to begin with.
    only : ndarray of bool, shape (S,), optional
        Samples to solve; all by default.
    singly : bool
        Exchange one element at a time from the beginning.

    Returns
    -------
    Found
        Samples that ran into a cycle, a mechanism or a law without meaning are not solved.
    """
    code = first_sets(elements, data) if code is None else np.array(code)
    count = len(code)
    solved = np.zeros(count, dtype=bool)
    turns = np.zeros(count, dtype=np.intp)
    held = np.zeros(count, dtype=bool)
    one_only = np.full(count, singly)
    limit = TURNS + 2 * elements.switches
    rows = np.arange(count) if only is None else np.flatnonzero(only)
    waiting = _grouped(code[rows], rows)
    while waiting:
        key = max(waiting, key=lambda k: sum(map(len, waiting[k])))
        rows = np.concatenate(waiting.pop(key))
        here = np.frombuffer(key, dtype=np.int8)
        turns[rows] += 1
        basis = elements.basis(here)
        verdict, proposal = engine(elements, data, basis, here, rows, state, one_only)
        done = rows[verdict == at.DONE]
        solved[done], held[done] = True, not basis.loose.shape[1]
        onward = (verdict == at.OTHER) & (turns[rows] < limit)
        rows = rows[onward]
        code[rows] = _without_wedges(elements, data, here, proposal[onward])
        one_only[rows] |= turns[rows] >= TOGETHER
        for other, more in _grouped(code[rows], rows).items():
            waiting.setdefault(other, []).extend(more)
    return Found(solved, code, turns, held)


def _without_wedges(elements: Elements, data: Data, here: Codes, proposal: Codes) -> Codes:
    """Let only one of two opposed rigid arcs act: the one that is new."""
    for one, other in elements.opposed:
        columns = elements.springs + np.array([one, other])
        both = (proposal[:, one] != at.OPEN) & (proposal[:, other] != at.OPEN)
        if both.any() and not data.bending[:, columns].any():
            leaves = one if here[one] != at.OPEN else other
            proposal[both, leaves] = at.OPEN
    return proposal


def _grouped(code: Codes, rows: NDArray[np.intp]) -> dict[bytes, list[NDArray[np.intp]]]:
    """Rows by the set they stand on."""
    if not len(rows):
        return {}
    if not code.shape[1]:
        return {b"": [rows]}
    keys = np.ascontiguousarray(code).view(np.dtype((np.void, code.shape[1])))[:, 0]
    if (keys == keys[0]).all():
        return {keys[0].tobytes(): [rows]}
    unique, which = np.unique(keys, return_inverse=True)
    order = np.argsort(which, kind="stable")
    ends = np.cumsum(np.bincount(which))
    return {
        key.tobytes(): [part]
        for key, part in zip(unique, np.split(rows[order], ends[:-1]), strict=True)
    }
