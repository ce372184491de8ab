"""Writing a chart: PNG, SVG and an interactive page that needs no network."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

INK, PALE = "#222222", "#dddddd"


def altair() -> Any:
    """Return altair, which is imported only for drawing."""
    return import_module("altair")


def styled(chart: Any) -> Any:
    """Return a chart in the style of the evidence: quiet grid, readable type."""
    return (
        chart.configure_axis(gridColor="#ececec", labelColor=INK, titleColor=INK, domainColor=INK)
        .configure_view(stroke=PALE)
        .configure_legend(labelColor=INK, titleColor=INK, symbolSize=90, labelLimit=220)
        .configure_title(color=INK, anchor="start", fontSize=13)
    )


def write(chart: Any, stem: Path) -> list[Path]:
    """Write ``stem.png``, ``stem.svg`` and ``stem.html``.

    Returns
    -------
    list of pathlib.Path
        The files.
    """
    files = [stem.with_suffix(f".{kind}") for kind in ("png", "svg", "html")]
    chart.save(str(files[0]), scale_factor=2.0)
    chart.save(str(files[1]))
    # Inline: the page contains its scripts and opens without a network.
    chart.save(str(files[2]), inline=True)
    return files
