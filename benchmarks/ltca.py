"""Loaded tooth contact analysis: time and agreement, as Markdown tables.

Run with ``python -m benchmarks.ltca``. First, both models of the teeth are compared on the shipped
pairs and on that of ISO/TR 6336-30, example 1, at five positions of the mesh cycle and three loads;
then the contact programme is compared with other methods. Times are processor times, the shortest
of several runs, so that imports and one-time preparation do not count.
"""

from __future__ import annotations

import math
import platform
import resource
import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np
import scipy
from scipy.optimize import nnls

from loadshare.contact.backends.backend import backend
from loadshare.tooth.analysis.fit import FIT_LOADS
from loadshare.tooth.analysis.ltca import (
    POINTS,
    Model,
    PairCompliance,
    contact_problems,
    ltca,
    pair_compliance,
)
from loadshare.tooth.compliance.slices import Slices
from loadshare.tooth.contact.problem import ToothContact
from loadshare.tooth.contact.programme import by_interface, exchange, solve_contact
from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification
from loadshare.tooth.cylindrical.pair import HelicoidPair
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.pair.file import load_pair
from loadshare.tooth.unloaded.positions import GearPair

T = TypeVar("T")
PAIRS = Path(__file__).parents[1] / "cases/fgfbstts/pairs"
TORQUE = 2000.0
POSITIONS = 5


class Clock:
    """Processor times, and the largest relative excess of wall time."""

    waited = 0.0

    def timed(self, action: Callable[[], T], repeat: int = 1) -> tuple[T, float]:
        """Return the answer of an action, and the shortest of its times [s]."""
        best = math.inf
        for _ in range(repeat):
            wall, start = time.perf_counter(), time.process_time()
            answer = action()
            spent, wall = time.process_time() - start, time.perf_counter() - wall
            if spent < best:
                best, waited = spent, wall / spent - 1.0
        self.waited = max(self.waited, waited)
        return answer, best


