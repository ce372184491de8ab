"""A pair of gears at positions of the mesh cycle: where flanks first touch, gaps elsewhere."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from loadshare.errors import Problem
from loadshare.settings import TEETH
from loadshare.tooth.geometry.body import Array, ToothBody
from loadshare.tooth.geometry.flank import Patch, dot, relative_curvature, unit
from loadshare.tooth.geometry.gap import FEWEST, Extents, NoContactError, Trace, least_gap
from loadshare.tooth.problems import digits, problem

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from loadshare.tooth.cylindrical.body import HelicoidBody
    from loadshare.tooth.cylindrical.flank import HelicoidFlank
    from loadshare.tooth.face.flank import FaceFlank


Place: TypeAlias = tuple[Array, Array]
"""Surface parameters of points on a flank."""


@dataclass(frozen=True, eq=False)
class ContactLine:
    """One pair of teeth at one meshing position.

    The line is the straight contact line of the plane of action for cylindrical gears, the line
    through the contact ellipse along its major axis where contact is localised.

    Parameters
    ----------
    pair : int
        Index of the pair of teeth. Pair 0 meets at the pitch point at phase 0, and pair k is on
        tooth k of the driver; pairs with a larger k meet earlier.
    points : array (n, 3)
        Points on the driver's flank, in the middle of n equal parts of the line, fixed frame [m].
    normals : array (n, 3)
        Unit vectors from the driver into the driven tooth.
    length : array (n,)
        Length of line that each point represents [m]; the sum is the length of the line.
    gap : array (n,)
        Distance of the unloaded flanks along the normal [m] when the driver has the transmission
        error of the position: 0 where the flanks first touch (which need not be one of the
        points), positive elsewhere.
    curvature : array (n,)
        Relative curvature across the line [1/m], positive where the flanks part.
    curvature_along : array (n,)
        Relative curvature along the line [1/m]; 0 for an unmodified cylindrical pair.
    driver_uw, driven_uw : array (n, 2)
        Flank coordinates of the points for `ToothBody.outline`.
    """

    pair: int
    points: Array
    normals: Array
    length: Array
    gap: Array
    curvature: Array
    curvature_along: Array
    driver_uw: Array
    driven_uw: Array


@dataclass(frozen=True, eq=False)
class MeshPosition:
    """Pairs of teeth that touch, or nearly touch, at one position of the mesh cycle.

    Parameters
    ----------
    phase : float
        0 ≤ phase < 1 of the mesh cycle; the driver turns by one pitch per cycle.
    driver_rotation, driven_rotation : float
        Angles about the gears' own axes [rad]; the driver's includes `transmission_error`.
    transmission_error : float
        Angle by which the driver is ahead of the ideal pair when the first flanks touch, the
        driven gear held where the ideal pair would have it [rad].
    lines : tuple of ContactLine
        Every pair whose line has a part on both active flanks, by rising pair index.
    """

    phase: float
    driver_rotation: float
    driven_rotation: float
    transmission_error: float
    lines: tuple[ContactLine, ...]


class GearPair(ABC):
    """Two gears in mesh: the driver turns positively and pushes with its side +1.

    Pair k is on tooth k of the driver and on tooth k·`driven_step` of the driven gear. The fixed
    frame has the driver's axis as z and the middle of its face width as origin; the pitch point
    lies on +x.
    """

    misalignment: DataclassInstance
    """Misalignment of the gears; none by default."""

    @property
    @abstractmethod
    def driver(self) -> HelicoidBody:
        """Tooth of the driving gear."""

    @property
    @abstractmethod
    def driven(self) -> ToothBody:
        """Tooth of the driven gear."""

    @property
    @abstractmethod
    def driven_side(self) -> int:
        """Side of the driven tooth that is pushed, +1 or −1."""

    @property
    @abstractmethod
    def flanks(self) -> tuple[HelicoidFlank, HelicoidFlank | FaceFlank]:
        """The flanks that touch, of the driver and of the driven gear."""

    @property
    @abstractmethod
    def working_angle(self) -> float:
        """Transverse pressure angle of the driver at the pitch point [rad]."""

    @property
    @abstractmethod
    def roll_range(self) -> tuple[float, float]:
        """Driver's angle of roll over which both flanks are active [rad]."""

    @property
    def overlap_ratio(self) -> float:
        """Overlap ratio ε_β of one half; 0 for spur teeth and face gears."""
        return 0.0

    @property
    def driven_step(self) -> int:
        """Step of the driven tooth from pair to pair, +1 or −1: −1 for two external gears."""
        return -self.driven_side

    @property
    def arm(self) -> float:
        """Approach along the normal per radian of the driver, r_b cos β_b [m]."""
        return self.driver.gear.base_radius * math.cos(self.driver.gear.base_helix_angle)

    @property
    def helices(self) -> int:
        """2 for a herringbone pair, whose lines cover one half; else 1."""
        return self.driver.gear.helices

    @property
    def ratio(self) -> float:
        """Angle of the driver over angle of the driven gear, positive."""
        return self.driven.gear.teeth / self.driver.gear.teeth

    @property
    def contact_ratio(self) -> float:
        """Transverse contact ratio ε_α without load."""
        first, last = self.roll_range
        return (last - first) * self.driver.gear.teeth / (2.0 * math.pi)

    def openings(self, pairs: Array) -> Array:
        """Return how far pitch deviations part the flanks of pairs (m,) along their normals [m].

        A tooth of the driver that is ahead is nearer to its partner, one of the driven gear is
        farther from it; that the contact line moves along with the tooth is neglected.
        """
        one, two = self.driver.gear, self.driven.gear
        if one.pitch is None and two.pitch is None:
            return np.zeros(len(pairs))
        late = [self.ratio * two.ahead(int(k)) - one.ahead(int(k)) for k in pairs]
        return self.arm * np.array(late)

    @property
    def ends(self) -> tuple[float, float]:
        """Axial coordinates of the ends of the contact lines on the driver [m]."""
        return 0.0, 0.0

    @property
    def changes(self) -> tuple[float, ...]:
        """Phases at which lines begin, end, or reach an end of the face, without load.

        There the contact of an ideally placed pair of teeth enters or leaves the range of roll.
        """
        driver = self.ideal(np.zeros(1))[0]
        pitches = self.driver.gear.kind * self.driver.gear.teeth / (2.0 * math.pi)
        at = [float(self.roll(np.zeros(1), end, driver)[0]) for end in self.ends]
        found = {(roll - own) * pitches % 1.0 for roll in self.roll_range for own in at}
        return tuple(sorted(found))

    @abstractmethod
    def ideal(self, phase: Array) -> tuple[Array, Array]:
        """Return the rotations of driver and driven gear at phases of the ideal pair [rad]."""

    @abstractmethod
    def extents(self, driver: Array, driven: Array) -> Extents:
        """Return the pairs' lines on both active flanks at positions (k,), by position and pair."""

    @abstractmethod
    def margins_about(self, driver: Array, driven: Array) -> Mapping[str, Array]:
        """Return `margins` along the lines of pairs near contact, whether on both flanks or not."""

    def margins(self, driver_at: Place, driven_at: Place) -> Mapping[str, Array]:
        """Return the distance [m] to each named edge of the active flanks, negative beyond it."""
        sides = ("driver", self.driver, driver_at), ("driven", self.driven, driven_at)
        return {
            f"{name} {edge}": margin
            for name, body, at in sides
            for edge, margin in body.margins(*at).items()
        }

    def roll(self, pairs: Array, axial: Array | float, driver: Array) -> Array:
        """Return the driver's angle of roll where its flank crosses the plane of action."""
        gear = self.driver.gear
        phi = driver + 2.0 * math.pi * pairs / gear.teeth + gear.base_half_angle
        return self.working_angle + gear.kind * (phi + gear.twist * axial)

    def turns(self, pairs: Array, driver: Array, driven: Array) -> tuple[Array, Array]:
        """Return how far the teeth of pairs have turned at rotations of their gears [rad]."""
        pitches = 2.0 * math.pi / self.driver.gear.teeth, 2.0 * math.pi / self.driven.gear.teeth
        return driver + pitches[0] * pairs, driven + self.driven_step * pitches[1] * pairs

    def driver_patch(self, pairs: Array, at: Place, rotation: Array) -> Patch:
        """Return points of the driver's flanks at surface parameters `at`, fixed frame."""
        return self.flanks[0].patch(*at, self.turns(pairs, rotation, rotation)[0])

    def driven_patch(self, pairs: Array, at: Place, rotation: Array) -> Patch:
        """Return points of the driven gear's flanks at surface parameters `at`, fixed frame."""
        place = self.driven.placement
        patch = self.flanks[1].patch(*at, self.turns(pairs, rotation, rotation)[1])
        return patch.turned(place.axes, place.origin)

    def positions(
        self, phases: int | Sequence[float], points_per_line: int
    ) -> tuple[MeshPosition, ...]:
        """Find the unloaded contact at several phases, all at once.

        Parameters
        ----------
        phases : int or sequence of float
            Number of equal steps of the mesh cycle, or phases of it, 0 ≤ phase < 1.
        points_per_line : int
            Points on every contact line.

        Raises
        ------
        ValueError
            If a phase or `points_per_line` is out of range.
        NoContactError
            If no pair of teeth is within both active flanks at one of the phases.
        """
        if isinstance(phases, int):
            phases = [index / phases for index in range(phases)]
        wrong = [phase for phase in phases if not 0.0 <= phase < 1.0]
        if wrong:
            raise ValueError(f"phase = {wrong[0]} is not within the mesh cycle: give 0 ≤ phase < 1")
        if points_per_line < 1:
            raise ValueError(f"points_per_line = {points_per_line}: give at least 1")
        error, found, trace = touching(self, phases, points_per_line)
        part = (found.end - found.start) / points_per_line
        along = unit(trace.tangent)
        across = np.cross(trace.driver.normal, along)
        length = part[:, None] * np.sqrt(dot(trace.tangent, trace.tangent))
        columns = (
            trace.driver.point,
            trace.driver.normal,
            length,
            trace.gap + self.openings(found.pairs)[:, None],
            relative_curvature(trace.driver, trace.driven, across),
            relative_curvature(trace.driver, trace.driven, along),
            _located(self.driver, trace.driver.point, found.driver),
            _located(self.driven, trace.driven.point, found.driven),
        )
        rows = zip(found.pairs, *columns, strict=True)
        lines = [ContactLine(int(number), *parts) for number, *parts in rows]
        made = []
        for k, phase in enumerate(phases):
            own = np.flatnonzero(found.position == k)
            rotations = float(found.driver[own[0]]), float(found.driven[own[0]])
            own_lines = tuple(lines[i] for i in own)
            made.append(MeshPosition(phase, *rotations, float(error[k]), own_lines))
        return tuple(made)


