"""What a tolerance study shows: how Ω scatters, which inputs that comes from, the worst case."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from loadshare.numbers import NONE, counted, decimals, fixed
from loadshare.settings import TOLERANCE
from loadshare.table import Cell, Table, text_table
from loadshare.view import View

if TYPE_CHECKING:
    from loadshare.study.tolerance.result import Tolerance
    from loadshare.study.tolerance.statistics import OmegaStatistics, Summary

SHOWN = 20
"""Number of inputs that a screen shows."""
INTERVALS = f"Intervals in brackets: {100.0 * TOLERANCE.confidence:g} %."


def tolerance_view(found: Tolerance) -> View:
    """Show how Ω scatters, where that comes from, what meshes and floats do, and the worst case."""
    settings = found.settings
    facts = (
        (
            "samples",
            f"{found.samples:,} {settings['sampling']} samples, seed {settings['seed']}, "
            f"{counted(len(settings['positions']), 'position')}, "
            f"largest residual {found.residual:.1e}",
        ),
        ("certified", f"{found.samples - found.refused} of {found.samples} samples"),
        ("why refused", "; ".join(f"{n} × {m}" for m, n in found.messages.items())),
    )
    scatter = [(drawn.name, str(drawn.distribution)) for drawn in found.inputs.every]
    heads = ("input", "scatters")
    shown = [one for one in found.omega if one.over in found.overs]
    tables = (
        *(omega_tables(shown, found.limit) if shown else ()),
        *_share_tables(shown),
        *_other_tables(found),
        *_worst_tables(found),
        _first_inputs(text_table("Inputs", heads, scatter, heads)),
    )
    return View(f"Tolerance study of {found.case}", facts, tables)


def _first_inputs(made: Table) -> Table:
    """Return a table of inputs of which a screen shows the first."""
    return replace(made, most=SHOWN)


def omega_tables(every: Sequence[OmegaStatistics], limit: float | None) -> Iterator[Table]:
    """Yield the figures of the largest Ω of each stage and of the system, and its quantiles.

    Parameters
    ----------
    every : sequence of OmegaStatistics
    limit : float or None
        Ω that should not be exceeded.
    """
    figures, quantiles = [], []
    for one in every:
        name = Cell(f"{one.stage}, group" if one.over == "group" else one.stage)
        found = one.summary
        above = NONE if one.exceedance is None else one.exceedance.text(".3g")
        figures.append(
            (
                name,
                Cell(found.mean.text(".4f"), found.mean.value),
                Cell(f"{found.spread:.2g}", found.spread),
                Cell(f"{found.highest:.5f}", found.highest),
                *([] if limit is None else [Cell(above)]),
            )
        )
        values = (Cell(f"{q.value:.5f}", q.value) for q in found.quantiles.values())
        quantiles.append((name, *values))
    exceeds = [] if limit is None else [f"P(Ω > {limit:g})"]
    heads: tuple[str, ...] = ("Ω", "mean", "deviation", "largest", *exceeds)
    title = "Largest Ω over branches and positions"
    yield text_table(title, heads, figures, heads[:1], [INTERVALS])
    heads = ("Ω", *(f"{100 * level:g} %" for one in every[:1] for level in one.summary.quantiles))
    yield text_table("Its quantiles", heads, quantiles, heads[:1])


def _share_tables(every: Iterable[OmegaStatistics]) -> Iterator[Table]:
    """Yield the shares of the variance of Ω of the system, largest first."""
    heads = ("input", "alone", "with interactions")
    for one in every:
        if one.stage == "system" and one.shares:
            rows = (
                (
                    Cell(share.unit),
                    *(Cell(e.text(".3f"), e.value) for e in (share.first, share.total)),
                )
                for share in sorted(one.shares, key=lambda share: -share.total.value)
            )
            title = f"Shares of the variance of Ω of the system, by the mean of the {one.over}"
            yield _first_inputs(text_table(title, heads, rows, heads[:1]))


def _other_tables(found: Tolerance) -> Iterator[Table]:
    """Yield the torques of the meshes and the displacements of the floats."""
    figures = ("mean", "deviation", "smallest", "largest")
    cells = _cells(found.torque.values())
    rows = [(Cell(mesh), *cells(torque)) for mesh, torque in found.torque.items()]
    title = "Largest driver torque over positions [N·m]"
    yield text_table(title, ("mesh", *figures), rows, ("mesh",))
    if found.floats:
        cells = _cells((f.way for f in found.floats), 1e6)
        rows = [
            (
                Cell(f.gear),
                *cells(f.way),
                Cell(NONE if f.pressed is None else f"{100 * f.pressed:.4g} %", f.pressed),
            )
            for f in found.floats
        ]
        heads = ("float", *figures, "on its boundary")
        title = "Largest displacement of floats over positions [µm]"
        yield text_table(title, heads, rows, heads[:1])


def _cells(every: Iterable[Summary], factor: float = 1.0) -> Callable[[Summary], list[Cell]]:
    """Return a function for the cells of a summary; all figures have as many decimals."""
    places = decimals(factor * of.highest for of in every)

    def cells(of: Summary) -> list[Cell]:
        values = (factor * v for v in (of.mean.value, of.spread, of.lowest, of.highest))
        return [Cell(fixed(value, places), value) for value in values]

    return cells


def _worst_tables(found: Tolerance) -> Iterator[Table]:
    heads = ("input", "value", "of its tolerance")
    for one in found.worst:
        rows = (
            (
                Cell(d.name),
                Cell(f"{one.inputs[d.name]:.6g} {d.distribution.unit}".strip(), one.inputs[d.name]),
                Cell(one.at[d.name]),
            )
            for d in found.inputs.every
        )
        yield text_table(
            f"Worst case found within the tolerances: Ω = {one.omega:.5f} "
            f"by the mean of the {one.over}",
            heads,
            rows,
            words=("input", "of its tolerance"),
            notes=[f"Certified; the largest of {one.solved:,} trials, there may be a worse case"],
        )
