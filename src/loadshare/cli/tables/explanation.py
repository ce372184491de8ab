"""The explanation of how one position was solved."""

from __future__ import annotations

from collections.abc import Mapping

from rich.table import Table

from loadshare.cli.console import say
from loadshare.cli.tables.table import show, table
from loadshare.contact.plan import Role
from loadshare.job.answer import Answer
from loadshare.numbers import counted, fixed, small
from loadshare.report.words import range_text
from loadshare.solver import Record


def print_explanation(index: int, answer: Answer | None) -> None:
    """Print everything that is known about how a position was solved.

    Parameters
    ----------
    index : int
        1-based position.
    answer : Answer or None
        None if no rung gave a certified answer.
    """
    say(f"\nHow position {index} was solved", style="bold")
    if answer is None:
        say("It was not solved: no method gave a certified answer.")
        return
    record = answer.record
    _print_facts(answer)
    _print_in_play(answer)
    if record.iterations:
        _print_passes(record)
    _print_removed(record)


def _print_facts(answer: Answer) -> None:
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
            f"{name} {range_text(name, *ends)}"
            for name, ends in answer.equilibrium.undetermined.items()
        )
        or "none",
    }
    made = Table.grid(padding=(0, 2))
    for fact, text in facts.items():
        made.add_row(fact, text)
    say(made)


def _print_in_play(answer: Answer) -> None:
    plan, found = answer.record.plan, answer.equilibrium
    forces: Mapping[str, float] = {**found.flank_force, **found.ring_force}
    rows = [name for name, role in plan.rows.items() if role is Role.IN_PLAY]
    radials = [name for name, role in plan.radials.items() if role is Role.IN_PLAY]
    if not rows and not radials:
        say("\nNo inequality is in play: each iteration is one linear solve.")
        return
    shown = {name: forces.get(name) for name in rows}
    for name in radials:
        reaction = found.radial_reaction[name]
        shown[name] = float(reaction @ reaction) ** 0.5
    acting = ((name, fixed(force, 3)) for name, force in shown.items())
    title = "In play" if answer.record.iterations else "Acting"
    show(title, table(("element", "force [N]"), acting, words=("element",)))


def _print_passes(record: Record) -> None:
    heads = ("iteration", "programme", "solved by", "laws", "faces", "friction", "step")
    rows = (
        (
            *(str(number), i.kind, i.via),
            *(small(v) for v in (i.law, i.face, i.friction)),
            f"{i.step:.3g}",
        )
        for number, i in enumerate(record.iterations, start=1)
    )
    show(
        "Outer loop: misfit of laws and faces [deflections], of friction bounds [loads]",
        table(heads, rows, words=("programme", "solved by")),
    )


def _print_removed(record: Record) -> None:
    if not record.removed:
        say("\nNothing was left out.")
        return
    heads = ("what", "why")
    show("Left out, and why that changes nothing", table(heads, record.removed, words=heads))
