"""Random trains against the 50-digit reference.

Run with ``python -m benchmarks.random_trains --count 5000 --seed 1 [--processes 2]``, or with
``--stress`` for the problems of the stability map instead. It may be stopped at any time; the same
command goes on where it was. Tables are over all trains of the seed that are on file.
"""

from __future__ import annotations

from benchmarks import kept
from benchmarks.random_trains.run import PROBLEMS, STRESS, run, write_failures
from benchmarks.random_trains.table import text


def main() -> None:
    """Draw, judge, tell."""
    about = "Random trains against the 50-digit reference."
    parser = kept.parser(about, "trains", 5000, "random_trains")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--stress", action="store_true", help="the stability map's problems, all")
    asked = parser.parse_args()
    numbers = kept.numbers(asked)
    seed = asked.seed
    if asked.stress:
        seed, numbers = STRESS, range(PROBLEMS)

    rows = run(numbers, seed, asked.out / "verdicts.jsonl", asked.processes)
    count = write_failures(rows, asked.out / "failing")
    print(text(rows))  # noqa: T201
    if count:
        print(f"\n{count} trains at fault are in {asked.out / 'failing'}.")  # noqa: T201


if __name__ == "__main__":
    main()