CLOCK = Clock()


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> None:
    """Print a Markdown table."""
    lines = [list(head), *map(list, rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    print("\n".join(f"| {' | '.join(line)} |" for line in lines), end="\n\n")  # noqa: T201


def gears() -> HelicoidPair:
    """Return the pair, its wheel solid to 60 % of its diameter, with 10 µm of lead crowning."""
    helix = math.radians(15.8)
    pinion = HelicoidGear(
        8e-3, 17, 0.1, helix_angle=helix, profile_shift=0.145, dedendum=1.4,
        modification=Modification(lead_crowning=10e-6),
    )  # fmt: skip
    wheel = HelicoidGear(8e-3, 103, 0.1, helix_angle=-helix, dedendum=1.4, rim=0.26)
    return HelicoidPair(pinion, wheel, 0.5)


def on_half_planes(gears: GearPair) -> PairCompliance:
    """Return the compliances by slices with rigid bodies."""
    driver = Slices(gears.driver, 1, rigid_body=True)
    driven = Slices(gears.driven, gears.driven_side, rigid_body=True)
    return PairCompliance(driver, driven, "slices")


def compare_models() -> None:
    """Print time and error of the slices against finite elements, for every pair."""
    pairs: dict[str, tuple[GearPair, float]] = {}
    for name in ("p12", "p46", "p610"):
        file = load_pair(PAIRS / f"{name}.toml")
        pairs[name] = file.geometry, file.torque
    pairs["ISO example"] = gears(), TORQUE
    table(
        ("pair", "elements [s]", "slices [ms]", "times faster", "whole analysis, elements [s]",
         "slices [ms]", "times faster", "slices: error of mean K", "of its shape",
         "on half-planes: of mean K", "of its shape", "mean K, 16 points against 32"),
        [[name, *model_row(*pair)] for name, pair in pairs.items()],
    )  # fmt: skip


def renewed(pair: GearPair) -> GearPair:
    """Return a copy of the pair, so that no run uses cached results of another."""
    made: GearPair = replace(pair)  # type: ignore[type-var]
    return made


def model_row(pair: GearPair, torque: float) -> list[str]:
    """Return times and errors of one pair."""

    def whole(compliance: PairCompliance | Model) -> Array:
        return ltca(renewed(pair), torque, POSITIONS, FIT_LOADS, compliance).secant(0.9)

    exact, build = CLOCK.timed(lambda: pair_compliance(renewed(pair)), 3)
    _, short = CLOCK.timed(lambda: pair_compliance(renewed(pair), "slices"), 40)
    wanted, rest = CLOCK.timed(lambda: whole(exact), 5)
    found, quick = CLOCK.timed(lambda: whole("slices"), 40)
    points = POINTS["finite elements"]
    finer = ltca(pair, torque, POSITIONS, FIT_LOADS, "slices", points).secant(0.9)
    plane = on_half_planes(pair)
    return [
        f"{build:.2f}", f"{1e3 * short:.1f}", f"{build / short:.0f}",
        f"{build + rest:.2f}", f"{1e3 * quick:.0f}", f"{(build + rest) / quick:.0f}",
        *errors(found / wanted), *errors(whole(plane) / wanted),
        f"{100 * float((found / finer).mean() - 1.0):+.2f} %",
    ]  # fmt: skip


def errors(ratio: Array) -> tuple[str, str]:
    """Return the error of the mean, and that of the shape over the cycle."""
    mean = float(ratio.mean())
    return f"{100 * (mean - 1):+.1f} %", f"{100 * float(np.abs(ratio / mean - 1).max()):.1f} %"


def compare_programmes(pair: HelicoidPair) -> None:
    """Compare all methods on a linear contact (widths fixed), and on the contact with its law."""
    compliance = pair_compliance(pair, "slices")
    rows: list[list[str]] = []
    for points in (16, 32, 64):
        position = pair.positions([0.0], points)[0]
        rows += programme_rows(contact_problems(pair, [position], compliance)[0], pair)
    table(("points", "method", "time [ms]", "worst residual"), rows)


def programme_rows(problem: ToothContact, pair: HelicoidPair) -> list[list[str]]:
    """Return the rows of the table for one contact problem."""
    load, count = TORQUE / pair.arm, len(problem.gap)
    force = np.full(count, load / count)
    secant = problem.compliance(force)[0]
    even = 0.5 * (secant + secant.T)

    def by_nnls() -> np.ndarray:
        """Solve by NNLS with the Cholesky factor; the load is a row of weight 1e5."""
        root = np.linalg.cholesky(even / even.max())
        gap = np.linalg.solve(root, problem.gap / even.max())
        heavy = np.vstack([root.T, np.full((1, count), 1e5)])
        return nnls(heavy, np.append(-gap, 1e5 * load))[0]

    def through(name: str) -> np.ndarray:
        return by_interface(even, problem.gap, load, force, backend(name))

    methods: dict[str, Callable[[], np.ndarray | None]] = {
        "exchange of closed points": lambda: exchange(
            even, problem.gap, load, np.ones(count, dtype=bool)
        ),
        "scipy.optimize.nnls": by_nnls,
        "Lemke's pivots, NumPy": lambda: _by_lemke(even, problem.gap, load),
        "solver interface, Clarabel + exact": lambda: through("clarabel"),
        "solver interface, OSQP + exact": lambda: through("osqp"),
    }
    rows = []
    for name, method in methods.items():
        found, seconds = CLOCK.timed(method, 20)
        residual = _violation(even, problem.gap, load, found)
        rows.append([str(count), name, f"{1e3 * seconds:.2f}", residual])
    cold, cold_time = CLOCK.timed(lambda: solve_contact(problem, load), 20)
    warm, warm_time = CLOCK.timed(lambda: solve_contact(problem, 1.1 * load, cold.force), 20)
    for name, contact, seconds in (("cold", cold, cold_time), ("warm", warm, warm_time)):
        label = f"whole contact, {name} ({contact.passes} passes)"
        residual = f"{contact.certificate.worst:.0e}"
        rows.append([str(count), label, f"{1e3 * seconds:.2f}", residual])
    return rows


def _by_lemke(matrix: np.ndarray, gap: np.ndarray, load: float) -> np.ndarray | None:
    """Solve by Lemke's complementary pivots, from the textbook.

    The unknowns are the forces and the approach. They are complementary to the gaps and to the
    excess of the forces over the load. All are divided by the largest compliance and the load.
    """
    size = len(gap) + 1
    unit = matrix.max() * load
    rows = np.zeros((size, 2 * size + 2))
    rows[:, :size] = np.eye(size)
    rows[:-1, size : 2 * size - 1] = -matrix / matrix.max()
    rows[:-1, 2 * size - 1] = 1.0
    rows[-1, size : 2 * size - 1] = -1.0
    rows[:, 2 * size] = -1.0
    rows[:, -1] = np.append(gap / unit, -1.0)
    basis = np.arange(size)
    artificial = entering = 2 * size
    leaving = int(rows[:, -1].argmin())
    for _ in range(20 * size):
        rows[leaving] /= rows[leaving, entering]
        others = rows[:, entering].copy()
        others[leaving] = 0.0
        rows -= others[:, None] * rows[leaving]
        basis[leaving], left = entering, basis[leaving]
        if left == artificial:
            value = np.zeros(2 * size + 1)
            value[basis] = rows[:, -1]
            return np.asarray(value[size : 2 * size - 1] * load)
        entering = left + size if left < size else left - size
        column = rows[:, entering]
        with np.errstate(divide="ignore"):
            ratio = np.where(column > 1e-12, rows[:, -1] / column, np.inf)
        if np.isinf(ratio).all():
            return None
        least = np.flatnonzero(ratio <= ratio.min() + 1e-15)
        # If several could leave at once, the artificial one does, so that the pivots end.
        leaving = int(next((k for k in least if basis[k] == artificial), least[0]))
    return None


def _violation(matrix: np.ndarray, gap: np.ndarray, load: float, force: np.ndarray | None) -> str:
    """Return the worst scaled residual of a linear contact; its approach is weighted by force."""
    if force is None:
        return "no answer"
    yielded = matrix @ force
    approach = float((yielded + gap) @ force / force.sum())
    distance = yielded + gap - approach
    scale = float(np.abs(yielded).max())
    worst = max(
        float(-force.min()) / load,
        float(-distance.min()) / scale,
        float(np.abs(force * distance).sum()) / (load * scale),
        abs(float(force.sum()) - load) / load,
    )
    return f"{worst:.0e}"


def main() -> None:
    """Print the tables."""
    print(  # noqa: T201
        f"Python {platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}, "
        f"{platform.machine()}\n"
    )
    pair = gears()
    # The first run imports modules and builds tables.
    ltca(replace(pair), TORQUE, 1, compliance="slices", points=8)
    compare_models()
    compare_programmes(pair)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(  # noqa: T201
        f"Wall times were up to {100 * CLOCK.waited:.0f} % longer. Largest memory of the process: "
        f"{peak:.0f} MiB."
    )


if __name__ == "__main__":
    main()
