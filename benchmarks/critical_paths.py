"""Critical values of random paths against dense scans: what is missed, invented, or raises.

Run with ``python benchmarks/critical_paths.py [--count N] [--points N] [--engine NAME]``. Every
path is a random train (stars and split-torque trains with rings, splines, backlash, Hertz contact,
tabulated laws, errors, elastic shafts and bearings) along one to three inputs that take the same
value. Its events are compared with the states of all elements in a scan by `solve_blocks`, told
from forces and displacements alone; a path with another end must give the same events.
"""

from __future__ import annotations

import argparse
import time
import traceback
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

import loadshare as ls
from loadshare.errors import CaseError, Refused
from loadshare.evidence.machine_facts import facts
from loadshare.evidence.stress.dressing import any_structure, held, spread
from loadshare.evidence.stress.workbench import BENDING, DEFLECTION, Workbench, written
from loadshare.job.many import solve_blocks
from loadshare.solver.hot import places as at
from loadshare.study.critical import Critical
from loadshare.study.follow.line import Line
from loadshare.train.equilibria import Equilibria

Array = NDArray[np.float64]
BAND = 1e-8
"""Force over load, or radius over deflection, within which a state is not told by a scan."""
EVERY = 3
"""Each how many-th path is followed to another end as well."""
NEAR = 2e-9
"""Distance of a sample from an event, relative, at which its state is not asked for."""


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
        Ends, and another upper end.
    machines : bool
        Whether every value is a machine of its own.
    """

    number: int
    case: ls.Case
    keys: tuple[str, ...]
    unit: str
    start: float
    stop: float
    other: float
    machines: bool = False


@dataclass(slots=True)
class Outcome:
    """What became of a path."""

    path: Path
    seconds: float = 0.0
    events: int = 0
    unproved: int = 0
    width: float = 0.0
    unconfirmed: int = 0
    missed: list[str] = field(default_factory=list)
    invented: list[str] = field(default_factory=list)
    moved: list[str] = field(default_factory=list)
    refused: str = ""
    raised: str = ""


# --- Random paths -------------------------------------------------------------------------------


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
        case.replace(dict.fromkeys(chosen, _text(value, unit)))
    return Path(number, case, chosen, unit, float(start), float(stop), float(other), machines)


def _text(value: float, unit: str) -> str | float:
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
    """Yield inputs that the case has: keys, unit, ends, and whether they change the machine."""
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


# --- States in a scan ---------------------------------------------------------------------------


def states(line: Line, values: Array, answers: Equilibria, certified: Array) -> dict[str, Array]:
    """Tell the state of every element at every value, from forces and displacements alone.

    Returns
    -------
    dict of str to ndarray of str, shape (S,)
        Empty where a state is within round-off of another, or there is no certified answer.
    """
    names, push, length = answers.names, line.elements.force, line.elements.length
    found: dict[str, Array] = {}
    forces = {
        **dict(zip(names.flanks, answers.flank_force.T, strict=True)),
        **dict(zip(names.contacts, answers.ring_force.T, strict=True)),
    }
    for name, force in forces.items():
        told = np.where(force > BAND * push, "closed", np.where(force > 0.0, "", "open"))
        found[name] = np.where(certified, told, "")
    numbers = line.numbers(1, values)
    torque = np.zeros((len(values), len(names.radials)))
    train = line.first
    for k, (_, gear) in enumerate(names.radials):
        for flank, force in zip(names.flanks, answers.flank_force.T, strict=True):
            torque[:, k] += train.transmitted(gear, {flank: 1.0}) * force
    scene = line.scene
    for k, (name, gear) in enumerate(names.radials):
        j = next(i for i, r in enumerate(scene.radials) if r.name == name)
        given = np.broadcast_to(numbers.radial[:, j], (len(values), 6))
        law = at.graph(given, torque[:, k] / push)
        frame = train.gears[gear].frame
        moved = answers.displacement[:, names.gears.index(gear)] @ frame.T - scene.radials[j].centre
        radius = np.linalg.norm(moved, axis=1) / length
        force = np.linalg.norm(answers.radial_reaction[:, k], axis=1) / push
        if name.startswith("ring"):
            told = np.where(force > BAND, "on boundary", "inside")
        else:
            told = _spline_state(law, radius, force)
        found[name] = np.where(certified, told, "")
    return found


def _spline_state(law: at.Graph, radius: Array, force: Array) -> Array:
    """State of a spline by radius and force over the units; empty within round-off of a corner."""
    jump = law.bound > law.first * law.stick * (1.0 + 1e-9)
    told = np.where(radius < law.reach, "slip", "stop")
    told = np.where(radius < law.stick, "stick", told)
    near = np.abs(radius - law.stick) <= BAND
    low = law.first * np.where(np.isfinite(law.stick), law.stick, 0.0)
    inside = (force > low + BAND) & (force < law.bound - BAND)
    told = np.where(near, np.where(jump & inside, "about to slip", ""), told)
    return np.where((np.abs(radius - law.reach) <= BAND) & ~near, "", told)


def scanned(path: Path, line: Line, values: Array, engine: str) -> dict[str, Array]:
    """Scan a path."""
    unit = f" [{path.unit}]" if path.unit else ""
    table = {f"{key}{unit}": values for key in path.keys}
    parts: list[dict[str, Array]] = []
    for block in solve_blocks(path.case, table, positions=[1], engine=engine, workers=1):
        here = values[block.rows]
        parts.append(states(line, here, block.equilibria[0], block.certified[:, 0]))
    return {name: np.concatenate([p[name] for p in parts]) for name in parts[0]}


# --- Comparison ---------------------------------------------------------------------------------


def compared(found: Critical, values: Array, seen: dict[str, Array]) -> tuple[list[str], list[str]]:
    """Return what events miss of a scan, and what they tell that it does not show.

    Samples in intervals that are named as not proved are left out; beyond each of them states are
    taken from the scan again.
    """
    missed, invented = [], []
    edges = [found.start, *(v for u in found.unproved for v in (u.start, u.stop)), found.stop]
    for name, told in seen.items():
        events = [e for e in found.events if e.element == name]
        for low, high in zip(edges[::2], edges[1::2], strict=True):
            inner = [e for e in events if low <= e.value <= high and e.confirmed]
            rows = np.flatnonzero((values >= low) & (values <= high) & (told != ""))
            wrong = _disagreement(inner, values[rows], told[rows])
            if wrong is None:
                continue
            changes = int((told[rows][1:] != told[rows][:-1]).sum())
            where = f"{name} at {values[rows][wrong]:.12g}: {changes} changes, {len(inner)} events"
            (missed if changes >= len(inner) else invented).append(where)
    return missed, invented


def _disagreement(events: Sequence[ls.Critical | object], values: Array, told: Array) -> int | None:
    """First sample whose state is not the one that events tell; None if all agree."""
    if not len(values):
        return None
    expected = np.full(len(values), told[0] if not events else events[0].before, dtype=told.dtype)
    asked = np.ones(len(values), dtype=bool)
    for event in events:
        expected = np.where(values > event.value, event.after, expected)
        asked &= np.abs(values - event.value) > NEAR * max(abs(event.value), values[-1] - values[0])
    wrong = np.flatnonzero(asked & (expected != told))
    return int(wrong[0]) if len(wrong) else None


def between(found: Critical) -> Array:
    """Values between neighbouring events, where a scan's steps may be too wide."""
    ends = sorted({found.start, found.stop, *(e.value for e in found.events)})
    return np.array([0.5 * (a + b) for a, b in pairwise(ends)])


