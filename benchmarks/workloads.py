"""Workloads: cases with many samples of errors, clearances and loads, at fixed seeds."""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import families
from loadshare.case import Case, load_case
from loadshare.errors import LoadshareError

Array = NDArray[np.float64]
Samples = Mapping[str, Array]

IDLERS, PINIONS = ("6", "7", "8", "9"), ("4", "5")
SIZES = (4, 8, 16, 32, 64)
"""Numbers of branches."""


@dataclass(frozen=True, slots=True, eq=False)
class Workload:
    """A case and its samples.

    Attributes
    ----------
    name, title : str
    kind : str
        "QP" or "SOCP"; "law" is added if a nonlinear law needs an outer loop.
    case : Case
        The case that the samples change.
    samples : mapping of str to ndarray, shape (count,)
        By key and unit, as `loadshare.solve_many` takes them.
    peers : int
        Number of samples, the first ones, that peers are given.
    limits : mapping of str to (float, float)
        Limits between which the samples of a key are drawn.
    """

    name: str
    title: str
    kind: str
    case: Case
    samples: Samples
    peers: int
    limits: Mapping[str, tuple[float, float]]

    @property
    def count(self) -> int:
        """Number of samples."""
        return len(next(iter(self.samples.values())))

    def cases(self, count: int) -> Iterator[Case]:
        """Yield the first samples as cases."""
        for k in range(count):
            changes = {}
            for key, values in self.samples.items():
                name, unit = _split(key)
                changes[name] = f"{float(values[k])!r} {unit}"
            yield self.case.replace(changes)

    def drawn(self, count: int) -> dict[str, Array]:
        """Return `count` samples with the same distribution."""
        return _drawn(self.name, self.limits, count)

    def some(self, count: int) -> dict[str, Array]:
        """Return the first samples as arrays."""
        return {key: values[:count] for key, values in self.samples.items()}


def _split(key: str) -> tuple[str, str]:
    match = re.fullmatch(r"(.*) \[(.*)\]", key)
    if match is None:
        raise ValueError(f"sample key {key!r} has no unit in brackets")
    return match[1], match[2]


def workloads(cases: Path, quick: bool) -> list[Workload]:
    """Return the workloads of the seed's transmission.

    Parameters
    ----------
    cases : pathlib.Path
        Folder of shipped cases.
    quick : bool
        Fewer samples.

    Raises
    ------
    LoadshareError
        If the folder does not contain the seed's cases.
    """
    folder = cases / "fgfbstts"
    if not folder.is_dir():
        raise LoadshareError(
            f"{cases}: contains no cases of the seed's transmission (fgfbstts). Allowed: the "
            "folder `cases` of the repository; run the command there, or name it with --cases"
        )
    few, many = (8, 4_000) if quick else (40, 20_000)
    study = 10_000 if quick else 100_000
    rings = _with_errors(load_case(folder / "limit_ring.toml"))
    splines = _with_errors(load_case(folder / "spline_clearance.toml"))
    everything = _with_errors(load_case(folder / "all_elements.toml"), march=None)
    law = everything.replace({"splines": None})
    return [
        _workload("rings", "limit rings", "QP", rings, _errors | _rings, many, few),
        _workload("splines", "clearance splines", "SOCP", splines, _errors | _splines, many, few),
        _workload("law", "limit rings, b + c law", "QP, law", law, _errors | _ring_5, many, few),
        _workload(
            "splines-law",
            "clearance splines, b + c law",
            "SOCP, law",
            _with_laws(splines),
            _errors | _splines,
            many,
            few,
        ),
        _workload(
            "all",
            "every element, b + c law",
            "SOCP, law",
            everything,
            _errors | _ring_5 | _fixed_spline,
            many,
            few,
        ),
        _workload(
            "study",
            f"tolerance study, {study:,} samples",
            "QP, law",
            law,
            _errors | _ring_5 | _ring_clearances,
            study,
            few,
        ),
    ]


def branches(quick: bool) -> list[Workload]:
    """Return trains of 4 to 64 branches: elastic pinions, backlash, b + c laws."""
    count, few = (100, 2) if quick else (20_000, 8)
    return [
        _workload(f"branches-{n}", f"{n} branches", "QP, law", *_branched(n, True), count, few)
        for n in SIZES
    ]


def linear_branches(quick: bool) -> Workload:
    """Return a train of eight branches with linear laws: one quadratic programme, no outer loop."""
    count, few = (100, 8) if quick else (20_000, 40)
    return _workload("linear-8", "8 branches, linear", "QP", *_branched(8, False), count, few)


