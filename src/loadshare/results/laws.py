"""The origin of every mesh's law, and whether the law holds for the mesh's load."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from loadshare.case import Case, Gear
from loadshare.case.line_of_action import facing
from loadshare.results.share import carries

GIVEN = "given"
"""Basis of a law that is given in numbers whose origin the case does not state."""
MOST = 4
"""Largest number of names of meshes in a line."""
MISFIT = 0.03
"""Error of a law between the loads of its fit, over the elastic angle, from which on there is a
warning: the models of the teeth are themselves off by as much [-]."""
ROUNDED = 1e-6
"""Amount by which rounding may take a torque past a limit, over the limit [-]."""
NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]\d+)?")
"""A number in a note."""


@dataclass(frozen=True, slots=True)
class LawUse:
    """The law of a mesh, and the loads under which it was used.

    Attributes
    ----------
    basis : str
        Where the law is from.
    torque : tuple of float
        Least and largest size of the torque at the driver over the positions [N·m].
    line_load : float or None
        Largest tangential force at the reference circle per face width [N/m]; None where the case
        does not give teeth and face widths.
    note : str
        Says that the load is outside the range in which the law holds, or that the law is far off
        between the loads it was fitted to; else empty.
    """

    basis: str
    torque: tuple[float, float]
    line_load: float | None
    note: str


def laws_of(case: Case, torques: Sequence[Mapping[str, float]]) -> dict[str, LawUse]:
    """Return the law of every mesh as it was used.

    Parameters
    ----------
    case : Case
        As it was solved, with its mesh laws computed.
    torques : sequence of mapping of mesh to float
        On the driver, position by position [N·m].
    """
    found, centres = {}, case.centres()
    most = max((abs(torque) for each in torques for torque in each.values()), default=0.0)
    for name, mesh in case.meshes.items():
        law = mesh.power_law
        sizes = [abs(each[name]) for each in torques]
        least, largest = min(sizes, default=0.0), max(sizes, default=0.0)
        load = _line_load(facing(mesh, case.gears, centres), largest)
        note = ""
        if law is not None and law.holds_from is not None and carries(largest, most):
            note = _below(least, largest, law.holds_from.si)
        if law is not None and law.holds_to is not None and not note:
            note = _above(largest, law.holds_to.si)
        if note and load is not None:
            note += f"; it carries {load * 1e-3:.3g} N per mm of face width at most"
        if law is not None and law.misfit is not None and law.misfit >= MISFIT:
            note += "; " if note else ""
            off = 100.0 * law.misfit
            note += f"at loads other than those of its fit, the law is up to {off:.2g} % off"
        basis = law.basis if law is not None and law.basis else GIVEN
        found[name] = LawUse(basis, (least, largest), load, note)
    return found


def law_lines(laws: Mapping[str, LawUse]) -> list[str]:
    """Return lines on the origin of laws and warnings; none if all are given, without notes."""
    if all(use.basis == GIVEN and not use.note for use in laws.values()):
        return []
    bases = _alike((use.basis, name) for name, use in laws.items())
    kinds = _alike((NUMBER.sub("#", use.note), name) for name, use in laws.items() if use.note)
    return [
        *(f"Law of {_named(names, len(laws))}: {basis}." for basis, names in bases.items()),
        *(f"WARNING: {_named(names, len(laws))}{_noted(laws, names)}." for names in kinds.values()),
    ]


def _below(least: float, largest: float, limit: float) -> str:
    if largest < limit * (1.0 - ROUNDED):
        return f"{largest:.4g} N·m lies below the {limit:.4g} N·m from which the law holds"
    if least < limit * (1.0 - ROUNDED):
        return f"down to {least:.4g} N·m, below the {limit:.4g} N·m from which the law holds"
    return ""


def _above(largest: float, limit: float) -> str:
    if largest > limit * (1.0 + ROUNDED):
        return f"{largest:.4g} N·m lies above the {limit:.4g} N·m up to which the law holds"
    return ""


def _line_load(gears: tuple[Gear, Gear], torque: float) -> float | None:
    widths = [gear.face_width.si for gear in gears if gear.face_width is not None]
    tooth = gears[0].tooth
    if tooth is None or len(widths) < len(gears):
        return None
    return torque / (tooth.radius * min(widths))


def _alike(pairs: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for text, name in pairs:
        found.setdefault(text, []).append(name)
    return found


def _noted(laws: Mapping[str, LawUse], names: Sequence[str]) -> str:
    """Return one note for meshes whose notes differ in numbers only, with the ranges of these."""
    notes = [laws[name].note for name in names]
    columns = zip(*map(NUMBER.findall, notes), strict=True)
    ends = [list(dict.fromkeys(pick(c, key=float) for pick in (min, max))) for c in columns]
    each = ", each" if len({*notes}) > 1 else ""
    return f"{each}: " + NUMBER.sub(lambda _: " to ".join(ends.pop(0)), notes[0])


def _named(names: Sequence[str], every: int) -> str:
    if len(names) == 1:
        return f"mesh {names[0]}"
    if len(names) == every:
        return "all meshes"
    shown = names if len(names) <= MOST else [*names[: MOST - 1], f"{len(names) - MOST + 1} more"]
    return f"meshes {', '.join(shown)}"
