"""Critical values of random paths against dense scans: what is missed, invented, or raises.

Run with ``python -m benchmarks.critical_paths [--count N] [--points N] [--processes N]``. Every
path is a random train (stars and split-torque trains with rings, splines, backlash, Hertz contact,
tabulated laws, errors, elastic shafts and bearings) along one to three inputs that take the same
value. Its events are compared with the states of all elements in a scan by the batch path, told
from forces and displacements alone; a path with another end must give the same events. The run may
be stopped at any time; the same command goes on where it was.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from benchmarks import kept
from benchmarks.critical_paths.judge import one
from benchmarks.critical_paths.table import text


def main() -> None:
    """Judge many paths and print a Markdown table."""
    parser = argparse.ArgumentParser(description="Critical values against dense scans.")
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--engine", default="compiled")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument(
        "--out", type=Path, default=Path("build/critical_paths"), help="folder of what is found"
    )
    asked = parser.parse_args()
    rows = kept.run(
        range(asked.first, asked.first + asked.count),
        {"points": asked.points, "engine": asked.engine},
        asked.out / "verdicts.jsonl",
        partial(one, asked.points, asked.engine),
        processes=asked.processes,
        warm=partial(one, 100, asked.engine, 0),
    )
    print(text(rows))  # noqa: T201


if __name__ == "__main__":
    main()
