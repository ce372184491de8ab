r"""The phase of every mesh in its cycle, from tooth counts and the places of gears.

The phase of a mesh is the fraction of its cycle that has passed since a pair of teeth last touched
at the pitch point. Let gear i have z teeth, one of them at the angle τ with the half angle h at the
pitch circle, and the pitch point at β, all along its sense of rotation. Then

.. math:: \gamma = \frac{z_i}{2\pi}\,(\tau_i \pm h_i - \beta_i) \mod 1 ,

with plus for the leading flank of a driver, minus for the trailing flank of a driven gear, and the
other two flanks for the coast side. Helical teeth are at different angles at different heights: τ
is that in the middle of the common face, where contact at the pitch point counts. A face gear is
treated like any other gear, with its pitch point in the direction of the pinion. Both gears of a
mesh must give the same phase; in a planetary set that is the assembly condition. Source:
formulation, section 13.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from loadshare.train.gear import Gear

WHOLE = 1e-2
"""How far a number of teeth that follows from (rounded) radii may be from a whole number."""
Both = tuple[float, float]
"""Phases of the drive and of the coast flank of a mesh."""
MEETS = 0.02
"""By how many pitches teeth may miss each other and still meet: places are written with few
digits."""


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """The data of a mesh from which its phase follows.

    Attributes
    ----------
    driver, driven : Gear
    halves : (float, float)
        Half the angle of a tooth of each at the pitch circle [rad].
    senses : (int, int)
        See `Mesh`: the phase counts in the sense in which the drive flank moves.
    twists : (float, float)
        Angle about its axis by which a tooth of each is further on in the middle of the common face
        than in the middle of its gear [rad].
    """

    driver: Gear
    driven: Gear
    halves: tuple[float, float]
    senses: tuple[int, int] = (1, 1)
    twists: tuple[float, float] = (0.0, 0.0)

    @property
    def ends(self) -> tuple[str, str]:
        """Names of the two gears."""
        return self.driver.name, self.driven.name

    def passed(self, gear: str, tooth: float, drive: bool = True) -> float:
        """Return how many pitches a flank is past the pitch point, its tooth at an angle [rad]."""
        here, sense = self._counted(gear)
        end = 0 if here is self.driver else 1
        half = self.halves[end] if drive == (end == 0) else -self.halves[end]
        along = sense * (tooth + self.twists[end] - self._towards(gear))
        return round(here.teeth or 0.0) * (along + half) / (2.0 * math.pi)

    def tooth(self, gear: str, phase: float, drive: bool = True) -> float:
        """Return the angle of a tooth of a gear [rad] when one of its flanks is at a phase."""
        here, sense = self._counted(gear)
        pitches = phase - self.passed(gear, 0.0, drive)
        return sense * 2.0 * math.pi * pitches / round(here.teeth or math.inf)

    def _counted(self, gear: str) -> tuple[Gear, int]:
        """Return one of the two gears, and the sense in which its angles count in the phase."""
        if gear == self.driver.name:
            return self.driver, self.senses[0] * self.driver.sense
        return self.driven, self.senses[1] * self.driven.sense

    def _towards(self, gear: str) -> float:
        """Return the direction of the pitch point from a gear's centre [rad], in its frame."""
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
class PhaseMisfit:
    """A mesh whose teeth do not meet.

    Attributes
    ----------
    mesh : str
    pitches : float
        By how much, −½ to ½.
    """

    mesh: str
    pitches: float


def phases(
    meetings: Mapping[str, Meeting], walk: Sequence[str]
) -> tuple[dict[str, Both], tuple[PhaseMisfit, ...]]:
    """Return the phases of all meshes of gears with whole tooth numbers, and the misfits.

    In every group of gears that meshes connect, the mesh nearest to the input begins its cycle: the
    leading flank of the nearer of its two gears is at the pitch point, whichever flank carries and
    whichever gear is named first.

    Parameters
    ----------
    meetings : mapping of mesh to Meeting
    walk : sequence of str
        All gears, those that are nearer to the input first.
    """
    order = {gear: k for k, gear in enumerate(walk)}
    known = {
        name: meetings[name]
        for name in sorted(meetings, key=lambda n: sorted(order[end] for end in meetings[n].ends))
        if is_whole(meetings[name].driver.teeth) and is_whole(meetings[name].driven.teeth)
    }
    # Where the teeth are depends on which flanks touch: one walk for each side.
    drive, misfits = _walked(known, order, drive=True)
    coast, _ = _walked(known, order, drive=False)
    return {n: (_of_cycle(drive[n]), _of_cycle(coast[n])) for n in drive}, tuple(misfits)


def _walked(
    known: Mapping[str, Meeting], order: Mapping[str, int], *, drive: bool
) -> tuple[dict[str, float], list[PhaseMisfit]]:
    """Return the phases of all meshes if their flanks of one side touch, and the misfits."""
    teeth: dict[str, float] = {}
    found: dict[str, float] = {}
    misfits: list[PhaseMisfit] = []
    for meeting in known.values():
        if meeting.driver.name in teeth or meeting.driven.name in teeth:
            continue
        drives = order[meeting.driver.name] < order[meeting.driven.name]
        start = (meeting.driver if drives else meeting.driven).name
        teeth[start] = meeting.tooth(start, 0.0, drives)
        queue = deque([start])
        while queue:
            here = queue.popleft()
            for name, other, there in _meshes_of(here, known):
                phase = there.passed(here, teeth[here], drive) % 1.0
                if other not in teeth:
                    teeth[other] = there.tooth(other, phase, drive)
                    queue.append(other)
                    found[name] = phase
                elif name not in found:
                    found[name] = phase
                    off = (there.passed(other, teeth[other], drive) - phase + 0.5) % 1.0 - 0.5
                    if abs(off) > MEETS:
                        misfits.append(PhaseMisfit(name, off))
    return found, misfits


def _of_cycle(phase: float) -> float:
    # A phase of a whole cycle, up to round-off, is a phase of 0.
    return phase if phase < 1.0 - 1e-9 else 0.0


def _meshes_of(gear: str, known: Mapping[str, Meeting]) -> Iterator[tuple[str, str, Meeting]]:
    for name, meeting in known.items():
        if gear == meeting.driver.name:
            yield name, meeting.driven.name, meeting
        elif gear == meeting.driven.name:
            yield name, meeting.driver.name, meeting


def is_whole(teeth: float | None) -> bool:
    """Return whether a number of teeth is known and whole."""
    return teeth is not None and bool(np.isclose(teeth, round(teeth), rtol=0.0, atol=WHOLE))
