"""The map: methods across, families down; outcomes as colours and numbers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.drawing import INK, altair, styled, write
from benchmarks.stress.families import FAMILIES
from benchmarks.stress.run import Cell

COLOURS = {
    "certified": "#2166ac",
    "refused": "#fddbc7",
    "wrong": "#b2182b",
    "crashed": "#1a1a1a",
    "not for it": "#f4f4f4",
}
"""The order is also from dark to light in grey: certified and refused differ most."""


def draw_map(cells: Sequence[Cell], folder: Path) -> list[Path]:
    """Draw every cell as a bar of its outcomes.

    Returns
    -------
    list of pathlib.Path
        The files.
    """
    alt = altair()

    order = list(COLOURS)
    methods = list(dict.fromkeys(c.method for c in cells))
    rows, label_rows = [], []
    for cell in cells:
        title = FAMILIES[cell.family].title
        begin = 0.0
        for outcome in order:
            part = cell.counts[outcome] / cell.total
            if part:
                rows.append(
                    {
                        "method": cell.method,
                        "family": title,
                        "outcome": outcome,
                        "from": begin,
                        "to": begin + part,
                        "problems": f"{cell.counts[outcome]} of {cell.total}",
                        "how": "; ".join(cell.sentences),
                    }
                )
            begin += part
        label_rows.append({"method": cell.method, "family": title, "label": _label(cell)})
    families = [FAMILIES[f].title for f in dict.fromkeys(c.family for c in cells)]
    bars = (
        alt.Chart()
        .mark_bar(height=15)
        .encode(
            x=alt.X("from:Q", axis=None, scale=alt.Scale(domain=[0, 1])),
            x2="to:Q",
            y=alt.Y("family:N", sort=families, title=None),
            color=alt.Color(
                "outcome:N",
                scale=alt.Scale(domain=order, range=[COLOURS[o] for o in order]),
                legend=alt.Legend(title=None, orient="bottom"),
            ),
            tooltip=[alt.Tooltip(f"{f}:N") for f in ("method", "outcome", "problems", "how")],
        )
    )
    panels = []
    for k, method in enumerate(methods):
        mine = alt.Data(values=[r for r in rows if r["method"] == method])
        labels = alt.Data(values=[t for t in label_rows if t["method"] == method])
        text = (
            alt.Chart(labels)
            .mark_text(align="left", dx=3, fontSize=9, color=INK)
            .encode(y=alt.Y("family:N", sort=families), x=alt.value(102), text="label:N")
        )
        y = alt.Y("family:N", sort=families, title=None, axis=alt.Axis() if not k else None)
        panel = alt.layer(bars.properties(data=mine).encode(y=y), text)
        panels.append(panel.properties(title=method, width=100, height={"step": 20}))
    chart = alt.hconcat(*panels, spacing=52).properties(
        title=alt.Title(
            "Stability where methods fail",
            subtitle="beside each bar: certified / refused / wrong / crashed",
        )
    )
    return write(styled(chart), folder / "stability")


def _label(cell: Cell) -> str:
    counts = "/".join(str(cell.counts[o]) for o in COLOURS if o != "not for it")
    return counts if cell.counts["not for it"] < cell.total else "–"
