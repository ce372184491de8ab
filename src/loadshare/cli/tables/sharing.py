"""Load sharing: the torque that every mesh carries, and its coefficients."""

from __future__ import annotations

from typing import Literal

from rich.table import Table

from loadshare.cli.console import say_all
from loadshare.cli.tables.table import fits, show, texts
from loadshare.report import records
from loadshare.report.numbers import NONE, fixed
from loadshare.results import Result

MOST = 6
"""Positions that are shown side by side."""


def print_sharing(result: Result) -> None:
    """Print the torque of every mesh: alike everywhere, position by position, or summed up."""
    alike, count = records.alike(result), len(result.positions)
    shown = _table(result, "alike" if alike else "each")
    if not alike and (count > MOST or not fits(shown)):
        shown = _table(result, "summed")
    show("Load sharing: torque on the driver [N·m]", shown)
    notes = []
    if count > 1:
        notes.append(
            "The same at all positions." if alike else "Ω is the largest over the positions."
        )
    if NONE in shown.columns[-1].cells:
        notes.append(f"{NONE}: not in a stage, or without load.")
    say_all([*notes, *_coast(result)])


def _table(result: Result, columns: Literal["alike", "each", "summed"]) -> Table:
    rows = list(records.torques(result, columns))
    return texts(rows, {field: field for field in rows[0]}, words=("stage", "mesh"))


def _coast(result: Result) -> list[str]:
    """Say which meshes are squeezed: both their flanks carry load."""
    places = records.torque_places(result)
    most = {
        mesh: max(p.coast_torque[mesh] for p in result.positions)
        for mesh in result.positions[0].torque
    }
    return [
        f"Mesh {mesh}: the coast flank carries up to {fixed(torque, places)} N·m; "
        "the torque is the difference."
        for mesh, torque in most.items()
        if torque > 0.0
    ]
