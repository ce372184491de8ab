"""The figures of the graphics processor as a page and a chart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks import drawing

CORE, DEVICE, MOVED = "a core", "the device", "moving to the device and back"
COLOURS = {CORE: "#b30000", DEVICE: "#3182bd", MOVED: "#9ecae1"}
TEXT = """# The fast method on a graphics processor

One thread of the device owns one sample: it visits a set, judges the signs, looks the next set up
among those that are prepared and goes on there, until every sign is right. The code is that of
`loadshare.solver.hot.kernel`, which Numba compiles for CUDA with a width of one and with what a
thread works on in local memory; a set that is not prepared is asked for, and the host prepares it
and calls again. Beside it, `exchange` with the compiled engine on one core of the same machine.
Both begin on the sets that the linear rule names. All positions of a sample count. Times are
medians of three runs, every set prepared; the device's are those of its own clock. *Moving* takes
gaps, loads, laws and roots to the device and brings forces, coordinates and sets back.

What a batch does besides is in neither: gaps from samples, certificate, bound, tables. `exchange`
takes a half to three quarters of a batch on the seed's train, and a tenth to a sixth with eight
branches. So a device that does this part alone would make batches two to four times faster at best,
and those of many branches hardly; the certificate, which goes claim by claim in a workspace of
fixed size, would have to follow.

Measured by `python -m benchmarks.graphics`, drawn by the same with `--draw`.

![Time of an equilibrium](graphics.svg)

{table}
Forces on one set, over the largest, differ by what the laws are settled to. Sets differ where a
contact is on the verge. What neither settles is left to NumPy and the methods below it, as always.
Samples are sorted by the sets on which they begin.

{facts}"""


def write(figures: Mapping[str, Any], folder: Path) -> list[Path]:
    """Write the page and its chart; return the files."""
    rows: Sequence[Mapping[str, Any]] = figures["rows"]
    lines = [
        "| workload | core [µs] | device [µs] | ratio | moving [µs] | sets | visits | settled by "
        "the device, by the core | by both on one set | forces differ by |",
        "|" + "---|" * 10,
        *map(_line, rows),
    ]
    facts = "\n".join(f"| {name} | {value} |" for name, value in figures["facts"].items())
    page = folder / "graphics.md"
    page.write_text(
        TEXT.format(table="\n".join(lines) + "\n", facts=f"| | |\n|---|---|\n{facts}\n"),
        encoding="utf-8",
    )
    chart = folder / "graphics.svg"
    _drawn(rows).save(str(chart))
    return [page, chart]


def _line(row: Mapping[str, Any]) -> str:
    """Return the row of the table for a workload."""
    return (
        f"| {row['title']} | {row['core']:.2f} | {row['device']:.3f} "
        f"| {row['core'] / row['device']:.0f} | {row['moved']:.3f} | {row['sets']} "
        f"| {row['visits']:.2f} | {row['settled']:,}, {row['settled_by_core']:,} "
        f"| {row['alike']:,} | {row['worst']:.1e} |"
    )


def _drawn(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Draw the three times of every workload on a logarithmic axis."""
    alt = drawing.altair()
    values = [
        {"workload": row["title"], "where": where, "time": row[name]}
        for row in rows
        for where, name in ((CORE, "core"), (DEVICE, "device"), (MOVED, "moved"))
    ]
    marks = alt.Chart(alt.Data(values=values), width=520, height=26 * len(rows))
    return drawing.styled(
        marks.mark_point(filled=True, size=90, opacity=1.0).encode(
            x=alt.X(
                "time:Q",
                title="µs per equilibrium",
                scale=alt.Scale(type="log", domain=[0.01, 10.0]),
                axis=alt.Axis(values=[0.01, 0.1, 1.0, 10.0], format="~g"),
            ),
            y=alt.Y("workload:N", title=None, sort=None, axis=alt.Axis(grid=True, labelLimit=220)),
            color=alt.Color(
                "where:N",
                title=None,
                sort=list(COLOURS),
                scale=alt.Scale(domain=list(COLOURS), range=list(COLOURS.values())),
                legend=alt.Legend(orient="top"),
            ),
            shape=alt.Shape("where:N", sort=list(COLOURS), legend=None),
        )
    )
