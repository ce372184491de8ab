"""Samples of a case: inputs that change from sample to sample, as situations of one train.

A key that only moves right-hand sides, bounds or compliances (errors, loads, clearances, gaps,
stiffnesses of what is elastic anyway) becomes an array. Any other key changes the machine itself;
samples are then grouped by its values, and every group is a train of its own.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from loadshare import case as spec
from loadshare.case.keys import Path, dotted, parse
from loadshare.case.units import si_factor
from loadshare.errors import CaseError, Problem
from loadshare.train.build import build_train
from loadshare.train.ring import DrumRing, RoundRing
from loadshare.train.situations import Situations, arcs_from, situation_of
from loadshare.train.train import Train

Array = NDArray[np.float64]
Edit = tuple[tuple[int, ...], Array]
"""Where in an array, after the samples, new values stand; and the values."""

_UNIT = re.compile(r"(?P<key>.*\S)\s+\[(?P<unit>[^\]]*)\]")


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """Values of one key.

    Attributes
    ----------
    path : tuple of str or int
        The key.
    unit : str
        Of the values; empty for a bare number.
    values : ndarray, shape (S,)
        Numbers, or texts for a key that takes words.
    """

    path: Path
    unit: str
    values: NDArray[np.generic]

    def text(self, sample: int) -> str | float:
        """Value of a sample as a case file has it."""
        value = self.values[sample].item()
        return f"{value!r} {self.unit}" if self.unit else value


def columns_of(samples: Mapping[str, ArrayLike]) -> list[Column]:
    """Read a table of samples.

    Parameters
    ----------
    samples : mapping of str to array_like
        Values by key path, all of one length. The unit stands in brackets after the key, as in
        ``"rings.4.float [um]"``; texts with their units, as in a case file, may stand instead.

    Raises
    ------
    CaseError
        If lengths differ or a key is no key path; all problems are listed.
    """
    columns: list[Column] = []
    problems = []
    count = None
    for key, given in samples.items():
        match = _UNIT.fullmatch(key)
        text, unit = (match["key"], match["unit"]) if match else (key, "")
        values = np.atleast_1d(np.asarray(given))
        try:
            path = parse(text)
        except ValueError:
            problems.append(Problem("samples", key, "", "is not a key path"))
            continue
        if values.ndim != 1 or not len(values):
            problems.append(Problem("samples", key, "", "is not a list of values"))
        elif count is not None and len(values) != count:
            message = f"has {len(values)} values, the keys before it have {count}"
            problems.append(Problem("samples", key, "", message))
        elif unit and values.dtype.kind not in "fiu":
            problems.append(Problem("samples", key, "", "has a unit, but its values are texts"))
        elif values.dtype.kind in "fiu" and not np.isfinite(values.astype(float)).all():
            problems.append(Problem("samples", key, "", "holds a value that is not finite"))
        else:
            count = len(values)
            columns.append(Column(path, unit, values))
    if not samples:
        problems.append(Problem("samples", "", "", "there is no key", "at least one key"))
    if problems:
        raise CaseError(problems)
    return columns


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples that share a machine.

    Attributes
    ----------
    case : Case
        The case with the first sample's values; gives whatever no column gives.
    train : Train
        Built from it.
    columns : tuple of Column
        All of them, of S values each.
    values : mapping of Path to ndarray, shape (S,)
        In SI, of the keys that become arrays.
    """

    case: spec.Case
    train: Train
    columns: tuple[Column, ...]
    values: Mapping[Path, Array]

    @property
    def count(self) -> int:
        """S."""
        return len(self.columns[0].values)

    def one(self, sample: int) -> spec.Case:
        """Return a sample as a case."""
        return self.case.replace({dotted(c.path): c.text(sample) for c in self.columns})

    def take(self, rows: slice) -> Samples:
        """Return some of the samples."""
        columns = tuple(replace(c, values=c.values[rows]) for c in self.columns)
        return replace(self, columns=columns, values={p: v[rows] for p, v in self.values.items()})

    def situations(self, index: int) -> Situations:
        """Return the situations at position `index` (1-based) of all samples."""
        base = situation_of(self.train, index)
        arrays: dict[str, Array] = {}
        changes: tuple[tuple[str, Callable[[int], Iterator[Edit]]], ...] = (
            ("offset", self._offset),
            ("torque", self._torque),
            ("gap", self._gap),
            ("backlash", self._backlash),
            ("bending", self._bending),
            ("hertz", self._hertz),
            ("clocking", self._clocking),
            ("torsion", self._torsion),
            ("support", self._support),
            ("arc_clearance", self._clearance),
            ("stop", self._stop),
            ("round_radius", self._radius),
            ("spline", self._spline),
        )
        for field, change in changes:
            nominal: Array = getattr(base, field)
            edits = list(change(index))
            if edits:
                table = np.repeat(nominal, self.count, axis=0)
                for where, values in edits:
                    table[(slice(None), *where)] = values  # type: ignore[index]
                arrays[field] = table
        if "offset" in arrays:
            arrays["arc_shift"] = arcs_from(self.train, arrays["offset"])
        return replace(base, count=self.count, **arrays)  # type: ignore[arg-type]

    def _get(self, *path: str | int) -> Array | None:
        return self.values.get(path)

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

    def _or(self, path: Path, nominal: float) -> Array:
        found = self.values.get(path)
        return np.full(self.count, nominal) if found is None else found

    def _torque(self, index: int) -> Iterator[Edit]:
        driving = self._get("operating", "torque")
        power, speed = self._get("operating", "power"), self.case.operating.speed
        if power is not None and speed is not None:
            driving = power / speed.si
        for g, name in enumerate(self.train.gears):
            external = self._get("operating", "external", name)
            if name == self.train.input and (driving is not None or external is not None):
                if driving is None:
                    step = (index - 1) % len(self.train.input_torque)
                    driving = np.full(self.count, self.train.input_torque[step])
                yield (
                    (g,),
                    driving
                    + self._or(("operating", "external", name), self.train.external.get(name, 0.0)),
                )
            elif external is not None:
                yield (g,), external

    def _meshes(self, *tail: str) -> Iterator[tuple[int, str, float, Array]]:
        for m, (name, mesh) in enumerate(self.train.meshes.items()):
            values = self._get("meshes", name, *tail)
            if values is not None:
                yield m, name, mesh.radii[0], values

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

    def _clocking(self, _: int) -> Iterator[Edit]:
        yield from self._each("shafts", self.train.shafts, "clocking")

    def _torsion(self, _: int) -> Iterator[Edit]:
        yield from self._each("shafts", self.train.shafts, "stiffness")

    def _each(
        self, section: str, names: Mapping[str, object] | Sequence[str], key: str
    ) -> Iterator[Edit]:
        for k, name in enumerate(names):
            values = self._get(section, name, key)
            if values is not None:
                yield (k,), values

    def _support(self, _: int) -> Iterator[Edit]:
        for (k,), values in self._each("gears", self.train.gears, "support"):
            yield (k, 0), values
            yield (k, 1), values

    def _clearance(self, _: int) -> Iterator[Edit]:
        for d, name in enumerate(_rings(self.train, DrumRing)):
            both = self._get("rings", name, "clearance")
            for side in (0, 1):
                one = self._get("rings", name, "clearance", side)
                if one is not None or both is not None:
                    yield (d, side), both if one is None else one  # type: ignore[misc]

    def _stop(self, _: int) -> Iterator[Edit]:
        for d, name in enumerate(_rings(self.train, DrumRing)):
            both = self._get("rings", name, "float")
            for side, key in enumerate(("up", "down")):
                one = self._get("rings", name, "float", key)
                if one is not None or both is not None:
                    yield (d, side), both if one is None else one  # type: ignore[misc]

    def _radius(self, _: int) -> Iterator[Edit]:
        yield from self._each("rings", _rings(self.train, RoundRing), "radius")

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


