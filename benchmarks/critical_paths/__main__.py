"""Critical values of random paths against dense scans: events that are missed, invented, or raise.

Run with ``python -m benchmarks.critical_paths [--count N] [--points N] [--processes N]``. Every
path is a random train (stars and split-torque trains with rings, splines, backlash, Hertz contact,
tabulated laws, errors, elastic shafts and bearings) along one to three inputs that take the same
value. Its events are compared with the states of all elements in a scan by the batch path; the scan
determines these states from forces and displacements alone. A path with another end must give the
same events. The run may be stopped at any time; the same command continues it.
"""

from __future__ import annotations

from functools import partial

from benchmarks import kept
from benchmarks.critical_paths.judge import one
from benchmarks.critical_paths.table import text

ABOUT = """# Critical values against scans

Does `critical` find every event, and only real ones? Random trains (stars and split-torque trains
with rings, splines, backlash, Hertz contact, tabulated laws, errors, elastic shafts and bearings)
are followed along one to three inputs that take the same value. The events are compared with the
states of all elements in dense scans, solved as a batch; a range with another end must give the
same events.
"""


def main() -> None:
    """Judge many paths and print a Markdown table."""
    parser = kept.parser("Critical values against dense scans.", "paths", 500, "critical_paths")
    parser.add_argument("--points", type=int, default=100_000, help="number of points of a scan")
    parser.add_argument("--engine", default="compiled")
    options = parser.parse_args()
    rows = kept.run(
        kept.numbers(options),
        {"points": options.points, "engine": options.engine},
        options.out / "verdicts.jsonl",
        partial(one, options.points, options.engine),
        processes=options.processes,
        warm=partial(one, 100, options.engine, 0),
    )
    words = f"benchmarks.critical_paths --count {len(rows)} --points {options.points}"
    kept.publish(options.page, ABOUT, words, text(rows))


if __name__ == "__main__":
    main()
