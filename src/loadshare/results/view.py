"""What a notebook shows of a result."""

from __future__ import annotations

from typing import TYPE_CHECKING

from loadshare.view import View, by_name, figure

if TYPE_CHECKING:
    from loadshare.results.result import Result


def result_view(result: Result) -> View:
    """Tell how good an answer is, how load is shared, where floats rest, and the torques."""
    stamp, asked = result.stamp, len(result.stamp.positions)
    done = sum(p.certificate.passed for p in result.positions)
    facts = (
        ("title", stamp.title),
        (
            "certified",
            f"{done} of {asked} positions, worst residual {result.certificate.worst:.1e}",
        ),
        ("largest Ω over the stage", by_name(result.omega)),
        ("largest Ω over the group", by_name(result.pair_omega)),
        ("floats, first position", _floats(result)),
    )
    rows = []
    for mesh in result.positions[0].torque:
        torques = [p.torque[mesh] for p in result.positions]
        shares = [s for p in result.positions if (s := p.share.get(mesh)) is not None]
        largest = figure(max(shares, default=None), ".4f")
        rows.append((mesh, figure(min(torques), ".2f"), figure(max(torques), ".2f"), largest))
    columns = ("mesh", "least torque [N·m]", "largest torque [N·m]", "largest Ω")
    return View(f"Result of {stamp.case}", facts, columns, tuple(rows))


def _floats(result: Result) -> str:
    rests = result.floats[0] if result.floats else {}
    return ", ".join(f"{gear} {rest.boundary or rest.state}" for gear, rest in rests.items())