def _rings(train: Train, kind: type) -> list[str]:
    return [n for n, r in train.rings.items() if isinstance(r, kind)]


def _polar(amount: Array, angle: Array) -> Array:
    return np.stack([amount * np.cos(angle), amount * np.sin(angle)], axis=1)


def samples_of(
    case: spec.Case, samples: Mapping[str, ArrayLike]
) -> list[tuple[NDArray[np.intp], Samples]]:
    """Turn a table of samples into groups that share a machine.

    Parameters
    ----------
    case : Case
    samples : mapping of str to array_like
        See `columns_of`.

    Returns
    -------
    list of (ndarray of int, Samples)
        Numbers of the samples of a group, and the group.

    Raises
    ------
    CaseError
        If a key or a value cannot be used; the smallest and the largest value of every key are
        checked like any other input.
    """
    columns = columns_of(samples)
    first = case.replace({dotted(c.path): c.text(0) for c in columns})
    units = {c.path: u for c in columns if (u := _array_unit(first, c)) is not None}
    arrays = {c.path: _si(c, units[c.path]) for c in columns if c.path in units}
    _check(case, columns, arrays)
    others = [c for c in columns if c.path not in arrays]
    groups = []
    for rows in _groups(others, len(columns[0].values)):
        mine = tuple(replace(c, values=c.values[rows]) for c in columns)
        base = first.replace({dotted(c.path): c.text(0) for c in mine})
        values = {path: si[rows] for path, si in arrays.items()}
        groups.append((rows, Samples(base, build_train(base), mine, values)))
    return groups


