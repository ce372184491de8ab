"""Answers to be tampered with: trains, their certified equilibria, and their exact torques."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import loadshare as ls
from benchmarks import families
from benchmarks.limit import TooLong, limited
from benchmarks.random_trains.draw import draw
from benchmarks.reference import NoReference, reference
from loadshare.case import Case
from loadshare.results.claim import claim_of
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of

CASES = Path(__file__).parents[2] / "cases"
SHIPPED = (
    "fgfbstts/all_elements",
    "fgfbstts/both_errors",
    "fgfbstts/full_float",
    "fgfbstts/limit_ring",
    "fgfbstts/spline_clearance",
    "star/floating_sun_5",
    "two_path/clocking_error",
)
COMMON = 1e-2
"""Common shift of all gears [m]: it changes no relative position, but makes every length of the
case look large."""
PATIENCE = 20.0
"""Processor time for the reference of one train [s]."""


@dataclass(frozen=True, eq=False)
class Victim:
    """A certified answer.

    Attributes
    ----------
    case : Case
    train : Train
    answer : Equilibrium
    torque : mapping of mesh to float
        Computed in 50 digits, then rounded [N·m].
    """

    case: Case
    train: Train
    answer: Equilibrium
    torque: dict[str, float]

    @property
    def largest(self) -> float:
        """Largest torque [N·m] of flanks or from outside; flanks may squeeze each other."""
        flanks = (
            abs(mesh.lever(d)) * self.answer.flank_force[mesh.flank_name(d)]
            for mesh in self.train.meshes.values()
            for d in mesh.flanks
        )
        outside = situation_of(self.train, self.answer.index).torques.values()
        return max(*flanks, *map(abs, outside))

    def errors(self, found: Equilibrium) -> dict[str, float]:
        """Return the error of every torque of a claim [N·m]."""
        return {
            name: abs(
                sum(mesh.lever(d) * found.flank_force[mesh.flank_name(d)] for d in mesh.flanks)
                - self.torque[name]
            )
            for name, mesh in self.train.meshes.items()
        }


def victim(case: Case, index: int) -> Victim | None:
    """Solve a position and find its reference; None if it has no answer or no reference."""
    try:
        found = ls.explain(case, index)
        with limited(PATIENCE):
            exact = reference(found.train, index, found.equilibrium)
    except (ls.Refused, NoReference, ArithmeticError, TooLong):
        return None
    if not any(exact.torque.values()):
        return None
    # The claim also states the forces that would follow from displacements: they can be tampered
    # with.
    claim = claim_of(found.train, found.equilibrium)
    answer = claim.equilibrium(index, found.equilibrium.undetermined)
    return Victim(case, found.train, answer, dict(exact.torque))


def victims(seed: int) -> Iterator[Victim]:
    """Yield shipped trains, trains that are hard to judge, and random trains without end."""
    for case in (*(ls.load_case(CASES / f"{name}.toml") for name in SHIPPED), *hard()):
        found = victim(case, 1)
        assert found is not None, case.name
        yield found
    number = 0
    while True:
        case = draw(seed, number)
        with suppress(ls.CaseError):
            found = victim(case, 1 + number % case.operating.positions)
            if found is not None:
                yield found
        number += 1


def hard() -> Iterator[Case]:
    """Yield trains in which residuals say little about torques."""
    for ratio in (1e2, 1e4, 1e6):
        yield in_series(ratio)
    for name in ("limit_ring", "full_float"):
        yield shifted(ls.load_case(CASES / f"fgfbstts/{name}.toml"), COMMON)
    yield shifted(in_series(1e4), COMMON)


def in_series(ratio: float) -> Case:
    """Return a stiff split behind a soft mesh: three planets whose sun is driven by a soft mesh.

    Parameters
    ----------
    ratio : float
        Of the stiffnesses.
    """
    data: dict[str, Any] = families.star(3).to_dict()
    data["title"] = f"A split {ratio:g} times as stiff as the mesh before it"
    del data["stages"]
    for mesh in data["meshes"].values():
        torsional = float(mesh["stiffness"].split()[0])
        mesh["stiffness"] = f"{torsional * ratio**0.5!r} N*m/rad"
        mesh["gap"] = "0 rad"
    data["gears"]["sun"]["support"] = "1e9 N/m"
    data["gears"] |= {
        "wheel": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]},
        "first": {"base_radius": "50 mm", "centre": ["0 mm", "120 mm"]},
    }
    data["meshes"]["first-wheel"] = {
        "pressure_angle": f"{math.acos(100.0 / 120.0)!r} rad",
        "stiffness": f"{1e6 / ratio**0.5!r} N*m/rad",
    }
    data["shafts"] = {"wheel-sun": {"stiffness": "1e6 N*m/rad"}}
    data["operating"] |= {"input": "first"}
    data["errors"] = {"planet1": {"installation": ["1 um", "0 um"]}}
    return Case(data, name=f"in series {ratio:g}")


def shifted(case: Case, way: float) -> Case:
    """Return the same train with all gears shifted by the same distance along x [m]."""
    data, offsets = case.to_dict(), build_train(case).offsets
    errors = data.setdefault("errors", {})
    for gear in data["gears"]:
        old = offsets[gear].installation.tolist() if gear in offsets else [0.0, 0.0, 0.0]
        new = [old[0] + way, *old[1:]]
        errors.setdefault(gear, {})["installation"] = [f"{v!r} m" for v in new]
    return Case(data, name=f"{case.name} shifted")
