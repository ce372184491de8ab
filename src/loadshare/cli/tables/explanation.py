"""How one position was solved."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console
from rich.table import Table

from loadshare.cli.exits import counted
from loadshare.cli.tables.table import show, table
from loadshare.job.ladder import Answer
from loadshare.report.numbers import NONE, fixed, small
from loadshare.report.undetermined import range_told
from loadshare.scene.plan import Role
from loadshare.solver import Record


def print_explanation(console: Console, index: int, answer: Answer | None) -> None:
    """Print everything that is known of how a position was solved.

    Parameters
    ----------
    console : Console
    index : int
        1-based position.
    answer : Answer or None
        None if no rung gave a certified answer.
    """
    console.print(f"\nHow position {index} was solved", style="bold")
    if answer is None:
        console.print("It was not: no rung of the ladder gave a certified answer.")
        return
    record = answer.record
    _print_facts(console, answer)
    _print_in_play(console, answer)
    if record.iterations:
        _print_passes(console, record)
    _print_removed(console, record)


def _print_facts(console: Console, answer: Answer) -> None:
    record = answer.record
    passes, plans = counted(len(record.iterations), "iteration"), counted(record.rounds, "plan")
    if record.iterations:
        how = {
            "solved by": ", then ".join(dict.fromkeys(i.via for i in record.iterations)),
            "outer loop": f"{record.method}, {passes}; {plans} tried",
        }
    else:
        sets = counted(record.rounds, "set")
        how = {"solved by": f"Newton's method on the acting elements; {sets} tried"}
    facts = {
        "rung": answer.rung,
        "programme": f"{record.kind}, {counted(len(record.coordinates), 'coordinate')}",
        **how,
        "coordinates": ", ".join(record.coordinates),
        "undetermined": "; ".join(
            f"{name} {range_told(name, *ends)}"
            for name, ends in answer.equilibrium.undetermined.items()
        )
        or "none",
    }
    made = Table.grid(padding=(0, 2))
    for fact, told in facts.items():
        made.add_row(fact, told)
    console.print(made)


def _print_in_play(console: Console, answer: Answer) -> None:
    plan, found = answer.record.plan, answer.equilibrium
    forces: Mapping[str, float] = {**found.flank_force, **found.ring_force}
    rows = [name for name, role in plan.rows.items() if role is Role.IN_PLAY]
    radials = [name for name, role in plan.radials.items() if role is Role.IN_PLAY]
    if not rows and not radials:
        console.print(
            "\nNo inequality is left in play: the answer is one linear solve an iteration."
        )
        return
    made = table(("element", "force [N]"), words=("element",))
    for name in rows:
        made.add_row(name, fixed(forces[name], 3) if name in forces else NONE)
    for name in radials:
        reaction = found.radial_reaction[name]
        made.add_row(name, fixed(float(reaction @ reaction) ** 0.5, 3))
    show(console, "In play" if answer.record.iterations else "Acting", made)


def _print_passes(console: Console, record: Record) -> None:
    made = table(
        ("iteration", "programme", "solved by", "laws", "faces", "friction", "step"),
        words=("programme", "solved by"),
    )
    for number, done in enumerate(record.iterations, start=1):
        misfits = [small(v) for v in (done.law, done.face, done.friction)]
        made.add_row(str(number), done.kind, done.via, *misfits, f"{done.step:.3g}")
    show(
        console,
        "Outer loop: misfit of laws and faces [deflections], of friction bounds [loads]",
        made,
    )


def _print_removed(console: Console, record: Record) -> None:
    if not record.removed:
        console.print("\nNothing was left out.")
        return
    made = table(("what", "why"), words=("what", "why"))
    for what, why in record.removed:
        made.add_row(what, why)
    show(console, "Left out, and why that changes nothing", made)
