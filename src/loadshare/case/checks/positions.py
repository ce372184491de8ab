"""Lists per position must be as long as the mesh cycle, loads as long as what is solved."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.keys import Path
from loadshare.case.operation import Operating
from loadshare.case.words import count
from loadshare.errors import Problem

Fields = list[tuple[Path, object]]


def check_list_lengths(draft: Draft) -> Iterator[Problem]:
    """Yield lists whose length is neither 1 nor the number of positions, or of a march's steps."""
    if draft.operating is None:
        return
    cycle = ("operating.positions", draft.operating.positions)
    solved = cycle if draft.march is None else ("march.steps", draft.march.steps)
    yield from _wrong(draft, _loads(draft.operating), *solved)
    yield from _wrong(draft, _laws(draft), *cycle)


def _wrong(draft: Draft, fields: Fields, key: str, needed: int) -> Iterator[Problem]:
    for path, value in fields:
        if isinstance(value, tuple) and len(value) not in (1, needed):
            message = f"has {count(len(value))}, {key} is {needed}"
            yield draft.problem(path, message, f"1 value or {needed}")


def _loads(operating: Operating) -> Fields:
    return [(("operating", key), getattr(operating, key)) for key in ("torque", "power")]


def _laws(draft: Draft) -> Fields:
    fields: Fields = []
    for name, mesh in draft.meshes.items():
        here: Path = ("meshes", name)
        fields += [((*here, key), getattr(mesh, key)) for key in ("stiffness", "gap")]
        if mesh.law is not None:
            fields += [((*here, "law", key), getattr(mesh.law, key)) for key in "abc"]
        if mesh.table is not None:
            fields.append(((*here, "table", "deflection"), mesh.table.curves))
    return fields
