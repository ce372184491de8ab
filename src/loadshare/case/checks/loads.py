"""Loads from outside: what gravity needs."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.mass import mass_of
from loadshare.case.quantity import MASS
from loadshare.errors import Problem


def check_masses(draft: Draft) -> Iterator[Problem]:
    """Gravity pulls at every gear."""
    if draft.operating is None or draft.operating.gravity is None:
        return
    for name, gear in draft.gears.items():
        if mass_of(gear) is None:
            hint = "Gravity needs it."
            if not gear.is_carrier:
                hint += " It also follows from module, teeth and face_width, of a ring and its rim."
            yield draft.problem(("gears", name, "mass"), "is missing", MASS.allowed, hint)