def judged(path: Path, points: int, engine: str) -> Outcome:
    """Find a path's events, and compare them with a scan and with a path of another end."""
    outcome = Outcome(path)
    ends = [_text(v, path.unit) for v in (path.start, path.stop, path.other)]
    try:
        begun = time.perf_counter()
        found = ls.critical(path.case, path.keys, ends[0], ends[1], positions=[1])
        outcome.seconds = time.perf_counter() - begun
        again = found
        if path.number % EVERY == 0:
            again = ls.critical(path.case, path.keys, ends[0], ends[2], positions=[1])
        line = Line(path.case, found.parameter, path.start, path.stop)
        count = min(points, 1000) if path.machines else points
        values = np.union1d(np.linspace(path.start, path.stop, count), between(found))
        seen = scanned(path, line, values, engine)
    except Refused as refusal:
        outcome.refused = str(refusal).splitlines()[0]
        return outcome
    except Exception:  # noqa: BLE001 -- whatever escapes is what is counted
        outcome.raised = traceback.format_exc(limit=-4)
        return outcome
    outcome.events = len(found.events)
    outcome.unproved = len(found.unproved)
    outcome.width = sum(u.stop - u.start for u in found.unproved) / (path.stop - path.start)
    outcome.unconfirmed = sum(not e.confirmed for e in found.events)
    outcome.missed, outcome.invented = compared(found, values, seen)
    outcome.moved = apart(found, again)
    return outcome


