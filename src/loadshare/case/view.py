"""What a notebook shows of a case."""

from __future__ import annotations

from typing import TYPE_CHECKING

from loadshare.view import View

if TYPE_CHECKING:
    from loadshare.case.gears import Gear
    from loadshare.case.model import Case

ELEMENTS = ("gears", "meshes", "shafts", "splines", "rings", "bearings", "errors")


def case_view(case: Case) -> View:
    """Tell what a case is, how it is loaded, and the first of its gears."""
    counts = {name: len(getattr(case, name)) for name in ELEMENTS}
    facts = (
        ("title", case.title),
        ("source", case.source),
        ("operating point", _operating(case)),
        ("elements", ", ".join(f"{name} {count}" for name, count in counts.items() if count)),
        ("stages", ", ".join(case.stages)),
        ("assumed", ", ".join(case.assumed)),
        ("studies", ", ".join(case.study)),
    )
    rows = tuple((name, gear.type, _held(case, name, gear)) for name, gear in case.gears.items())
    return View(f"Case {case.name or 'unnamed'}", facts, ("gear", "type", "held by"), rows)


def _operating(case: Case) -> str:
    point = case.operating
    if point is None:
        return ""
    given = case.to_dict()["operating"]
    load = ", ".join(f"{k} {given[k]}" for k in ("torque", "power", "speed") if k in given)
    return f"{point.input} → {point.output}, {load}"


def _held(case: Case, name: str, gear: Gear) -> str:
    if gear.held:
        return "held"
    if case.floats(name):
        return "floats"
    return gear.support if isinstance(gear.support, str) else "elastic" if gear.support else "rigid"
