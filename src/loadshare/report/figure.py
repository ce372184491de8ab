"""A picture: an Altair chart that saves itself without a network."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.report.palette import FAINT, INK, SOFT
from loadshare.report.save import save_chart, svg_text

if TYPE_CHECKING:
    import altair as alt

# The first that a machine has; vl-convert brings the last but one along.
FONT = "Helvetica Neue, Helvetica, Arial, Liberation Sans, Roboto, sans-serif"

CONFIG: dict[str, Any] = {
    "background": "white",
    "font": FONT,
    "padding": 10,
    "view": {"stroke": None},
    "title": {
        "anchor": "start",
        "fontSize": 13,
        "fontWeight": 600,
        "color": INK,
        "subtitleColor": SOFT,
        "subtitleFontSize": 11,
        "offset": 8,
        # From the plot's own frame, so that the titles of neighbouring panels stand in line.
        "frame": "group",
    },
    "axis": {
        "labelColor": INK,
        "titleColor": INK,
        "titleFontWeight": "normal",
        "titleFontSize": 11,
        "labelFontSize": 10,
        "gridColor": FAINT,
        "domainColor": SOFT,
        "tickColor": SOFT,
        "labelLimit": 220,
    },
    # Every figure stands below its tick, and none runs into the next.
    "axisQuantitative": {"labelFlush": False, "labelOverlap": True, "labelSeparation": 6},
    "legend": {
        "labelColor": INK,
        "titleColor": INK,
        "titleFontWeight": "normal",
        "labelFontSize": 10,
        "titleFontSize": 11,
        "symbolSize": 60,
        "symbolStrokeWidth": 1.8,
        "labelLimit": 220,
    },
    "text": {"fontSize": 10, "color": INK},
    "concat": {"spacing": 28},
}
"""The look of all pictures."""


@dataclass(frozen=True)
class Figure:
    """A picture of a result, a case or a study.

    Attributes
    ----------
    name : str
        Short, for a file: "floats".
    chart : altair chart
        To be changed or combined like any other.
    """

    name: str
    chart: alt.TopLevelMixin

    @cached_property
    def spec(self) -> dict[str, Any]:
        """Vega-Lite specification, with the look of all pictures."""
        spec: dict[str, Any] = self.chart.to_dict()
        # Altair writes a configuration of its own, which would set other sizes.
        spec["config"] = CONFIG
        spec["datasets"] = {name: list(rows) for name, rows in spec.get("datasets", {}).items()}
        return spec

    def save(self, path: str | Path, scale: float = 2.0) -> Path:
        """Write the picture; the ending tells the format.

        Parameters
        ----------
        path : path-like
            Ending in ``.png``, ``.svg``, ``.pdf``, ``.html`` (with hover read-out, works offline)
            or ``.json`` (the Vega-Lite specification). The folder is made.
        scale : float
            Pixels of a PNG per unit of the specification.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        LoadshareError
            For any other ending.
        OSError
            If the file cannot be written.
        """
        return save_chart(self.spec, path, scale)

    def to_svg(self, prefix: str = "") -> str:
        """Return the picture as SVG text.

        Parameters
        ----------
        prefix : str
            Put before the names within it, for pictures that stand in one document.
        """
        return svg_text(self.spec, prefix)

    def _repr_mimebundle_(self, *_: object, **__: object) -> dict[str, Any]:
        """Show the picture in a notebook, which draws SVG without any extension."""
        return {"image/svg+xml": self.to_svg()}