def apart(found: Critical, other: Critical) -> list[str]:
    """Events that two ranges do not have in common although both hold them."""
    size = 1e-9 * max(abs(found.stop), abs(found.start))
    top = other.stop - size
    sets = []
    for one in (found, other):
        named = [(u.start, u.stop) for u in (*found.unproved, *other.unproved)]
        sets.append(
            [
                e
                for e in one.events
                if e.value <= top and not any(a - size <= e.value <= b + size for a, b in named)
            ]
        )
    here, there = sets
    if len(here) != len(there):
        return [f"{len(here)} events up to {other.stop:.12g}, {len(there)} in the shorter range"]
    return [
        f"{a.element} at {a.value:.15g} or {b.value:.15g}"
        for a, b in zip(here, there, strict=True)
        if abs(a.value - b.value) > size or (a.element, a.after) != (b.element, b.after)
    ]


def main() -> None:
    """Judge many paths and print a Markdown table."""
    parser = argparse.ArgumentParser(description="Critical values against dense scans.")
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--engine", default="compiled")
    asked = parser.parse_args()
    every: list[Outcome] = []
    for number in range(asked.first, asked.first + asked.count):
        outcome = judged(random_path(number), asked.points, asked.engine)
        every.append(outcome)
        told = [*outcome.missed, *outcome.invented, *outcome.moved, outcome.refused, outcome.raised]
        if any(told) or outcome.unproved:
            path = outcome.path
            ends = f"{path.start:.6g} to {path.stop:.6g} {path.unit}"
            gaps = f"{outcome.unproved} unproved, {outcome.width:.1e} of the range"
            print(f"{number}: {', '.join(path.keys)} {ends}: {gaps}", flush=True)  # noqa: T201
            for line in filter(None, told):
                print(f"    {line}", flush=True)  # noqa: T201
    print(summary(every))  # noqa: T201


def summary(every: Sequence[Outcome]) -> str:
    """Return a Markdown table of many paths."""
    answered = [o for o in every if not o.refused and not o.raised]
    seconds = np.array([o.seconds for o in answered] or [0.0])
    rows = [
        ("paths", str(len(every))),
        ("refused at an end", str(sum(bool(o.refused) for o in every))),
        ("exceptions", str(sum(bool(o.raised) for o in every))),
        ("events", str(sum(o.events for o in answered))),
        ("missed", str(sum(len(o.missed) for o in answered))),
        ("invented", str(sum(len(o.invented) for o in answered))),
        ("other with another end", str(sum(len(o.moved) for o in answered))),
        ("paths with intervals named as not proved", str(sum(o.unproved > 0 for o in answered))),
        ("widest of them, of the range", f"{max((o.width for o in answered), default=0.0):.1e}"),
        ("events not confirmed", str(sum(o.unconfirmed for o in answered))),
        ("median time of a path [s]", f"{np.median(seconds):.2f}"),
        ("longest [s]", f"{seconds.max():.1f}"),
    ]
    rows += list(facts().items())
    return "\n".join(["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows)])


if __name__ == "__main__":
    main()
