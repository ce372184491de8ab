"""Loaded tooth contact analysis against published figures and its own refinement, as Markdown.

Run with ``python -m benchmarks.ltca_evidence`` in the repository. It measures the results that the
page on loaded tooth contact states: ISO/TR 6336-30, example 1; refinement of elements and of
contact points; the stiffness ranges of the seed paper. Times are in ``benchmarks/ltca.py``.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from dataclasses import replace

from benchmarks.ltca import PAIRS, on_half_planes, table
from loadshare.tooth.analysis.fit import FIT_LOADS
from loadshare.tooth.analysis.ltca import (
    Model,
    PairCompliance,
    contact_problems,
    ltca,
    pair_compliance,
)
from loadshare.tooth.compliance.block import Divisions
from loadshare.tooth.compliance.finite import FiniteElements
from loadshare.tooth.contact.programme import solve_contact
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.cylindrical.pair import HelicoidPair
from loadshare.tooth.law.iso6336 import formula_stiffness
from loadshare.tooth.pair.file import PairFile, load_pair

PAPER = {"p12": (7.46e5, 9.27e5), "p46": (3.77e6, 4.78e6), "p610": (6.17e6, 6.68e6)}
"""Ranges of the seed's Fig. 7 [N·m/rad at the driver]."""
HELIX = math.radians(15.8)
LINE_LOAD = 300e3
"""Load per face width at which the standard states its stiffness [N/m]."""


def say(text: str = "") -> None:
    """Print a line immediately."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def iso_pair(bore: float | None = None) -> HelicoidPair:
    """Return the pair of ISO/TR 6336-30, example 1, its wheel solid to a bore radius [m]."""
    pinion = HelicoidGear(8e-3, 17, 0.1, helix_angle=HELIX, profile_shift=0.145, dedendum=1.4)
    wheel = HelicoidGear(8e-3, 103, 0.1, helix_angle=-HELIX, dedendum=1.4, rim=bore)
    return HelicoidPair(pinion, wheel, 0.5)


def compliances(gears: HelicoidPair, model: Model | None) -> PairCompliance:
    """Return compliances from finite elements, slices, or (None) slices on half-planes."""
    return pair_compliance(gears, model) if model else on_half_planes(gears)


def mean_stiffness(gears: HelicoidPair, model: Model | None) -> float:
    """Return the mean over the cycle at 300 N/mm, per face width [N/(mm·µm)]."""
    torque = LINE_LOAD * 0.1 * gears.driver_gear.radius
    found = ltca(gears, torque, 8, FIT_LOADS, compliances(gears, model), 32).secant(0.9)
    return float(found.mean()) / gears.driver_gear.base_radius**2 / 0.1 * 1e-9


def single_stiffness(model: Model | None, bore: float | None) -> float:
    """Return the largest stiffness of one pair alone: virtual spur pair times cos β [N/(mm·µm)]."""
    pinion = HelicoidGear(8e-3, 19, 0.1, profile_shift=0.145, dedendum=1.4)
    wheel = HelicoidGear(8e-3, 115, 0.1, dedendum=1.4, rim=bore)
    gears = HelicoidPair(pinion, wheel, 134 * 4e-3 + 0.14 * 8e-3)
    compliance, load, found = compliances(gears, model), LINE_LOAD * 0.1, []
    for position in gears.positions([k / 10.0 for k in range(10)], 32):
        for line in position.lines:
            alone = contact_problems(gears, [replace(position, lines=(line,))], compliance)[0]
            found.append(load / solve_contact(alone, load).approach / 0.1 * 1e-9)
    return max(found) * math.cos(HELIX)


def standard() -> None:
    """Print the table on ISO/TR 6336-30, example 1."""
    formula = formula_stiffness(
        (17, 103), profile_shift=(0.145, 0.0), dedendum=(1.4, 1.4), contact_ratio=1.5491,
        helix_angle=HELIX,
    )  # fmt: skip
    single, mesh = formula.single * 1e-9, formula.mesh * 1e-9
    rows = [["standard, by formula", f"{single:.2f}", "–", f"{mesh:.2f}", "–"]]
    models: tuple[Model, ...] = ("finite elements", "slices")
    for model in models:
        for wheel, bore in (
            ("wheel solid to 0.72 of its root radius", 0.30),
            ("rim of 1.5 tooth heights, held", None),
        ):
            rows.append([f"{model}, {wheel}", *against(model, bore, single, mesh)])
    rows.append(["slices on half-planes", *against(None, None, single, mesh)])
    table(("ISO/TR 6336-30, example 1", "c'", "difference", "c_γα", "difference"), rows)


def against(model: Model | None, bore: float | None, single: float, mesh: float) -> list[str]:
    """Return C' and c_γα of a model with their differences from the standard."""
    # The virtual spur wheel is solid to the same fraction of its root radius.
    spur = bore and bore * (115 * 4e-3 - 1.4 * 8e-3) / iso_pair().driven_gear.root
    found = single_stiffness(model, spur), mean_stiffness(iso_pair(bore), model)
    return [
        text
        for value, wanted in zip(found, (single, mesh), strict=True)
        for text in (f"{value:.2f}", f"{100 * (value / wanted - 1):+.1f} %")
    ]


