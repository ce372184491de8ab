"""Places of gears, meshes and shafts in a drawing, even for a case that is not valid yet."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from loadshare.case import Gear
from loadshare.case.checks.fit import TOLERANCE
from loadshare.case.content import Sections
from loadshare.case.line_of_action import line_of_action
from loadshare.case.place import axis_of
from loadshare.report.flanks import Flank
from loadshare.report.palette import Palette
from loadshare.train import Train
from loadshare.train.gear import Vector, transverse_frame
from loadshare.train.ring import transverse

FLOATS, ELASTIC, FIXED = "floats", "on an elastic bearing", "on a rigid bearing"
FLAT = 1e-9
"""Heights that differ by less than this part of the train are one height."""
OUTSIDE = 1.07
"""Radius of an internal gear's bent arrow over its largest radius: the pinions are inside it."""


@dataclass(frozen=True, slots=True, eq=False)
class DrawnGear:
    """A gear as it is drawn.

    Attributes
    ----------
    name, kind : str
    centre, axis : ndarray, shape (3,)
        [m]; unit vector.
    base_radius : float
        Acting radius of a face gear [m].
    rims : tuple of float
        Inner and outer radius of a face gear's teeth [m], if given.
    sense : int
        +1 counter-clockwise against the axis, −1 clockwise, 0 if it does not turn or this is not
        known.
    held : str
        What holds the centre.
    role : str
        "input", "output", "held" or empty.
    """

    name: str
    kind: str
    centre: Vector
    axis: Vector
    base_radius: float
    rims: tuple[float, ...]
    sense: int
    held: str
    role: str

    def is_round(self, frame: Vector) -> bool:
        """Return whether a view shows it as a circle, not from the side."""
        return abs(float(np.cross(frame[0], frame[1]) @ self.axis)) > 1.0 - 1e-6

    def circle(self, radius: float, start: float = 0.0, turn: float = 2.0 * math.pi) -> Vector:
        """Return points (n, 3) [m] on a circle about the axis, over `turn` from `start` [rad]."""
        angles = np.linspace(start, start + turn, 73)
        directions = np.column_stack((np.cos(angles), np.sin(angles)))
        return np.asarray(self.centre + radius * directions @ transverse_frame(self.axis))


@dataclass(frozen=True, slots=True, eq=False)
class DrawnMesh:
    """A mesh as it is drawn.

    Attributes
    ----------
    name, driver, driven : str
    angle : float
        Pressure angle [rad].
    pitch_radii : tuple of float
        Working pitch radii r_b/cos α of driver and driven gear, of a face gear its acting radius
        [m].
    pitch_point : ndarray, shape (3,)
        [m].
    pushes : tuple of ndarray, shape (3,)
        Directions in which flanks push the driven gear.
    distance, needed : float
        Distance of the centres across the axes, or height of a pinion over its face gear, as it is
        and as the radii require it [m].
    """

    name: str
    driver: str
    driven: str
    angle: float
    pitch_radii: tuple[float, float]
    pitch_point: Vector
    pushes: tuple[Vector, ...]
    distance: float
    needed: float

    @property
    def radii(self) -> dict[str, float]:
        """Pitch radii by gear [m], the driver's first."""
        return dict(zip((self.driver, self.driven), self.pitch_radii, strict=True))

    @property
    def fits(self) -> bool:
        """Whether the gears are where their radii require, by the rule that checks a case."""
        return abs(self.distance - self.needed) * math.cos(self.angle) <= TOLERANCE * self.distance


