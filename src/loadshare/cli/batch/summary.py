"""What became of all cases: a table to read, and a file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from loadshare._version import __version__
from loadshare.cli.batch.work import GOOD, Outcome
from loadshare.cli.console import say

STYLES = {"certified": "green", "kept": "green"}


def print_summary(outcomes: Sequence[Outcome]) -> None:
    """Print one row per case, and below what went wrong."""
    from rich.text import Text

    from loadshare.cli.tables.table import show, table
    from loadshare.report.numbers import NONE, omega, small

    made = table(
        ("case", "outcome", "positions", "Ω system", "worst residual", "seconds"),
        words=("case", "outcome"),
    )
    for done in outcomes:
        made.add_row(
            done.name,
            Text(done.outcome, style=STYLES.get(done.outcome, "bold red")),
            str(done.positions),
            omega(done.omega),
            NONE if done.worst is None else small(done.worst),
            f"{done.seconds:.2f}",
        )
    show("Cases", made)
    for done in outcomes:
        for message in done.messages:
            say(f"{done.name}: {done.outcome}: {message}", whole=True)
    say(counts(outcomes))


def counts(outcomes: Sequence[Outcome]) -> str:
    """Return how many cases came to which outcome, in words."""
    found = Counter(done.outcome for done in outcomes)
    text = ", ".join(f"{number} {outcome}" for outcome, number in found.most_common())
    return f"{len(outcomes)} cases: {text}" if len(outcomes) != 1 else f"1 case: {text}"


def summary_document(
    outcomes: Sequence[Outcome], settings: dict[str, Any], waiting: Sequence[str]
) -> dict[str, Any]:
    """Return the summary as plain data.

    Parameters
    ----------
    outcomes : sequence of Outcome
    settings : dict
        Solver, method, tolerance.
    waiting : sequence of str
        Cases that an interruption left undone.
    """
    cases = []
    for done in outcomes:
        record = asdict(done)
        message = "\n".join(record.pop("messages"))
        cases.append(record | {"message": message})
    return {
        "version": __version__,
        **settings,
        "passed": not waiting and all(done.outcome in GOOD for done in outcomes),
        "counts": dict(Counter(done.outcome for done in outcomes)),
        "cases": cases,
        "not_done": list(waiting),
    }
