"""A set followed between solved points: stretches are proved as a whole or in parts.

Between two points of one set its own equations are followed: as long as the set holds, a certified
solve would find the same. Parts are cut at points at which only these equations were solved.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import FOLLOW
from loadshare.study.follow.equations import Equations
from loadshare.study.follow.line import Line
from loadshare.study.follow.proof import Proof, prove
from loadshare.study.follow.stretches import Stretches

Ends = tuple[float, float, Array, Array]
"""Values at both ends of a stretch, and the unknowns there."""
HIDDEN = "round-off hides what holds its bodies"
"""Why no part of a stretch, however short, is enclosed."""


class UnprovedPart(NamedTuple):
    """A part of a stretch that is not proved.

    Attributes
    ----------
    number : int
        Of the stretch.
    ends : Ends
    why : str
        Empty if the set does not hold in the part's middle: another may be found there.
    """

    number: int
    ends: Ends
    why: str


class _Alone(NamedTuple):
    """Whether a set holds at a point, and whether the point is enclosed."""

    holds: bool
    enclosed: bool


class Prover:
    """Prover that sets hold along stretches of a position.

    Parameters
    ----------
    line : Line
    position : int
        1-based.
    least : float
        Width up to which a stretch is not cut any more.
    """

    def __init__(self, line: Line, position: int, least: float) -> None:
        self.line, self.position, self.least = line, position, least

    def proof(self, equations: Equations, ends: Sequence[Ends]) -> Proof:
        """Try to prove that a set holds on stretches as a whole."""
        tau = np.linspace(0.0, 1.0, FOLLOW.nodes)
        values = np.concatenate([low + tau * (high - low) for low, high, *_ in ends])
        numbers = self.line.numbers(self.position, values)
        return prove(Stretches(equations, np.array([[a, b] for _, _, a, b in ends]), numbers))

    def unproved(self, equations: Equations, ends: Sequence[Ends]) -> list[UnprovedPart]:
        """Prove stretches, as a whole or in parts, and return the parts that are not proved."""
        left: list[UnprovedPart] = []
        parts = list(enumerate(ends))
        known: dict[float, _Alone] = {}
        while parts:
            holds = self.proof(equations, [part for _, part in parts]).holds
            parts = [part for part, proved in zip(parts, holds, strict=True) if not proved]
            if not parts or len(parts) > FOLLOW.parts:
                break
            middles, solved = self._middles(equations, [part for _, part in parts])
            points = dict(middles)
            for _, (low, high, first, last) in parts:
                points |= {low: first, high: last}
            known |= self._alone(equations, {v: z for v, z in points.items() if v not in known})
            halves: list[tuple[int, Ends]] = []
            for (k, part), (value, z), good in zip(parts, middles, solved, strict=True):
                low, high, first, last = part
                why = self._hopeless([known[v] for v in (low, value, high)], high - low)
                if why or not good or known[value] == _Alone(holds=False, enclosed=True):
                    left.append(UnprovedPart(k, part, why))
                else:
                    halves += [(k, (low, value, first, z)), (k, (value, high, z, last))]
            parts = halves
        return left + [UnprovedPart(k, part, "it needs too many parts") for k, part in parts]

    def _middles(
        self, equations: Equations, ends: Sequence[Ends]
    ) -> tuple[list[tuple[float, Array]], list[bool]]:
        """Return points at which to cut stretches, and whether each is solved, from its chord."""
        values = np.array([low + FOLLOW.cut * (high - low) for low, high, *_ in ends])
        near = np.array([first + FOLLOW.cut * (last - first) for *_, first, last in ends])
        z, good = equations.solve(near, self.line.numbers(self.position, values))
        return list(zip(values.tolist(), z, strict=True)), good.tolist()

    def _alone(self, equations: Equations, points: dict[float, Array]) -> dict[float, _Alone]:
        """Return what is proved of each point alone, by value."""
        found = self.proof(equations, [(v, v, z, z) for v, z in points.items()])
        flags = zip(found.holds.tolist(), found.enclosed.tolist(), strict=True)
        return {value: _Alone(*both) for value, both in zip(points, flags, strict=True)}

    def _hopeless(self, alone: Sequence[_Alone], width: float) -> str:
        """Return why no part of a stretch can be proved, by ends and middle; empty if one may."""
        if not (alone[0].enclosed or alone[-1].enclosed):
            return HIDDEN
        if not any(point.holds for point in alone):
            return "all of it is too close to a change for double precision"
        return "no proof was found, however narrow" if width <= self.least else ""


def between(values: Sequence[float], z: Sequence[Array] | Array) -> list[Ends]:
    """Return the stretches between neighbouring values, rising or falling."""
    pairs = zip(values[:-1], values[1:], z[:-1], z[1:], strict=True)
    return [(a, b, p, q) if a < b else (b, a, q, p) for a, b, p, q in pairs]
