"""What a console and a notebook show of an answer, a programme and a search."""

from __future__ import annotations

from typing import TYPE_CHECKING

from loadshare.results.view import rest_facts
from loadshare.settings import JOB
from loadshare.table import text_table
from loadshare.view import View, figure, listed

if TYPE_CHECKING:
    from loadshare.job.answer import Answer
    from loadshare.job.formulation import Formulation
    from loadshare.job.search import Search


def answer_view(found: Answer) -> View:
    """Show how an answer was found, how good it is, where floats rest, and the forces."""
    facts = (("found by", found.rung), *rest_facts(found.certificate, found.equilibrium))
    forces = {**found.equilibrium.flank_force, **found.equilibrium.ring_force}
    rows = ((name, figure(force)) for name, force in forces.items() if force > 0.0)
    made = text_table("Forces", ("contact", "force [N]"), rows, words=("contact",))
    return View(f"Answer of position {found.index}", facts, (made,))


def formulation_view(found: Formulation) -> View:
    """Show what a programme holds, its units, and what is not in it."""
    programme, units = found.programme, found.units
    facts = (
        ("programme", programme.kind),
        ("coordinates", f"{len(programme.coordinates)}: {listed(programme.coordinates)}"),
        ("contacts", f"{len(programme.names)}: {listed(programme.names)}"),
        ("radial elements", listed([cone.name for cone in programme.cones])),
        ("units", f"{units.force:.6g} N, {units.length:.6g} m"),
    )
    title = f"Formulation of position {found.answer.index}"
    heads = ("left out", "why")
    return View(title, facts, (text_table("Left out", heads, found.removed, words=heads),))


def search_view(found: Search) -> View:
    """Show how far a search went, and by how much other answers differ from the known one."""
    known = found.answer.equilibrium
    facts = (
        ("other answers", str(len(found.others))),
        ("starts", f"{found.starts} of {JOB.starts} random starts were certified"),
        ("path from generous clearance", found.way),
    )
    rows = []
    for number, other in enumerate(found.others, start=1):
        pairs = ((known.flank_force, other.flank_force), (known.ring_force, other.ring_force))
        apart = {name: b[name] - a[name] for a, b in pairs for name in a}
        most = max(apart, key=lambda name: abs(apart[name]))
        rows.append((str(number), most, f"{apart[most]:+.4g}"))
    columns = ("answer", "most changed contact", "change [N]")
    made = text_table("Other answers", columns, rows, words=columns[1:2])
    return View(f"Search at position {found.answer.index}", facts, (made,))
