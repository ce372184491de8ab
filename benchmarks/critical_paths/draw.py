"""Random paths: a train along one to three inputs that take the same value."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

import loadshare as ls
from benchmarks.stress.dressing import any_structure, held, spread
from benchmarks.stress.workbench import BENDING, DEFLECTION, Workbench, written
from loadshare.errors import CaseError


@dataclass(frozen=True, slots=True)
class Path:
    """A case along one to three inputs.

    Attributes
    ----------
    number : int
    case : Case
    keys : tuple of str
    unit : str
    start, stop, other : float
        Ends of the path, and another upper end.
    machines : bool
        Whether every value needs a machine of its own.
    """

    number: int
    case: ls.Case
    keys: tuple[str, ...]
    unit: str
    start: float
    stop: float
    other: float
    machines: bool = False


def random_path(number: int) -> Path:
    """Return path `number`; the same one every time."""
    generator = np.random.default_rng([20261121, number])
    for _ in range(100):
        try:
            return _drawn(number, generator)
        except CaseError:
            continue
    raise RuntimeError(f"path {number}: no case could be drawn")


def _drawn(number: int, rng: np.random.Generator) -> Path:
    bench = any_structure(rng, "free" if rng.random() < 0.5 else "elastic")
    if bench.data["gears"].get("sun", {}).get("support") == "elastic":
        bench.support("sun", 1e7 * spread(rng, 1.0))
    play = DEFLECTION * rng.choice([0.3, 1.0, 3.0])
    held(bench, rng, play)
    _dressed(bench, rng)
    kinds = list(_kinds(bench, rng))
    keys, unit, low, high, machines = kinds[int(rng.integers(len(kinds)))]
    count = min(int(rng.integers(1, 4)), len(keys))
    chosen = tuple(sorted(rng.choice(list(keys), size=count, replace=False).tolist()))
    stop = high * spread(rng, 0.25)
    start = low if rng.random() < 0.7 else low + 0.2 * rng.random() * (stop - low)
    other = start + (stop - start) * rng.uniform(0.3, 0.95)
    case = bench.case(f"path {number}")
    for value in (start, stop):
        case.replace(dict.fromkeys(chosen, text(value, unit)))
    return Path(number, case, chosen, unit, float(start), float(stop), float(other), machines)


def text(value: float, unit: str) -> str | float:
    """Return a value of a path as it is written in a case."""
    return f"{float(value)!r} {unit}" if unit else float(value)


def _dressed(bench: Workbench, rng: np.random.Generator) -> None:
    """Give a train random loads, errors, laws, backlashes, gaps and shafts."""
    bench.torque(bench.rated * 10.0 ** rng.uniform(-1.3, 0.3))
    bench.random_errors(DEFLECTION * 10.0 ** rng.uniform(-0.7, 0.7), rng)
    if rng.random() < 0.6:
        bench.backlash(DEFLECTION * 10.0 ** rng.uniform(-0.7, 0.7))
    if rng.random() < 0.5:
        bench.hertz(float(rng.uniform(0.1, 0.6)))
    elif rng.random() < 0.3:
        for mesh in bench.meshes:
            _tabulated(bench, mesh, rng)
    for mesh in bench.meshes:
        if rng.random() < 0.2:
            bench.gap(mesh, float(rng.normal(0.0, 1e-4)))
    if rng.random() < 0.5:
        bench.shafts(lambda _: 5e5 * spread(rng, 0.7))
    for gear, spline in bench.data.get("splines", {}).items():
        if rng.random() < 0.3:
            clearance = float(spline["clearance"].split()[0])
            bench.spline_by_torque(gear, BENDING, clearance, rng.uniform(0.001, 0.05), 0.03)
        elif rng.random() < 0.2:
            friction = float(spline["friction_force"].split()[0])
            spline["stick_limit"] = written(friction / BENDING * rng.uniform(0.2, 0.9), "m")


def _tabulated(bench: Workbench, mesh: str, rng: np.random.Generator) -> None:
    """Give a mesh a tabulated law that stiffens or softens with the load."""
    stiffness = float(bench.data["meshes"][mesh].pop("stiffness").split()[0])
    torques = bench.rated * np.array([0.1, 0.3, 0.7, 1.5])
    yields = np.cumsum(np.diff(np.append(0.0, torques)) / stiffness * rng.uniform(0.6, 1.8, 4))
    bench.data["meshes"][mesh]["table"] = {
        "torque": [written(t, "N*m") for t in torques],
        "deflection": [written(y, "rad") for y in yields],
    }


Kind = tuple[Sequence[str], str, float, float, bool]


def _kinds(bench: Workbench, rng: np.random.Generator) -> Iterable[Kind]:
    """Yield inputs of the case: keys, unit, ends, and whether they change the machine."""
    data = bench.data
    errors = [f"errors.{g}.installation.amount" for g in data.get("errors", {})]
    yield errors, "um", 0.0, 1e6 * DEFLECTION * 10.0 ** rng.uniform(0.0, 1.2), False
    yield [e.replace("amount", "direction") for e in errors], "deg", 0.0, 360.0, False
    yield ["operating.torque"], "N*m", 0.01 * bench.rated, 3.0 * bench.rated, False
    meshes = data["meshes"]
    yield [f'meshes."{m}".gap' for m in meshes], "urad", 0.0, 1000.0, False
    slack = [f'meshes."{m}".normal_backlash' for m in meshes if "normal_backlash" in meshes[m]]
    if slack:
        yield slack, "um", 0.0, 3e6 * DEFLECTION, False
    stiff = [m for m in meshes if "stiffness" in meshes[m]]
    if stiff:
        yield [f'meshes."{m}".stiffness' for m in stiff], "N*m/rad", 2e5, 2e7, False
    laws = [m for m in meshes if "law" in meshes[m]]
    if laws:
        for part, unit, top in (("b", "rad/(N*m)", 1e-6), ("c", "rad/(N*m)^(2/3)", 1e-5)):
            yield [f'meshes."{m}".law.{part}' for m in laws], unit, 0.01 * top, top, False
    shafts = [s for s, shaft in data.get("shafts", {}).items() if shaft["stiffness"] != "rigid"]
    if shafts:
        yield [f'shafts."{s}".stiffness' for s in shafts], "N*m/rad", 5e4, 5e6, False
        yield [f'shafts."{s}".clocking' for s in shafts], "urad", 0.0, 2000.0, False
    for _ in range(2):
        yield from _limits(data)
    if rng.random() < 0.3:
        yield [f'meshes."{m}".pressure_angle' for m in meshes], "deg", 15.0, 24.0, True


def _limits(data: dict[str, dict[str, dict[str, object]]]) -> Iterable[Kind]:
    """Yield the inputs of splines and rings."""
    splines, rings = data.get("splines", {}), data.get("rings", {})
    if splines:
        yield [f"splines.{g}.clearance" for g in splines], "um", 0.0, 3e6 * DEFLECTION, False
        yield [f"splines.{g}.bending_stiffness" for g in splines], "N/m", 2e6, 2e8, False
        fixed = [g for g in splines if "friction_force" in splines[g]]
        if fixed:
            yield [f"splines.{g}.friction_force" for g in fixed], "N", 0.0, 1500.0, False
    drums = [g for g in rings if "float" in rings[g]]
    if drums:
        yield (
            [f"rings.{g}.float.{s}" for g in drums for s in ("up", "down")],
            "um",
            0.0,
            60.0,
            False,
        )
        yield [f"rings.{g}.clearance" for g in drums], "um", 0.0, 40.0, False
    rounds = [g for g in rings if "radius" in rings[g]]
    if rounds:
        yield [f"rings.{g}.radius" for g in rounds], "um", 0.0, 40.0, False
