"""Batches of random trains.

Run with ``python -m benchmarks.random_batches --page docs/evidence/random-batches.md``. It may be
stopped at any time; the same command continues. The table covers all trains of the seed on file.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

import loadshare as ls
from benchmarks import kept
from benchmarks.random_batches.measure import COUNTS, SCATTER, measured
from benchmarks.random_trains.draw import draw

ABOUT = f"""# Random batches

How fast is a batch of a train that nobody chose? [Speed against accuracy](speed.md) measures a
few trains that we had in mind. Here random trains are drawn as for [random
trains](random-trains.md) and [random planetary sets](planetary-sets.md), loops included, and
each is solved for {COUNTS[-1]} samples in which loads, errors, clearances, gaps and stiffnesses
vary by up to {100 * SCATTER:.0f} % each. These trains are meant to be hard: stiffnesses that
differ by up to nine decades, clearances of zero, loads from a millionth of the rated one, and
often more splines, rings and bearings with clearance than any gearbox has. Times are processor
time per equilibrium on one core, certificate and bound included, of a batch that was solved
once before (of {COUNTS[1]} or {COUNTS[0]} samples where {COUNTS[-1]} take too long). Of each batch,
three samples are compared with single solves.
"""
EDGES = (10.0, 30.0, 100.0, 300.0, 1e3, 1e4, 1e5, np.inf)
"""Classes of times [µs]."""


def main() -> None:
    """Draw, measure, report."""
    parser = kept.parser("Batches of random trains.", "trains", 200, "random_batches")
    parser.add_argument("--seed", type=int, default=20)
    options = parser.parse_args()
    rows = kept.run(
        kept.numbers(options),
        {"seed": options.seed},
        options.out / "batches.jsonl",
        partial(measured, options.seed),
        processes=options.processes,
        warm=_warm,
    )
    words = f"benchmarks.random_batches --count {len(rows)} --seed {options.seed}"
    kept.publish(options.page, ABOUT, words, text(rows))


def _warm() -> None:
    ls.solve(draw(0, 0), engine="compiled")


def text(rows: Sequence[dict[str, Any]]) -> str:
    """Return tables of times, and what was certified and compared."""
    solved = [row for row in rows if "microseconds" in row]
    times = np.array([row["microseconds"] for row in solved])
    equilibria, certified = (sum(row[k] for row in solved) for k in ("equilibria", "certified"))
    quantiles = np.percentile(times, [10.0, 50.0, 90.0, 100.0])
    lines = [
        f"{len(rows)} trains, of which {len(solved)} have an answer themselves; {equilibria:,} "
        f"equilibria, {certified:,} certified. Largest difference of a torque from a single solve, "
        f"over the largest torque: {max(row['apart'] for row in solved):.1e}.",
        "",
        "| µs per equilibrium | 10 % | median | 90 % | worst |",
        "| --- | ---: | ---: | ---: | ---: |",
        f"| all trains | {' | '.join(f'{q:,.3g}' for q in quantiles)} |",
        "",
        "| µs per equilibrium | trains |",
        "| --- | ---: |",
    ]
    low = 0.0
    for high in EDGES:
        count = int(((times > low) & (times <= high)).sum())
        name = f"up to {high:,.0f}" if high < np.inf else f"above {low:,.0f}"
        lines.append(f"| {name} | {count} |")
        low = high
    return "\n".join(lines)


if __name__ == "__main__":
    main()
