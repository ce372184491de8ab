"""Pictures on disk: the format follows from the ending, the file is written whole or not at all."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from loadshare.errors import LoadshareError
from loadshare.results.files import write_atomically

Spec = dict[str, Any]
_CLIP = re.compile(r'(id="|url\(#)clip(\d+)("|\))')


def vega_lite_version() -> str:
    """Version of Vega-Lite, such as "6.4", in which Altair writes its charts."""
    import altair as alt

    return ".".join(str(alt.SCHEMA_VERSION).removeprefix("v").split(".")[:2])


def save_chart(spec: Spec, path: str | Path, scale: float = 2.0) -> Path:
    """Write a chart as PNG, SVG, PDF, HTML (works offline) or JSON (the Vega-Lite specification).

    Parameters
    ----------
    spec : dict
        Vega-Lite specification.
    path : path-like
        Its ending tells the format; its folder is made.
    scale : float
        Pixels of a PNG per unit of the specification.

    Returns
    -------
    Path

    Raises
    ------
    LoadshareError
        For an ending that is none of these.
    OSError
        If the file cannot be written.
    """
    path = Path(path)
    write = _WRITERS.get(path.suffix.lower())
    if write is None:
        raise LoadshareError(
            f"{path}: no picture can be written with the ending {path.suffix or '(none)'!r}. "
            f"Allowed: {', '.join(_WRITERS)}"
        )
    content = write(spec, scale)
    write_atomically(path, lambda file: _write_bytes(file, content))
    return path


def svg_text(spec: Spec, prefix: str = "") -> str:
    """Return a chart as SVG, the same text for the same chart.

    Parameters
    ----------
    spec : dict
        Vega-Lite specification.
    prefix : str
        Put before the names within it, for pictures that stand in one document.
    """
    import vl_convert

    text = str(vl_convert.vegalite_to_svg(spec, vl_version=vega_lite_version()))
    # The names of clipping paths go on from picture to picture of a process.
    numbers: dict[str, int] = {}
    return _CLIP.sub(
        lambda m: f"{m[1]}{prefix}clip{numbers.setdefault(m[2], len(numbers) + 1)}{m[3]}", text
    )


def _write_bytes(file: Path, content: bytes) -> None:
    file.write_bytes(content)


def _png(spec: Spec, scale: float) -> bytes:
    import vl_convert

    return bytes(vl_convert.vegalite_to_png(spec, vl_version=vega_lite_version(), scale=scale))


def _svg(spec: Spec, _: float) -> bytes:
    return svg_text(spec).encode()


def _pdf(spec: Spec, _: float) -> bytes:
    import vl_convert

    return bytes(vl_convert.vegalite_to_pdf(spec, vl_version=vega_lite_version()))


def _html(spec: Spec, _: float) -> bytes:
    # The page writer of vl-convert leaves texts of the specification unescaped.
    from loadshare.report.page.offline import figure_page

    title = spec.get("title", "")
    return figure_page(spec, title["text"] if isinstance(title, dict) else str(title)).encode()


def _json(spec: Spec, _: float) -> bytes:
    return (json.dumps(spec, indent=1, ensure_ascii=False) + "\n").encode()


_WRITERS: dict[str, Callable[[Spec, float], bytes]] = {
    ".png": _png,
    ".svg": _svg,
    ".pdf": _pdf,
    ".html": _html,
    ".json": _json,
}