def transmission_error(pair: GearPair, phase: float) -> float:
    """Return the lead of the driver over the ideal pair when the first flanks touch [rad].

    Raises
    ------
    NoContactError
        If no pair of teeth is within both active flanks.
    """
    return float(touching(pair, [phase])[0][0])


def touching(
    pair: GearPair, phases: Sequence[float] | Array, points: int = FEWEST
) -> tuple[Array, Extents, Trace]:
    """Find where the first flanks touch.

    The driver turns until the least gap over all lines of a position is zero; each step is the
    least gap over the arm, after which the lines are found anew.

    Returns
    -------
    error : array (k,)
        Transmission errors [rad].
    found : Extents
        The lines there.
    trace : Trace
        Both flanks in the middles of `points` equal parts of every line.

    Raises
    ------
    NoContactError
        If no pair of teeth is within both active flanks at one of the phases.
    """
    driver, driven = pair.ideal(np.array(phases))
    error = np.zeros(len(phases))
    for _ in range(TEETH.meets):
        found = pair.extents(driver + error, driven)
        for k, phase in enumerate(phases):
            if k not in found.position:
                here = (driver[k : k + 1] + error[k : k + 1], driven[k : k + 1])
                raise NoContactError(
                    f"no pair of teeth is in contact at phase {phase:.4g} of the mesh cycle: "
                    f"{_missed(pair.margins_about(*here), pair.arm)}"
                )
        least = np.full(len(phases), np.inf)
        gap, _, trace = least_gap(found, points)
        np.minimum.at(least, found.position, gap + pair.openings(found.pairs))
        apart = np.abs(least) >= TEETH.touching
        if not apart.any():
            return error, found, trace
        error = error + np.where(apart, least / pair.arm, 0.0)
    found = pair.extents(driver + error, driven)
    return error, found, least_gap(found, points)[2]


