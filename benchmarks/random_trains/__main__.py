"""Random trains against the 50-digit reference.

Run with ``python -m benchmarks.random_trains --count 5000 --seed 1 [--processes 2]``, or with
``--stress`` for the problems of the stability map instead. It may be stopped at any time; the same
command continues it. Tables cover all trains of the seed that are on file.
"""

from __future__ import annotations

from benchmarks import kept
from benchmarks.random_trains.run import LOOPED, PROBLEMS, SETS, STRESS, run, write_failures
from benchmarks.random_trains.table import text

ABOUT = """# Random trains

How often is an answer wrong, or refused without need? Random trains, which no one chose, are solved
at every position and compared with a reference in 50 digits that shares no code with solver, scene
or certificate: stars, splits and four-branch trains, double and stepped stars, idlers; both flanks,
splines, drum and round rings, linear and Hertz laws, zero clearances, collinear lines of action,
stiffness ratios up to 1e6, loads from 1e-6 to 10 times the rated one. Every torque, force and
displacement with a bound must be as near to the reference as the bound says. *Too far* means
refused because displacements are too large for the geometry in which they were found.
"""
SETS_ABOUT = """# Random planetary sets

Random planetary sets: simple, stepped, and with planets that mesh with one another; every member
held, driven and driving, floating, on splines, in rings or on elastic mounts. Every position of
each is solved and compared with a reference in 50 digits, like [random trains](random-trains.md).
"""
LOOPS_ABOUT = """# Random loops

Planetary sets are drawn as for [random planetary sets](planetary-sets.md), none of whose members is
held: a layshaft joins one to the input or the output, in either sense, so that the power goes round
in a loop. Every position is solved and compared with a reference in 50 digits.
"""
MAP = """# Stability map in 50 digits

The problems of the [stability map](stability.md), {count} of {problems}, each compared with a
reference in 50 digits. Some problems with 64 branches take minutes.
"""


def main() -> None:
    """Draw, judge, report."""
    about = "Random trains against the 50-digit reference."
    parser = kept.parser(about, "trains", 5000, "random_trains")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--stress", action="store_true", help="all problems of the stability map")
    parser.add_argument("--planetary", action="store_true", help="planetary sets")
    parser.add_argument("--loops", action="store_true", help="planetary sets with a loop")
    options = parser.parse_args()
    numbers = kept.numbers(options)
    seed = SETS - options.seed if options.planetary else options.seed
    if options.loops:
        seed = LOOPED - options.seed
    if options.stress:
        seed, numbers = STRESS, range(PROBLEMS)

    rows = run(numbers, seed, options.out / "verdicts.jsonl", options.processes)
    count = write_failures(rows, options.out / "failing")
    words = "--stress" if options.stress else f"--count {len(rows)} --seed {options.seed}"
    about = MAP.format(count=len(rows), problems=PROBLEMS) if options.stress else ABOUT
    if options.planetary:
        words, about = f"{words} --planetary", SETS_ABOUT
    if options.loops:
        words, about = f"{words} --loops", LOOPS_ABOUT
    kept.publish(options.page, about, f"benchmarks.random_trains {words}", text(rows))
    if count:
        print(f"\n{count} trains at fault are in {options.out / 'failing'}.")  # noqa: T201


if __name__ == "__main__":
    main()
