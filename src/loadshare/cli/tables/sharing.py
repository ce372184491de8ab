"""Load sharing: the torque that every mesh carries, and its coefficients."""

from __future__ import annotations

import math

from rich.console import Console
from rich.table import Table

from loadshare.cli.tables.table import fits, show, table
from loadshare.report.numbers import NONE, decimals, fixed, omega
from loadshare.results import Result

MOST = 6
"""Positions that are shown side by side."""


def print_sharing(console: Console, result: Result) -> None:
    """Print the torque of every mesh: alike everywhere, position by position, or summed up."""
    places = decimals(t for p in result.positions for t in p.torque.values())
    texts = [[fixed(t, places) for t in p.torque.values()] for p in result.positions]
    alike = all(text == texts[0] for text in texts)
    shown = _alike(result, places) if alike else _each(result, places)
    if not alike and (len(texts) > MOST or not fits(console, shown)):
        shown = _summed(result, places)
    show(console, "Load sharing: torque on the driver [N·m]", shown)
    notes = []
    if len(texts) > 1:
        notes.append(
            "The same at all positions." if alike else "Ω is the largest over the positions."
        )
    if NONE in shown.columns[-1].cells:
        notes.append(f"{NONE}: not in a stage, or without load.")
    notes += _coast(result, places)
    for note in notes:
        console.print(note)


def _alike(result: Result, places: int) -> Table:
    made = _table(("torque",))
    first = result.positions[0]
    for mesh, torque in first.torque.items():
        made.add_row(*_named(result, mesh), fixed(torque, places), *_coefficients(result, mesh))
    return made


def _each(result: Result, places: int) -> Table:
    made = _table(tuple(f"at {p.position}" for p in result.positions))
    for mesh in result.positions[0].torque:
        torques = [fixed(p.torque[mesh], places) for p in result.positions]
        made.add_row(*_named(result, mesh), *torques, *_coefficients(result, mesh))
    return made


def _summed(result: Result, places: int) -> Table:
    made = _table(("least", "mean", "most"))
    for mesh in result.positions[0].torque:
        torques = [p.torque[mesh] for p in result.positions]
        mean = math.fsum(torques) / len(torques)
        summary = [fixed(v, places) for v in (min(torques), mean, max(torques))]
        made.add_row(*_named(result, mesh), *summary, *_coefficients(result, mesh))
    return made


def _table(torques: tuple[str, ...]) -> Table:
    return table(("stage", "mesh", *torques, "Ω stage", "Ω pair"), words=("stage", "mesh"))


def _named(result: Result, mesh: str) -> tuple[str, str]:
    return ", ".join(s for s, meshes in result.stages.items() if mesh in meshes), mesh


def _coefficients(result: Result, mesh: str) -> tuple[str, str]:
    def largest(shares: list[float | None]) -> str:
        return omega(max((s for s in shares if s is not None), default=None))

    positions = result.positions
    return largest([p.share.get(mesh) for p in positions]), largest(
        [p.pair_share.get(mesh) for p in positions]
    )


def _coast(result: Result, places: int) -> list[str]:
    """Say which meshes are squeezed: both their flanks carry load."""
    notes = []
    for mesh in result.positions[0].torque:
        most = max(p.coast_torque[mesh] for p in result.positions)
        if most > 0.0:
            notes.append(
                f"Mesh {mesh}: the coast flank carries up to {fixed(most, places)} N·m; "
                "the torque is the difference."
            )
    return notes
