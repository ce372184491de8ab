"""Lists per position must be as long as the mesh cycle."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.keys import Path
from loadshare.case.words import count
from loadshare.errors import Problem


def check_list_lengths(draft: Draft) -> Iterator[Problem]:
    """Yield lists whose length is neither 1 nor the number of positions."""
    if draft.operating is None:
        return
    positions = draft.operating.positions
    for path, length in _lists(draft):
        if length not in (1, positions):
            message = f"has {count(length)}, operating.positions is {positions}"
            yield draft.problem(path, message, f"1 value or {positions}")


def _lists(draft: Draft) -> Iterator[tuple[Path, int]]:
    fields: list[tuple[Path, object]] = []
    if draft.operating is not None:
        fields += [
            (("operating", key), getattr(draft.operating, key)) for key in ("torque", "power")
        ]
    for name, mesh in draft.meshes.items():
        here: Path = ("meshes", name)
        fields += [((*here, key), getattr(mesh, key)) for key in ("stiffness", "gap")]
        if mesh.law is not None:
            fields += [((*here, "law", key), getattr(mesh.law, key)) for key in "abc"]
        if mesh.table is not None:
            fields.append(((*here, "table", "deflection"), mesh.table.curves))
    for path, value in fields:
        if isinstance(value, tuple):
            yield path, len(value)