def ratio_problems(pair: GearPair, hint: str) -> Iterator[Problem]:
    """Yield a problem if there are positions without teeth in contact."""
    total = pair.contact_ratio + pair.overlap_ratio
    if total < 1.0 or pair.contact_ratio <= 0.0:
        what = f"the contact ratio is {total:.3f}: at some positions no teeth are in contact"
        allowed = "a contact ratio of 1 or more"
        yield problem("driver.addendum", pair.driver.gear.addendum, what, allowed, hint)


def meeting_problems(pair: GearPair) -> list[Problem]:
    """Return a problem if, because of the misalignment, no teeth meet at some position."""
    off = {name: value for name, value in asdict(pair.misalignment).items() if value}
    if not off:
        return []
    try:
        touching(pair, np.arange(TEETH.looked_at) / TEETH.looked_at)
    except NoContactError as error:
        name, value = next(iter(off.items()))
        alone = len(off) == 1
        key, given = (f"misalignment.{name}", digits(value)) if alone else ("misalignment", "")
        return [problem(key, given, str(error), "less; wider faces or longer teeth help too")]
    return []


def _missed(margins: Mapping[str, Array], far: float) -> str:
    """Say by how much the flanks miss at least, if less than `far`, and at which edge."""
    names, values = list(margins), np.stack([np.ravel(part) for part in margins.values()])
    values = np.where(np.isfinite(values), values, -np.inf)
    worst = values.min(axis=0)
    nearest = int(np.argmax(worst))
    edge, short = names[int(np.argmin(values[:, nearest]))], -1e3 * float(worst[nearest])
    if not short < 1e3 * far:
        return "the flanks are nowhere near one another"
    return f"the nearest contact line misses the active flanks by {short:.3g} mm at the {edge}"


def between(first: Array, last: Array) -> tuple[NDArray[np.int64], Array]:
    """Return indices into `first` and `last` (k,), and the whole numbers between the two (m,)."""
    low, high = np.ceil(first), np.floor(last)
    numbers = np.arange(low.min(), high.max() + 1.0)
    place, at = np.nonzero((numbers >= low[:, None]) & (numbers <= high[:, None]))
    return place, numbers[at]


def _located(body: ToothBody, points: Array, rotation: Array) -> Array:
    return np.stack(body.locate(body.to_body(points, rotation[:, None])), axis=-1)
