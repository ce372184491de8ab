"""Helpers of several test packages: shipped cases, their variants, solutions of one position."""

from collections.abc import Container, Iterable, Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.certify.oracle import ClaimedState

import loadshare as ls
from benchmarks import families
from loadshare.certify import Certificate, Claims, certify
from loadshare.certify.bound import Bound
from loadshare.scene import assemble
from loadshare.solver import Options, Record, solve_scene
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium

CASES = Path(__file__).parents[1] / "cases"
SHIPPED = tuple(
    sorted(
        p.relative_to(CASES).with_suffix("").as_posix()
        for p in CASES.rglob("*.toml")
        if p.parent.name != "pairs"
    )
)
"""Every shipped case, as "folder/name"."""


def mostly_slow(values: Iterable[object], quick: Container[object]) -> list[object]:
    """Return parameters of a test; some run every time, the others with the slow tests.

    For tests that take seconds and find the same faults in many cases: `quick` contains one of each
    kind of element.
    """
    slow = pytest.mark.slow
    several = [v if isinstance(v, tuple) else (v,) for v in values]
    return [pytest.param(*v, marks=[] if v in quick or v[0] in quick else slow) for v in several]


EVERY_SHIPPED = mostly_slow(SHIPPED, {*SHIPPED} - {"fgfbstts/from_geometry"})
"""The same as parameters. Laws from teeth take long to compute, and are then ordinary laws."""
BACKLASHES = ("1-2", "1-3", "4-6", "4-7", "5-8", "5-9", "6-10", "7-10", "8-10", "9-10")
"""Meshes of the seed's transmission."""


@cache
def shipped(name: str) -> ls.Case:
    """Return a shipped case."""
    return ls.load_case(CASES / f"{name}.toml")


def loaded(case: ls.Case, torque: str) -> ls.Case:
    """Return the case under another input torque."""
    gone = {f"operating.{k}": None for k in ("power", "speed") if k in case.to_dict()["operating"]}
    return case.replace({**gone, "operating.torque": torque})


def with_backlash(case: ls.Case, backlash: str) -> ls.Case:
    """Return the seed's transmission with the same circumferential backlash on every mesh."""
    return case.replace({f'meshes."{m}".backlash': backlash for m in BACKLASHES})


def round_ring(stiffness: str = "rigid") -> ls.Case:
    """Return a star of five whose sun presses on a round limit ring that is off centre."""
    ring = {"radius": "3 um", "offset": ["0.5 um", "-1 um"], "stiffness": stiffness}
    return families.star(5).replace({"rings": {"sun": ring}})


def lost_contact() -> ls.Case:
    """Return a star of four with so little load that two of its planets lose contact."""
    return families.star(4).replace({"operating.torque": "100 N*m"})


def coasting() -> ls.Case:
    """Return the seed's transmission at light load, small backlash: errors close coast flanks."""
    return with_backlash(loaded(shipped("fgfbstts/both_errors"), "60 N*m"), "5 um")


def answer(train: Train, index: int = 1, **options: object) -> tuple[Equilibrium, Record]:
    """Return the equilibrium of one position as the solver claims it."""
    return solve_scene(assemble(train, index), Options(**options))


def certified(case: ls.Case, index: int = 1, **options: object) -> tuple[Equilibrium, Certificate]:
    """Return the equilibrium of one position and its certificate, which must pass."""
    train = build_train(case)
    found, _ = answer(train, index, **options)
    certificate = certify(train, found)
    assert certificate.passed, certificate.failing
    return found, certificate


def bound_of(train: Train, answer: Equilibrium, rigorous: bool = False) -> Bound:
    """Return the bound on the distance of a claim from the exact equilibrium."""
    (found,) = Claims.of(train, [answer], rigorous).bounds
    return found


def driver_torques(case: ls.Case, index: int = 1, **options: object) -> dict[str, float]:
    """Return the torque [N·m] on the driver of every mesh, drive flank less coast flank."""
    train = build_train(case)
    found, _ = answer(train, index, **options)
    return {
        name: sum(mesh.lever(d) * found.flank_force[mesh.flank_name(d)] for d in mesh.flanks)
        for name, mesh in train.meshes.items()
    }


def furthest(one: Mapping[str, float], other: Mapping[str, float]) -> float:
    """Return the largest difference of two sets of figures, over the largest figure."""
    assert one.keys() == other.keys()
    size = max((abs(v) for v in one.values()), default=0.0) or 1.0
    return max((abs(one[k] - other[k]) for k in one), default=0.0) / size


def turned(angle: float) -> np.ndarray:
    """Return the rotation (3, 3) about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def coordinates(train: Train, found: Equilibrium) -> dict[str, float]:
    """Return every displacement [m] of an answer by name: x, y, arc length at the base circle."""
    moved = {
        f"gear {n} {axis}": float(way @ found.displacement[n])
        for n, gear in train.gears.items()
        for axis, way in zip("xy", gear.frame, strict=True)
    }
    turned = {
        f"gear {n} rotation": found.rotation[n] * g.base_radius for n, g in train.gears.items()
    }
    return moved | turned


def forces(found: Equilibrium) -> dict[str, float]:
    """Return every force of an answer [N] by name."""
    reactions = {
        f"{name} {axis}": float(v)
        for name, force in found.radial_reaction.items()
        for axis, v in zip("xyz", force, strict=True)
    }
    return {**found.flank_force, **found.ring_force, **reactions}


def disagreement(train: Train, one: Equilibrium, other: Equilibrium) -> tuple[float, float]:
    """Return the largest differences of two answers: forces over the largest force, determined
    displacements over the deflection of the case.
    """
    free = {*one.undetermined, *other.undetermined}
    moved = [
        {k: v for k, v in coordinates(train, a).items() if k not in free} for a in (one, other)
    ]
    deflection = certify(train, one).deflection
    apart = max((abs(moved[0][k] - moved[1][k]) for k in moved[0] if k not in free), default=0.0)
    return furthest(forces(one), forces(other)), apart / deflection


def potential(train: Train, found: Equilibrium) -> float:
    """Return the potential energy of an answer [J], from its displacements alone."""
    state = ClaimedState(train, found)
    energy = [-t * found.rotation[g] for g, t in state.situation.torques.items()]
    energy += [push.law.energy(push.approach) for push in state.pushes]
    energy += [pull.law.energy(float(np.linalg.norm(pull.offset))) for pull in state.pulls]
    for name, wind, _ in state.winds():
        if np.isfinite(train.shafts[name].stiffness):
            energy.append(0.5 * train.shafts[name].stiffness * wind**2)
    for name, gear in train.gears.items():
        if gear.support is not None:
            energy.append(0.5 * float(gear.support @ (gear.frame @ found.displacement[name]) ** 2))
    return float(np.sum(energy))