@dataclass(frozen=True, slots=True, eq=False)
class DrawnTrain:
    """All that a drawing shows.

    Attributes
    ----------
    bodies : mapping of gear to DrawnGear
    pairs : tuple of DrawnMesh
    shafts : tuple of (str, str)
        Gears that a shaft joins.
    """

    bodies: Mapping[str, DrawnGear]
    pairs: tuple[DrawnMesh, ...]
    shafts: tuple[tuple[str, str], ...]

    @property
    def common_axis(self) -> Vector:
        """Axis along which most gears turn, pointing the way the first of them does."""
        bodies = list(self.bodies.values())

        def alike(body: DrawnGear) -> int:
            return sum(abs(float(body.axis @ other.axis)) > 1.0 - 1e-6 for other in bodies)

        return max(bodies, key=alike).axis

    @property
    def palette(self) -> Palette:
        """Looks of the gears, as in all pictures of the case."""
        return Palette(self.bodies, {p.name: (p.driver, p.driven) for p in self.pairs})

    @property
    def frames(self) -> list[Vector]:
        """Directions to the right and upwards in every view.

        The first view is along the common axis. If heights differ, a second one from the side has
        that axis upwards, and the same direction to the right.
        """
        axis = self.common_axis
        frame = transverse_frame(axis)
        return [frame, np.array([frame[0], axis])] if self._heights_differ(axis) else [frame]

    @property
    def large_first(self) -> list[DrawnGear]:
        """The gears, large ones first, so that small ones lie on top."""
        return sorted(self.bodies.values(), key=lambda body: -self.reach(body))

    def _heights_differ(self, axis: Vector) -> bool:
        """Return whether a view from the side shows more."""
        heights = [float(body.centre @ axis) for body in self.bodies.values()]
        size = max(body.base_radius for body in self.bodies.values())
        crossed = any(abs(float(b.axis @ axis)) < 1.0 - 1e-6 for b in self.bodies.values())
        return crossed or max(heights) - min(heights) > FLAT * size

    def reach(self, body: DrawnGear) -> float:
        """Return the largest radius that is drawn of a gear [m]."""
        pitch = [p.radii[body.name] for p in self.pairs if body.name in p.radii]
        largest = max([body.base_radius, *body.rims, *pitch])
        return OUTSIDE * largest if body.kind == "internal" else largest

    def radii(self, body: DrawnGear) -> tuple[dict[str, float], dict[str, float]]:
        """Return the radii [m] of a gear's full and dashed circles, by description."""
        if body.kind == "face":
            rims = dict(zip(("inner", "outer"), body.rims, strict=False))
            acting = {"acting radius": body.base_radius}
            return (rims, acting) if rims else (acting, {})
        if body.kind == "carrier":
            return {}, {"pin circle": body.base_radius}
        found: dict[str, float] = {}
        for radii in (p.radii for p in self.pairs if body.name in p.radii):
            radius = radii.pop(body.name)
            if not any(math.isclose(radius, known, rel_tol=1e-6) for known in found.values()):
                found[f"pitch circle with {next(iter(radii))}"] = radius
        return found, {"base circle": body.base_radius}


def layout_of(
    case: Sections, train: Train | None, flanks: Iterable[Flank] | None = None
) -> DrawnTrain:
    """Arrange a case for a drawing.

    Parameters
    ----------
    case : Case or Draft
        A draft leaves out what could not be read.
    train : Train or None
        Train of the case, for running senses and directions of push; None if there is none yet.
    flanks : iterable of Flank, optional
        The loaded flanks; by default the drive flanks.
    """
    centres = case.centres()
    # In the order of the train, by which all pictures colour their gears.
    order = [*(train.gears if train else ()), *case.gears]
    bodies = {
        name: _body(case, name, case.gears[name], np.array(centres[name]), train)
        for name in dict.fromkeys(order)
        if name in centres
    }
    shafts = tuple(s.ends for s in case.shafts.values() if set(s.ends) <= set(bodies))
    pushes: dict[str, list[Vector]] = {}
    if train:
        wanted = [(name, True) for name in train.meshes] if flanks is None else flanks
        for name, drive, *_ in wanted:
            mesh = train.meshes[name]
            normal = mesh.drive_normal if drive else mesh.coast_normal
            pushes.setdefault(name, []).append(normal)
    return DrawnTrain(bodies, tuple(_pairs(case, bodies, centres, pushes)), shafts)