def refined(level: int, layers: int) -> Divisions:
    """Return elements that are `level` times as fine as at level 1."""
    return Divisions(2 * level, 2 * level, math.ceil(level / 2), level, level + 1, layers * level)


def convergence(name: str, layers: int, levels: Iterable[int]) -> None:
    """Print the stiffness of a shipped pair over refinement of elements and of contact points."""
    pair = load_pair(PAIRS / f"{name}.toml")
    gears, default = pair.geometry, pair_compliance(pair.geometry)
    reference = stiffness(pair, default, 32)
    found, rows = {}, []
    for level in levels:
        mesh = refined(level, layers)
        driver = FiniteElements(gears.driver, 1, teeth=3, divisions=mesh)
        driven = FiniteElements(gears.driven, gears.driven_side, teeth=3, divisions=mesh)
        found[level] = stiffness(pair, PairCompliance(driver, driven, "finite elements"), 32)
        size = f"{driver.size} + {driven.size}"
        rows.append([str(level), size, f"{found[level]:.5g}", percent(reference, found[level])])
    table((f"{name}: elements", "unknowns", "mean K [N·m/rad]", "default against it"), rows)
    say_order(found)
    found, rows = {}, []
    for points in (8, 16, 32, 64, 128):
        found[points] = stiffness(pair, default, points)
        rows.append([str(points), f"{found[points]:.5g}", percent(reference, found[points])])
    table((f"{name}: points on a line", "mean K [N·m/rad]", "default against it"), rows)
    say_order(found)


def stiffness(pair: PairFile, compliance: PairCompliance, points: int) -> float:
    """Return the mean secant stiffness at the rated torque over five positions [N·m/rad]."""
    found = ltca(pair.geometry, pair.torque, 5, (1.0,), compliance, points)
    return float(found.secant(1.0).mean())


def percent(one: float, other: float) -> str:
    """Return the relative difference of one value from the other, as text."""
    return f"{100 * (one / other - 1):+.2f} %"


def say_order(found: dict[int, float]) -> None:
    """Print the observed order of convergence from refinements by two."""
    for n in found:
        if 2 * n in found and 4 * n in found:
            first, second = found[n] - found[2 * n], found[2 * n] - found[4 * n]
            if first * second > 0.0:
                order = math.log2(first / second)
                say(f"{n}, {2 * n}, {4 * n}: observed order {order:.2f}.\n")


def seed() -> None:
    """Print the ranges of the seed's Fig. 7."""
    rows = []
    for name, (low, high) in PAPER.items():
        pair = load_pair(PAIRS / f"{name}.toml")
        found = pair.analyse().secant(1.0)
        ends = (float(found.min()), float(found.max()))
        finer = pair.revised(positions=20).analyse().secant(1.0)
        rows.append(
            [
                name,
                f"{low:.3g}–{high:.3g}",
                f"{ends[0]:.3g}–{ends[1]:.3g}",
                f"{percent(ends[0], low)}, {percent(ends[1], high)}",
                f"{high / low:.3f}",
                f"{ends[1] / ends[0]:.3f}",
                percent(ends[1] / ends[0], high / low),
                f"{finer.max() / finer.min():.3f}",
            ]
        )
    table(
        ("pair", "paper", "ours", "difference", "max/min, paper", "ours", "difference",
         "ours, 20 positions"),
        rows,
    )  # fmt: skip


def main() -> None:
    """Print all tables."""
    seed()
    standard()
    convergence("p12", 3, (1, 2, 3, 4))
    convergence("p46", 4, (1, 2, 3))


if __name__ == "__main__":
    main()
