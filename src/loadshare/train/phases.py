r"""Where every mesh is in its cycle, from tooth counts and the places of gears.

The phase of a mesh is what has passed of its cycle since the last pair of teeth touched at the
pitch point. Seen from gear i with z teeth, one of them at the angle τ with half the angle h at the
pitch circle, the pitch point at β, all along its sense of rotation,

.. math:: \gamma = \frac{z_i}{2\pi}\,(\tau_i \pm h_i - \beta_i) \mod 1 ,

with the leading flank of a driver and the trailing flank of what is driven. Both gears of a mesh
must say the same; in a planetary set that is the condition of assembly. Source: formulation,
section 13.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from loadshare.train.gear import Gear

WHOLE = 1e-6
"""How far a number of teeth that follows from others may be from a whole one [-]."""
MEETS = 0.02
"""How far teeth may be from where they meet, in pitches: places are written with few digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """A mesh as its phase needs it.

    Attributes
    ----------
    driver, driven : Gear
    halves : (float, float)
        Half the angle of a tooth of each at the pitch circle [rad].
    counted : (int, int)
        See `Mesh`: the phase counts in the sense in which the drive flank goes.
    """

    driver: Gear
    driven: Gear
    halves: tuple[float, float]
    counted: tuple[int, int] = (1, 1)

    def passed(self, gear: str, tooth: float) -> float:
        """Pitches by which the flank of a tooth at an angle [rad] is past the pitch point."""
        here, sense = self._counted(gear)
        half = self.halves[0] if here is self.driver else -self.halves[1]
        along = sense * (tooth - self._towards(gear))
        return round(here.teeth or 0.0) * (along + half) / (2.0 * math.pi)

    def tooth(self, gear: str, phase: float) -> float:
        """Angle of a tooth of a gear [rad] in a phase."""
        here, sense = self._counted(gear)
        pitches = phase - self.passed(gear, 0.0)
        return sense * 2.0 * math.pi * pitches / round(here.teeth or math.inf)

    def _counted(self, gear: str) -> tuple[Gear, int]:
        """One of the two gears, and the sense in which its part of the phase counts."""
        if gear == self.driver.name:
            return self.driver, self.counted[0] * self.driver.sense
        return self.driven, self.counted[1] * self.driven.sense

    def _towards(self, gear: str) -> float:
        """Direction of the pitch point from a gear's centre [rad], in its frame."""
        one, other = self.driver, self.driven
        if gear != one.name:
            one, other = other, one
        way = other.centre - one.centre
        # In an internal pair the pitch point lies on the pinion's side of the ring's centre.
        if other.kind == "internal":
            way = -way
        x, y = one.frame @ way
        return math.atan2(y, x)


@dataclass(frozen=True, slots=True)
class Misfit:
    """A mesh whose teeth do not meet.

    Attributes
    ----------
    mesh : str
    pitches : float
        By how much, −½ to ½.
    """

    mesh: str
    pitches: float


def phases(meetings: Mapping[str, Meeting]) -> tuple[dict[str, float], tuple[Misfit, ...]]:
    """Return the phases of all meshes between gears with whole teeth, and what does not meet.

    The first mesh of a gear from which nothing leads to another begins its cycle.

    Parameters
    ----------
    meetings : mapping of mesh to Meeting
    """
    known = {name: m for name, m in meetings.items() if _is_whole(m.driver) and _is_whole(m.driven)}
    teeth: dict[str, float] = {}
    found: dict[str, float] = {}
    misfits: list[Misfit] = []
    for first, meeting in known.items():
        if meeting.driver.name in teeth or meeting.driven.name in teeth:
            continue
        teeth[meeting.driver.name] = known[first].tooth(meeting.driver.name, 0.0)
        queue = deque([meeting.driver.name])
        while queue:
            here = queue.popleft()
            for name, other, there in _meshes_of(here, known):
                phase = there.passed(here, teeth[here]) % 1.0
                if other not in teeth:
                    teeth[other] = there.tooth(other, phase)
                    queue.append(other)
                    found[name] = phase
                elif name not in found:
                    found[name] = phase
                    off = (there.passed(other, teeth[other]) - phase + 0.5) % 1.0 - 0.5
                    if abs(off) > MEETS:
                        misfits.append(Misfit(name, off))
    # What is a whole cycle up to round-off is none.
    return {n: p if p < 1.0 - 1e-9 else 0.0 for n, p in found.items()}, tuple(misfits)


def _meshes_of(gear: str, known: Mapping[str, Meeting]) -> Iterator[tuple[str, str, Meeting]]:
    for name, meeting in known.items():
        if gear == meeting.driver.name:
            yield name, meeting.driven.name, meeting
        elif gear == meeting.driven.name:
            yield name, meeting.driver.name, meeting


def _is_whole(gear: Gear) -> bool:
    if gear.teeth is None or gear.kind == "face":
        return False
    return bool(np.isclose(gear.teeth, round(gear.teeth), rtol=0.0, atol=WHOLE))