def _body(case: Sections, name: str, gear: Gear, centre: Vector, train: Train | None) -> DrawnGear:
    roles = (
        {case.operating.input: "input", case.operating.output: "output"} if case.operating else {}
    )
    rims = tuple(q.si for q in (gear.inner_radius, gear.outer_radius) if q is not None)
    support = gear.support
    if support == "free" or (support is None and case.floats(name)):
        held = FLOATS
    else:
        held = FIXED if support in (None, "rigid") else ELASTIC
    return DrawnGear(
        name=name,
        kind=gear.type,
        centre=centre,
        axis=np.array(axis_of(gear)),
        base_radius=_radius(case, name, gear, centre),
        rims=rims,
        sense=train.gears[name].running if train else 0,
        held=held,
        role="held" if gear.held else roles.get(name, ""),
    )


def _radius(case: Sections, name: str, gear: Gear, centre: Vector) -> float:
    """Return the acting radius; of a carrier that of its outermost pin, or of the median gear."""
    if not gear.is_carrier:
        return gear.acting_radius
    centres, axis = case.centres(), np.array(axis_of(gear))
    pins = [
        float(np.linalg.norm(transverse(np.array(centres[n]) - centre, axis)))
        for n, g in case.gears.items()
        if g.carrier == name and n in centres
    ]
    others = sorted(g.acting_radius for g in case.gears.values() if not g.is_carrier)
    return max(pins, default=others[len(others) // 2] if others else 1.0)


def _pairs(
    case: Sections,
    bodies: Mapping[str, DrawnGear],
    centres: Mapping[str, tuple[float, float, float]],
    pushes: Mapping[str, Sequence[Vector]],
) -> Iterator[DrawnMesh]:
    for name, mesh in case.meshes.items():
        if mesh.driver not in bodies or mesh.driven not in bodies or mesh.driver == mesh.driven:
            continue
        line = line_of_action(mesh, case.gears, centres)
        if line is None:
            continue
        driver, driven = bodies[mesh.driver], bodies[mesh.driven]
        place = _face_place if "face" in (driver.kind, driven.kind) else _parallel_place
        radii, point, distance, needed = place(driver, driven, line.pressure_angle)
        yield DrawnMesh(
            name=name,
            driver=driver.name,
            driven=driven.name,
            angle=line.pressure_angle,
            pitch_radii=radii,
            pitch_point=point,
            pushes=tuple(pushes.get(name, ())),
            distance=distance,
            needed=needed,
        )


Place = tuple[tuple[float, float], Vector, float, float]


def _parallel_place(driver: DrawnGear, driven: DrawnGear, angle: float) -> Place:
    """Return pitch radii, pitch point, distance of the centres across the axis, and that needed."""
    radii = driver.base_radius / math.cos(angle), driven.base_radius / math.cos(angle)
    between = driven.centre - driver.centre
    between = between - (between @ driver.axis) * driver.axis
    distance = float(np.linalg.norm(between))
    towards = between / distance if distance > 0.0 else np.zeros(3)
    if driven.kind == "internal":
        point, needed = driver.centre - radii[0] * towards, radii[1] - radii[0]
    elif driver.kind == "internal":
        point, needed = driven.centre + radii[1] * towards, radii[0] - radii[1]
    else:
        point, needed = driver.centre + radii[0] * towards, radii[0] + radii[1]
    return radii, point, distance, needed


def _face_place(driver: DrawnGear, driven: DrawnGear, angle: float) -> Place:
    """Return the same of a face gear: its acting radius, and the height of the pinion over it."""
    face, pinion = (driver, driven) if driver.kind == "face" else (driven, driver)
    pitch = pinion.base_radius / math.cos(angle)
    towards = pinion.centre - face.centre
    arm = math.copysign(1.0, towards @ pinion.axis) * pinion.axis
    radii = (face.base_radius, pitch) if driver is face else (pitch, face.base_radius)
    return (
        radii,
        face.centre + face.base_radius * arm,
        abs(float(towards @ face.axis)),
        pitch,
    )
