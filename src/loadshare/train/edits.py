"""What keys that vary from sample to sample write into the arrays of a position."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare import case as spec
from loadshare.case.keys import Path
from loadshare.train.train import Train

Array = NDArray[np.float64]
Edit = tuple[tuple[int, ...], Array]
"""Where in an array, after the samples, new values stand; and the values, (S,) or (S, 3)."""


@dataclass(frozen=True, eq=False)
class Edits:
    """New values of S samples, field by field of `Situations`.

    Attributes
    ----------
    case : Case
        Gives whatever no key gives.
    train : Train
        Built from it.
    values : mapping of Path to ndarray, shape (S,)
        In SI, of the keys that vary.
    count : int
        S.
    """

    case: spec.Case
    train: Train
    values: Mapping[Path, Array]
    count: int

    def at(self, index: int) -> Iterator[tuple[str, list[Edit]]]:
        """Yield every field that a key writes into at position `index` (1-based)."""
        fields: dict[str, Callable[[int], Iterable[Edit]]] = {
            "offset": self._offset,
            "torque": self._torque,
            "gap": self._gap,
            "backlash": self._backlash,
            "bending": self._bending,
            "hertz": self._hertz,
            "clocking": lambda _: self._each("shafts", self.train.shafts, "clocking"),
            "torsion": lambda _: self._each("shafts", self.train.shafts, "stiffness"),
            "support": self._support,
            "arc_clearance": lambda _: self._sides("clearance", (0, 1)),
            "stop": lambda _: self._sides("float", ("up", "down")),
            "round_radius": lambda _: self._each(
                "rings", [r.gear for r in self.train.rounds], "radius"
            ),
            "spline": self._spline,
        }
        for field, edits in fields.items():
            found = list(edits(index))
            if found:
                yield field, found

    def _get(self, *path: str | int) -> Array | None:
        return self.values.get(path)

    def _or(self, path: Path, nominal: float) -> Array:
        found = self.values.get(path)
        return np.full(self.count, nominal) if found is None else found

    def _each(self, section: str, names: Iterable[str], key: str) -> Iterator[Edit]:
        for k, name in enumerate(names):
            values = self._get(section, name, key)
            if values is not None:
                yield (k,), values

    def _sides(self, key: str, sides: tuple[str | int, str | int]) -> Iterator[Edit]:
        """Two values of every drum, given for one side, or for both at once."""
        for d, ring in enumerate(self.train.drums):
            for side, name in enumerate(sides):
                values = self._get("rings", ring.gear, key, name)
                if values is None:
                    values = self._get("rings", ring.gear, key)
                if values is not None:
                    yield (d, side), values

    def _offset(self, index: int) -> Iterator[Edit]:
        turned = self.train.situation(index).rotation
        for g, (name, gear) in enumerate(self.train.gears.items()):
            if not any(p[:2] == ("errors", name) for p in self.values):
                continue
            fixed, turning = self._errors[name]
            if turning is not None:
                angle = gear.sense * turned[name]
                c, s = np.cos(angle), np.sin(angle)
                fixed = fixed + turning @ (np.array([[c, s], [-s, c]]) @ gear.frame)
            yield (g,), fixed

    @cached_property
    def _errors(self) -> dict[str, tuple[Array, Array | None]]:
        """Installation errors (S, 3) and eccentricities before gears turn (S, 2), by gear."""
        found = {}
        for name, gear in self.train.gears.items():
            given = self.case.errors.get(name)
            if given is None:
                continue
            fixed = np.broadcast_to(self.train.offsets[name].installation, (self.count, 3)).copy()
            if isinstance(given.installation, spec.Offset):
                key = ("errors", name, "installation")
                amount = self._or((*key, "amount"), given.installation.amount.si)
                angle = self._or((*key, "direction"), given.installation.direction.si)
                fixed = _polar(amount, angle) @ gear.frame
            for axis in range(3):
                component = self._get("errors", name, "installation", axis)
                if component is not None:
                    fixed[:, axis] = component
            turning = None
            if given.eccentricity is not None:
                key = ("errors", name, "eccentricity")
                amount = self._or((*key, "amount"), given.eccentricity.amount.si)
                angle = self._or((*key, "direction"), given.eccentricity.direction.si)
                angle = angle + self._or((*key, "phase"), given.eccentricity.phase.si)
                turning = _polar(amount, angle)
            found[name] = fixed, turning
        return found

    def _torque(self, index: int) -> Iterator[Edit]:
        driving = self._get("operating", "torque")
        power, speed = self._get("operating", "power"), self.case.operating.speed
        if power is not None and speed is not None:
            driving = power / speed.si
        for g, name in enumerate(self.train.gears):
            key = ("operating", "external", name)
            external = self._get(*key)
            if name == self.train.input and (driving is not None or external is not None):
                if driving is None:
                    step = (index - 1) % len(self.train.input_torque)
                    driving = np.full(self.count, self.train.input_torque[step])
                yield (g,), driving + self._or(key, self.train.external.get(name, 0.0))
            elif external is not None:
                yield (g,), external

    def _meshes(self, *tail: str) -> Iterator[tuple[int, str, float, Array]]:
        """Number, name and radius of the law of the meshes that give a key, and its values."""
        for m, (name, mesh) in enumerate(self.train.meshes.items()):
            values = self._get("meshes", name, *tail)
            if values is not None:
                yield m, name, mesh.told_radius, values

    def _gap(self, _: int) -> Iterator[Edit]:
        for tail in (("gap",), ("law", "a")):
            for m, _name, radius, values in self._meshes(*tail):
                yield (m,), radius * values

    def _backlash(self, _: int) -> Iterator[Edit]:
        for m, _name, _radius, values in self._meshes("normal_backlash"):
            yield (m,), values
        for m, name, _radius, values in self._meshes("backlash"):
            mesh = self.case.meshes[name]
            slope = np.cos(mesh.pressure_angle.si) * np.cos(mesh.helix_angle.si)
            yield (m,), values * slope

    def _bending(self, _: int) -> Iterator[Edit]:
        for m, _name, radius, values in self._meshes("stiffness"):
            yield (m,), radius**2 / values
        for m, _name, radius, values in self._meshes("law", "b"):
            yield (m,), values * radius**2

    def _hertz(self, _: int) -> Iterator[Edit]:
        for m, _name, radius, values in self._meshes("law", "c"):
            yield (m,), values * radius ** (5.0 / 3.0)

    def _support(self, _: int) -> Iterator[Edit]:
        for (k,), values in self._each("gears", self.train.gears, "support"):
            yield (k, 0), values
            yield (k, 1), values

    def _spline(self, _: int) -> Iterator[Edit]:
        for k, (name, spline) in enumerate(self.train.splines.items()):
            given = self.case.splines[name]
            for place, key in enumerate(("bending_stiffness", "stick_limit", "clearance")):
                values = self._get("splines", name, key)
                if values is not None:
                    yield (k, place), values
            bound = self._get("splines", name, "friction_force")
            friction = self._get("splines", name, "friction")
            normal = self._get("splines", name, "normal_force")
            if bound is not None:
                yield (k, 3), bound
            elif friction is not None or normal is not None:
                share = self._or(("splines", name, "friction"), given.friction or 0.0)
                if given.normal_force is not None:
                    press = self._or(("splines", name, "normal_force"), given.normal_force.si)
                    yield (k, 3), share * press
                elif given.radius is not None and spline.friction_force is None:
                    yield (k, 4), share / given.radius.si


def _polar(amount: Array, angle: Array) -> Array:
    return np.stack([amount * np.cos(angle), amount * np.sin(angle)], axis=1)
