"""Checks on loads: torques that nothing feels, masses for gravity, temperatures of face gears."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.keys import Path
from loadshare.case.mass import mass_of
from loadshare.case.quantity import MASS
from loadshare.errors import Problem


def check_external(draft: Draft) -> Iterator[Problem]:
    """Yield torques on the output and on held gears, which whatever holds the gear takes."""
    operating = draft.operating
    held = {name: "the housing" for name, gear in draft.gears.items() if gear.held}
    if operating is None:
        return
    held[operating.output] = "the driven machine"
    for name in (name for name in operating.external if name in held):
        what = f"has no effect: {held[name]} takes any torque on gear {name}"
        yield draft.problem(("operating", "external", name), what, hint="Leave it out.")


def check_masses(draft: Draft) -> Iterator[Problem]:
    """Yield gears whose mass gravity needs and that have none."""
    if draft.operating is None or draft.operating.gravity is None:
        return
    for name, gear in draft.gears.items():
        if mass_of(gear) is None:
            hint = "Gravity needs it."
            if not gear.is_carrier:
                hint += " It also follows from module, teeth, face_width and, if internal, rim."
            yield draft.problem(("gears", name, "mass"), "is missing", MASS.allowed, hint)


def check_temperatures(draft: Draft) -> Iterator[Problem]:
    """Yield temperatures in trains with face gears.

    Thermal growth is counted at the pitch points of cylindrical gears.
    """
    warm: list[Path] = [
        ("gears", name, "temperature") for name, g in draft.gears.items() if g.temperature
    ]
    if draft.operating is not None and draft.operating.temperature is not None:
        warm.insert(0, ("operating", "temperature"))
    if any(gear.type == "face" for gear in draft.gears.values()):
        for path in warm:
            yield draft.problem(path, "is for trains of cylindrical gears only")
