"""A picture: a Vega-Lite specification that saves itself without a network."""

from __future__ import annotations

import json
import os
import re
from functools import cached_property
from importlib import import_module
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.arguments import one_of
from loadshare.equality import Comparable
from loadshare.errors import LoadshareError
from loadshare.output import write_whole
from loadshare.report import converter
from loadshare.report.palette import FAINT, INK, SOFT
from loadshare.report.vega_lite import (
    OWN_LEGENDS,
    SCHEMA,
    Drawing,
    joined,
    layered,
    version,
    with_datasets,
)

if TYPE_CHECKING:
    from concurrent.futures import Future

    import altair as alt

ENDINGS = (".png", ".svg", ".pdf", ".html", ".json")
"""Endings of picture files."""
SCALES = 0.1, 10.0
"""Least and largest scale of a PNG; beyond, it has no pixel, or more than fit in memory."""
_CLIP = re.compile(r'(id="|url\(#)clip(\d+)("|\))')

# The first that the machine has is used; vl-convert brings the last but one with it.
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
        # From the plot's own frame, so that the titles of neighbouring panels line up.
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
    # Every number is written below its tick, and none runs into the next.
    "axisQuantitative": {
        "labelFlush": False,
        "labelOverlap": True,
        "labelSeparation": 6,
        # With a limit, every number would have to be measured three times.
        "labelLimit": 0,
    },
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


