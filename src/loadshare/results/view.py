"""The views of a result and of a position in a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

from loadshare.table import text_table
from loadshare.view import View, by_name, figure, listed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from loadshare.certify import Certificate, FloatState
    from loadshare.results.result import Position, Result
    from loadshare.train.equilibrium import Equilibrium


def result_view(result: Result) -> View:
    """Show how good an answer is, how load is shared, where floats rest, and the torques."""
    stamp, requested = result.stamp, len(result.stamp.positions)
    done = sum(p.certificate.passed for p in result.positions)
    facts = (
        ("title", stamp.title),
        (
            "certified",
            f"{done} of {requested} positions, worst residual {result.certificate.worst:.1e}",
        ),
        ("largest Ω over the stage", by_name(result.omega)),
        ("largest Ω over the group", by_name(result.pair_omega)),
        ("floats, first position", _floats(result.floats[0] if result.floats else {})),
    )
    rows = []
    for mesh in result.positions[0].torque:
        torques = [p.torque[mesh] for p in result.positions]
        shares = [s for p in result.positions if (s := p.share.get(mesh)) is not None]
        largest = figure(max(shares, default=None), ".4f")
        rows.append((mesh, figure(min(torques), ".2f"), figure(max(torques), ".2f"), largest))
    columns = ("mesh", "least torque [N·m]", "largest torque [N·m]", "largest Ω")
    made = text_table("Torque on the driver of every mesh", columns, rows, words=("mesh",))
    return View(f"Result of {stamp.case}", facts, (made,))


def position_view(found: Position) -> View:
    """Show how good a position's answer is, where floats rest, and how load is shared."""
    facts = rest_facts(found.certificate, found.equilibrium)
    rows = (
        (
            mesh,
            figure(torque, ".2f"),
            figure(found.share.get(mesh), ".4f"),
            figure(found.pair_share.get(mesh), ".4f"),
        )
        for mesh, torque in found.torque.items()
    )
    columns = ("mesh", "torque [N·m]", "Ω over the stage", "Ω over the group")
    made = text_table("Torque on the driver of every mesh", columns, rows, words=("mesh",))
    return View(f"Position {found.position}", facts, (made,))


def rest_facts(certificate: Certificate, found: Equilibrium) -> tuple[tuple[str, str], ...]:
    """Return how good an answer is, where its floats rest, and what forces leave open."""
    verdict = "certified" if certificate.passed else "not certified"
    return (
        (verdict, f"worst residual {certificate.worst:.1e}"),
        ("floats", _floats(certificate.floats)),
        ("undetermined", listed(tuple(found.undetermined))),
    )


def _floats(rests: Mapping[str, FloatState]) -> str:
    return ", ".join(f"{gear} {rest.boundary or rest.state}" for gear, rest in rests.items())
