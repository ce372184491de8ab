"""Vega-Lite as plain data: channels, layers and panels, in the terms of its reference.

Altair writes the same, but importing it and turning its charts into data takes longer than solving
a case and putting it into tables.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

MAJOR = 6
"""Version of Vega-Lite in which specifications are written."""
SCHEMA = f"https://vega.github.io/schema/vega-lite/v{MAJOR}.json"
KINDS = {"Q": "quantitative", "N": "nominal"}
PARTS = ("layer", "concat", "hconcat", "vconcat")
"""Keys of a view that hold other views."""
SIZES = ("width", "height")
OWN_LEGENDS = {"scale": {"color": "independent", "shape": "independent"}}

Drawing = dict[str, Any]
"""A view of Vega-Lite: a layer of marks, a panel of layers, or several panels."""
Channel = dict[str, Any]
Row = dict[str, Any]


@cache
def version() -> str:
    """Return the version of Vega-Lite that draws, such as "6.4": the converter's newest."""
    import vl_convert

    known = [tuple(map(int, text.split("."))) for text in vl_convert.get_vegalite_versions()]
    return ".".join(map(str, max(v for v in known if v[0] == MAJOR)))


def channel(field: str, **settings: Any) -> Channel:
    """Return the channel of a field: "x:Q" of a quantity, "mesh:N" of a name.

    The second end of a bar or rule, such as "x2", has the kind of the first.
    """
    name, _, kind = field.partition(":")
    return {"field": name, **({"type": KINDS[kind]} if kind else {}), **settings}


def layer(mark: str, rows: Sequence[Row], channels: Mapping[str, Any], **style: Any) -> Drawing:
    """Return marks of one kind: a line along all rows, anything else for each row."""
    return {"data": {"values": rows}, "mark": {"type": mark, **style}, "encoding": {**channels}}


def panel(layers: Iterable[Drawing], width: float, height: float, **more: Any) -> Drawing:
    """Return layers as a panel, the lowest first."""
    return {"layer": list(layers), "width": width, "height": height, **more}


def joined(how: str, views: Iterable[Drawing], **more: Any) -> Drawing:
    """Return several views as one, joined by "layer", "concat", "hconcat" or "vconcat"."""
    whole: Drawing = {how: [], **more}
    for view in views:
        # Selections of a single layer stay with it; those of several name their views.
        shared = ("datasets",) if "mark" in view else ("datasets", "params")
        whole[how].append({key: part for key, part in view.items() if key not in shared})
        if "datasets" in view:
            whole["datasets"] = whole.get("datasets", {}) | view["datasets"]
        if "params" in view and "params" in shared:
            whole["params"] = [*whole.get("params", ()), *view["params"]]
    return whole


def layered(views: Sequence[Drawing]) -> Drawing:
    """Return views of one panel over one another, in the size of the first that has one."""
    sizes = {key: view[key] for view in reversed(views) for key in SIZES if key in view}
    bare = [{key: part for key, part in view.items() if key not in SIZES} for view in views]
    return joined("layer", bare, **sizes)


def with_datasets(view: Drawing) -> Drawing:
    """Return a view with its rows in datasets, so that rows of several layers are stored once."""
    datasets = dict(view.get("datasets", {}))
    names: dict[int, str] = {}

    def named(part: Drawing) -> Drawing:
        inner = {key: [named(one) for one in part[key]] for key in PARTS if key in part}
        rows = (part.get("data") or {}).get("values")
        if rows is None:
            return part | inner
        name = names.setdefault(id(rows), f"rows-{len(names) + 1}")
        datasets[name] = rows
        return part | inner | {"data": {"name": name}}

    return named(view) | ({"datasets": datasets} if datasets else {})