def _check(case: spec.Case, columns: Sequence[Column], arrays: Mapping[Path, Array]) -> None:
    """Let the case file's own checks judge the extreme values of every key.

    Other keys are judged with the groups that they make.
    """
    for pick in (np.argmin, np.argmax):
        rows = {c.path: int(pick(arrays[c.path])) if c.path in arrays else 0 for c in columns}
        case.replace({dotted(c.path): c.text(rows[c.path]) for c in columns})


def _groups(columns: Sequence[Column], count: int) -> list[NDArray[np.intp]]:
    """Rows with the same values in all of these columns."""
    if not columns:
        return [np.arange(count)]
    codes = np.stack([np.unique(c.values, return_inverse=True)[1] for c in columns], axis=1)
    _, which = np.unique(codes, axis=0, return_inverse=True)
    which = which.reshape(-1)
    order = np.argsort(which, kind="stable")
    return np.split(order, np.cumsum(np.bincount(which))[:-1])


def _si(column: Column, unit: str) -> Array:
    """Values in SI."""
    if column.values.dtype.kind in "fiu":
        factor = si_factor(column.unit, unit) if unit else 1.0
        assert factor is not None
        return column.values.astype(np.float64) * factor
    from pydantic_core import PydanticCustomError

    from loadshare.case.quantity import Dimension

    reader = Dimension(unit, "a value", f"1 {unit}")
    try:
        return np.array([float(reader.read(str(v))) for v in column.values])
    except PydanticCustomError as error:
        told = (error.context or {}).get("said", str(error))
        problem = Problem("samples", dotted(column.path), "", f"holds a value that {told}")
        raise CaseError([problem]) from error


def _array_unit(case: spec.Case, column: Column) -> str | None:
    """SI unit of a key that becomes an array; None if it changes the machine."""
    match column.path:
        case ("operating", "torque") | ("operating", "external", _):
            return "N*m"
        case ("operating", "power"):
            return "W"
        case ("errors", gear, "installation", "amount" | "direction" as what):
            polar = isinstance(case.errors[str(gear)].installation, spec.Offset)
            return (_LENGTH if what == "amount" else "rad") if polar else None
        case ("errors", _, "installation", int()):
            return _LENGTH
        case ("errors", _, "eccentricity", "amount"):
            return _LENGTH
        case ("errors", _, "eccentricity", "direction" | "phase"):
            return "rad"
        case ("rings", gear, "float") | ("rings", gear, "float", "up" | "down"):
            derived = isinstance(case.rings[str(gear)].float_, spec.Backlashes)
            return None if derived else _LENGTH
        case ("rings", _, "clearance") | ("rings", _, "clearance", int()) | ("rings", _, "radius"):
            return _LENGTH
        case ("splines", _, key):
            return _SPLINE.get(str(key))
        case ("meshes", mesh, *tail):
            return _mesh_unit(case, str(mesh), tuple(map(str, tail)), column)
        case ("shafts", shaft, "stiffness"):
            words = isinstance(case.shafts[str(shaft)].stiffness, str)
            return None if words or column.values.dtype.kind not in "fiu" else "N*m/rad"
        case ("shafts", shaft, "clocking"):
            return None if isinstance(case.shafts[str(shaft)].stiffness, str) else "rad"
        case ("gears", gear, "support"):
            words = isinstance(case.gears[str(gear)].support, str)
            numbers = column.values.dtype.kind in "fiu"
            return "N/m" if numbers and not words and (column.values > 0).all() else None  # type: ignore[operator]
    return None


_LENGTH = "m"
_SPLINE = {
    "bending_stiffness": "N/m",
    "stick_limit": _LENGTH,
    "clearance": _LENGTH,
    "friction_force": "N",
    "friction": "",
    "normal_force": "N",
}
_MESH = {
    ("stiffness",): "N*m/rad",
    ("gap",): "rad",
    ("law", "a"): "rad",
    ("law", "b"): "rad/(N*m)",
    ("law", "c"): "rad/(N*m)^(2/3)",
    ("backlash",): _LENGTH,
    ("normal_backlash",): _LENGTH,
}


def _mesh_unit(case: spec.Case, mesh: str, tail: tuple[str, ...], column: Column) -> str | None:
    """Unit of a mesh's key; None where it decides which elements there are."""
    unit = _MESH.get(tail)
    if tail[0] in ("backlash", "normal_backlash"):
        derived = any(isinstance(r.float_, spec.Backlashes) for r in case.rings.values())
        return None if derived else unit
    if tail == ("law", "c") and column.values.dtype.kind in "fiu":
        # Without a Hertz part the law is linear: a set of its own.
        return unit if (column.values > 0).all() else None  # type: ignore[operator]
    if tail == ("law", "a") and case.meshes[mesh].gap is not None:
        return None
    return unit