def _branched(size: int, curved: bool) -> tuple[Case, dict[str, tuple[float, float]]]:
    data = families.split_torque(size).to_dict()
    del data["operating"]["power"], data["operating"]["speed"], data["assumed"]
    data["operating"]["torque"] = f"{543.8 * size} N*m"
    for number in range(1, size // 2 + 1):
        data["gears"][f"pinion{number}"]["support"] = "1e8 N/m"
    for mesh in data["meshes"].values():
        mesh["backlash"] = "30 um"
        if curved:
            mesh["law"] = _law(mesh.pop("stiffness"))
    idlers = [g for g in data["gears"] if g.startswith("idler")]
    data["errors"] = {
        g: {"installation": {"amount": "20 um", "direction": "0 deg"}} for g in idlers
    }
    draws: dict[str, Any] = {"operating.torque [N*m]": (163.0 * size, 652.0 * size)}
    for g in idlers:
        draws[f"errors.{g}.installation.amount [um]"] = (0.0, 40.0)
        draws[f"errors.{g}.installation.direction [deg]"] = (0.0, 360.0)
    return Case(data, name=f"branches-{size}"), draws


def _law(stiffness: str) -> dict[str, str]:
    """Return a law with 0.7 of bending and 0.3 of Hertz contact at a wind-up of 1 mrad."""
    k, unit = float(stiffness.split()[0]), "rad/(N*m)"
    hertz = 0.3 * (1e-3 * k) ** (1.0 / 3.0) / k
    return {"b": f"{0.7 / k!r} {unit}", "c": f"{hertz!r} {unit}^(2/3)"}


def _with_laws(case: Case) -> Case:
    """Give the meshes laws instead of stiffnesses."""
    changes: dict[str, Any] = {}
    for name, mesh in case.to_dict()["meshes"].items():
        changes[f"meshes.{name}.stiffness"] = None
        changes[f"meshes.{name}.law"] = _law(mesh["stiffness"])
    return case.replace(changes)


def _with_errors(case: Case, **more: Any) -> Case:
    """Give idlers and pinions errors whose size and direction samples can change."""
    changes: dict[str, Any] = {
        **more,
        "assumed": None,
        "operating.power": None,
        "operating.speed": None,
        "operating.torque": "2175.2 N*m",
        # A sample is one position; the direction of its eccentricities is drawn.
        "operating.rotation": "neglected",
        "errors": {
            g: {
                "installation": {"amount": "20 um", "direction": "0 deg"},
                "eccentricity": {"amount": "10 um", "direction": "0 deg"},
            }
            for g in (*PINIONS, *IDLERS)
        },
    }
    return case.replace(changes)


_errors: dict[str, tuple[float, float]] = {"operating.torque [N*m]": (650.0, 2600.0)} | {
    f"errors.{g}.{key}": limits
    for g in (*PINIONS, *IDLERS)
    for key, limits in (
        ("installation.amount [um]", (0.0, 60.0)),
        ("installation.direction [deg]", (0.0, 360.0)),
        ("eccentricity.amount [um]", (0.0, 30.0)),
        ("eccentricity.direction [deg]", (0.0, 360.0)),
    )
}
_rings = {f"rings.{g}.float [um]": (1.0, 20.0) for g in PINIONS}
_ring_5 = {"rings.5.float.up [um]": (1.0, 15.0), "rings.5.float.down [um]": (1.0, 15.0)}
_splines = {f"splines.{g}.clearance [um]": (2.0, 20.0) for g in PINIONS} | {
    f"splines.{g}.normal_force [N]": (100.0, 1000.0) for g in PINIONS
}
_fixed_spline = {"splines.4.clearance [um]": (10.0, 60.0)}
_ring_clearances = {"rings.5.clearance [um]": (0.0, 120.0)}


def _workload(
    name: str,
    title: str,
    kind: str,
    case: Case,
    draws: Mapping[str, tuple[float, float]],
    count: int,
    peers: int,
) -> Workload:
    return Workload(name, title, kind, case, _drawn(name, draws, count), min(peers, count), draws)


def _drawn(name: str, draws: Mapping[str, tuple[float, float]], count: int) -> dict[str, Array]:
    generator = np.random.default_rng(zlib.crc32(name.encode()))
    return {key: generator.uniform(*limits, count) for key, limits in draws.items()}
