"""Loaded tooth contact analysis: time and agreement, as Markdown tables.

Run with ``python benchmarks/ltca.py``. The pair is that of ISO/TR 6336-30, example 1, at five
positions of the mesh cycle and three loads; times are of one run for the finite elements, and the
least of several for what is short.
"""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TypeVar

import numpy as np
import scipy
from scipy.optimize import nnls

from loadshare.solver.backend import backend
from loadshare.tooth.contact_problem import ContactProblem
from loadshare.tooth.contact_programme import by_interface, exchange, solve_contact
from loadshare.tooth.helicoid import HelicoidGear
from loadshare.tooth.helicoid_pair import HelicoidPair
from loadshare.tooth.law_fit import FIT_LOADS
from loadshare.tooth.ltca import contact_problem, ltca, pair_compliance
from loadshare.tooth.modification import Modification

T = TypeVar("T")
TORQUE = 2000.0
POSITIONS = 5


def timed(action: Callable[[], T], repeat: int = 1) -> tuple[T, float]:
    """Answer of an action, and the least of its times [s]."""
    best = math.inf
    for _ in range(repeat):
        start = time.perf_counter()
        answer = action()
        best = min(best, time.perf_counter() - start)
    return answer, best


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> None:
    """Print a Markdown table."""
    lines = [list(head), *map(list, rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    print("\n".join(f"| {' | '.join(line)} |" for line in lines), end="\n\n")  # noqa: T201


def gears() -> HelicoidPair:
    """The pair, its wheel solid to 60 % of its diameter, with 10 µm of lead crowning."""
    helix = math.radians(15.8)
    pinion = HelicoidGear(
        8e-3, 17, 0.1, helix_angle=helix, profile_shift=0.145, dedendum=1.4,
        modification=Modification(lead_crowning=10e-6),
    )  # fmt: skip
    wheel = HelicoidGear(8e-3, 103, 0.1, helix_angle=-helix, dedendum=1.4, rim=0.26)
    return HelicoidPair(pinion, wheel, 0.5)


def compare_models(pair: HelicoidPair) -> None:
    """Finite elements against slices."""
    slow, slow_time = timed(lambda: pair_compliance(pair, "finite elements"))
    fast, fast_time = timed(lambda: pair_compliance(pair, "slices"), 3)
    geometry = timed(lambda: [pair.position(k / POSITIONS, 32) for k in range(POSITIONS)], 3)[1]
    results = {}
    rows = []
    for name, compliance, build in (
        ("finite elements", slow, slow_time),
        ("slices", fast, fast_time),
    ):
        found, whole = timed(
            lambda c=compliance: ltca(pair, TORQUE, POSITIONS, FIT_LOADS, c),
            1 if name == "finite elements" else 3,
        )
        stiffness = found.secant(0.9)
        results[name] = stiffness
        rows.append(
            [
                name,
                f"{build:.3f}",
                f"{geometry:.3f}",
                f"{whole - geometry:.3f}",
                f"{build + whole:.3f}",
                f"{stiffness.mean():.4g}",
                f"{stiffness.max() / stiffness.min():.4f}",
            ]
        )
    table(
        ("model", "compliances [s]", "geometry [s]", "contacts [s]", "all [s]",
         "mean K at 0.9 T [N·m/rad]", "max/min"),
        rows,
    )  # fmt: skip
    ratio = results["slices"] / results["finite elements"]
    spread = np.abs(ratio / ratio.mean() - 1.0).max()
    print(  # noqa: T201
        f"Slices: compliances {slow_time / fast_time:.0f} times faster; stiffness "
        f"{100 * (ratio.mean() - 1):+.1f} % on average, shape over the cycle within "
        f"{100 * spread:.1f} %.\n"
    )


def compare_programmes(pair: HelicoidPair) -> None:
    """One linear contact (widths held) by every method, and the whole contact with its law."""
    compliance = pair_compliance(pair, "slices")
    rows: list[list[str]] = []
    for points in (16, 32, 64):
        rows += programme_rows(contact_problem(pair, pair.position(0.0, points), compliance), pair)
    table(("points", "method", "time [ms]", "worst residual"), rows)


def programme_rows(problem: ContactProblem, pair: HelicoidPair) -> list[list[str]]:
    """Rows of the table for one contact problem."""
    load, count = TORQUE / pair.arm, len(problem.gap)
    force = np.full(count, load / count)
    secant = problem.compliance(force)[0]
    even = 0.5 * (secant + secant.T)

    def by_nnls() -> np.ndarray:
        """NNLS of the Cholesky factor, with the load as a row of weight 1e5."""
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
        "solver interface, Clarabel + exact": lambda: through("clarabel"),
        "solver interface, OSQP + exact": lambda: through("osqp"),
    }
    rows = []
    for name, method in methods.items():
        found, seconds = timed(method, 5)
        residual = _violation(even, problem.gap, load, found)
        rows.append([str(count), name, f"{1e3 * seconds:.2f}", residual])
    cold, cold_time = timed(lambda: solve_contact(problem, load), 5)
    warm, warm_time = timed(lambda: solve_contact(problem, 1.1 * load, cold.force), 5)
    for name, contact, seconds in (("cold", cold, cold_time), ("warm", warm, warm_time)):
        told = f"whole contact, {name} ({contact.passes} passes)"
        residual = f"{contact.certificate.worst:.0e}"
        rows.append([str(count), told, f"{1e3 * seconds:.2f}", residual])
    return rows


def _violation(matrix: np.ndarray, gap: np.ndarray, load: float, force: np.ndarray | None) -> str:
    """Worst scaled residual of a linear contact, its approach taken where most load is."""
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
    # Tables and imports are made once, before anything is timed.
    ltca(replace(pair), TORQUE, 1, compliance="slices", points=8)
    compare_models(pair)
    compare_programmes(pair)


if __name__ == "__main__":
    main()