class Figure(Comparable):
    """A picture of a result, a case or a study.

    Parameters
    ----------
    name : str
        Short name, for a file: "floats".
    chart : altair chart or dict
        A chart, or a specification in Vega-Lite.

    Attributes
    ----------
    name : str

    Notes
    -----
    Pictures compose as Altair charts do: ``a | b`` side by side, ``a & b`` one above the other,
    ``a + b`` in one panel. The right-hand one may be an Altair chart of your own; the outcome is
    a `Figure`, with the same look and ``save``.
    """

    def __init__(self, name: str, chart: Drawing | alt.TopLevelMixin) -> None:
        self.name = name
        # Vega-Lite checks it when it draws.
        drawn = chart if isinstance(chart, dict) else chart.to_dict(validate=False)
        # Altair writes a configuration of its own, which would set other sizes.
        self._view = {key: part for key, part in drawn.items() if key not in ("$schema", "config")}

    def _said(self) -> object:
        return self.name, self._view

    @cached_property
    def chart(self) -> alt.TopLevelMixin:
        """Altair chart, to be changed or combined like any other."""
        chart: alt.TopLevelMixin = _altair().Chart.from_dict(with_datasets(self._view))
        return chart

    def __or__(self, other: Figure | alt.TopLevelMixin) -> Figure:
        """Put another picture, or any Altair chart, to the right."""
        return self._beside(other, "hconcat")

    def __and__(self, other: Figure | alt.TopLevelMixin) -> Figure:
        """Put another picture, or any Altair chart, below."""
        return self._beside(other, "vconcat")

    def __add__(self, other: Figure | alt.TopLevelMixin) -> Figure:
        """Lay another picture of one panel, or any Altair chart of one, over this one.

        Raises
        ------
        LoadshareError
            If either has several panels, which cannot be laid over one another.
        """
        views = [self._view, _figure(other)._view]
        if not all("mark" in view or "layer" in view for view in views):
            raise LoadshareError(
                f"{self.name}: a picture of several panels cannot be laid over another. Put them "
                "side by side with |, one above the other with &, or draw `to_dataframe()`"
            )
        return Figure(self.name, layered(views))

    def _beside(self, other: Figure | alt.TopLevelMixin, how: str) -> Figure:
        name = f"{self.name}_{other.name}" if isinstance(other, Figure) else self.name
        # Each keeps the colours and the legend of its own gears.
        return Figure(name, joined(how, [self._view, _figure(other)._view], resolve=OWN_LEGENDS))

    @cached_property
    def spec(self) -> dict[str, Any]:
        """Vega-Lite specification, with the look of all pictures."""
        return {"$schema": SCHEMA, "config": CONFIG, **with_datasets(self._view)}

    def save(self, path: str | Path, scale: float = 2.0) -> Path:
        """Write the picture; the ending selects the format.

        Parameters
        ----------
        path : path-like
            Ending in ``.png``, ``.svg``, ``.pdf``, ``.html`` (with hover read-out, works offline)
            or ``.json`` (the Vega-Lite specification). The folder is created.
        scale : float
            Pixels of a PNG per unit of the specification, 0.1 to 10.

        Returns
        -------
        Path
            Path of the file.

        Raises
        ------
        LoadshareError
            For any other ending.
        ValueError
            For any other scale.
        OSError
            If the file cannot be written.
        """
        path = Path(path)
        ending = path.suffix.lower()
        if ending not in ENDINGS:
            raise LoadshareError(
                f"{path}: no picture can be written with the ending {path.suffix or '(none)'!r}. "
                f"Allowed: {', '.join(ENDINGS)}"
            )
        write_whole(path, self.content(ending[1:], scale))
        return path

    def content(self, form: str, scale: float = 2.0) -> str | bytes:
        """Return the content of a file of the picture.

        Parameters
        ----------
        form : {"png", "svg", "pdf", "html", "json"}
        scale : float
            Pixels of a PNG per unit of the specification, 0.1 to 10.

        Raises
        ------
        ValueError
            For any other form or scale.
        """
        one_of("form", form, (ending[1:] for ending in ENDINGS))
        least, most = SCALES
        if not isinstance(scale, Real) or not least <= scale <= most:
            raise ValueError(f"scale {scale!r}; allowed: a number from {least:g} to {most:g}")
        if form == "svg":
            return self.to_svg()
        if form == "html":
            # The page writer of vl-convert leaves texts of the specification unescaped.
            from loadshare.report.page.offline import render

            title = self.spec.get("title", "")
            text = title["text"] if isinstance(title, dict) else title
            return render("figure.html", title=text, spec=self.spec)
        if form == "json":
            return json.dumps(self.spec, indent=1, ensure_ascii=False) + "\n"
        # Every picture is drawn once, as SVG, from which PNG and PDF are converted.
        settings = {"scale": scale} if form == "png" else {}
        return bytes(converter.begin(f"svg_to_{form}", self.to_svg(), **settings).result())

    def to_svg(self, prefix: str = "") -> str:
        """Return the picture as SVG text, the same text for the same picture.

        Parameters
        ----------
        prefix : str
            Prefix of the names within it, for several pictures in one document.
        """
        # Clipping paths are numbered on from picture to picture of a process.
        numbers: dict[str, int] = {}
        return _CLIP.sub(
            lambda m: f"{m[1]}{prefix}clip{numbers.setdefault(m[2], len(numbers) + 1)}{m[3]}",
            self._as_svg.result(),
        )

    def begin(self) -> Figure:
        """Begin to draw the picture as SVG, in parallel with what is done until it is needed."""
        _ = self._as_svg
        return self

    @cached_property
    def _as_svg(self) -> Future[str]:
        return converter.begin("vegalite_to_svg", self.spec, vl_version=version())

    def _repr_mimebundle_(self, *_: object, **__: object) -> dict[str, Any]:
        """Show the picture in a notebook, which draws SVG without any extension."""
        return {"image/svg+xml": self.to_svg()}


def _figure(of: Figure | alt.TopLevelMixin) -> Figure:
    return of if isinstance(of, Figure) else Figure("", of)


def _altair() -> Any:
    """Import Altair, which asks for the user's home directory even if there is none."""
    try:
        Path.home()
    except RuntimeError:
        os.environ["HOME"] = os.sep
        try:
            return import_module("altair")
        finally:
            del os.environ["HOME"]
    return import_module("altair")
