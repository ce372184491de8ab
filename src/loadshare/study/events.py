"""Events along a parameter: changes of the active set, and of the flanks that loads press."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.active import switch_names
from loadshare.study.follow.changes import Change, Gap, PathPoint, change_between
from loadshare.study.follow.line import Line

_STATES = {
    at.OPEN: "slip",
    at.STICK: "stick",
    at.CORNER: "about to slip",
    at.PINNED: "about to slip",
    at.SLIP: "slip",
    at.STOP: "stop",
    at.WALL: "on boundary",
}

_FLANKS = {True: "drive", False: "coast"}
_SPLINE = {
    ("stick", "slip"): "slip starts",
    ("slip", "stick"): "slip ends",
    ("slip", "stop"): "clearance used up",
    ("stick", "stop"): "clearance used up",
    ("stop", "slip"): "clearance opens",
    ("stop", "stick"): "clearance opens",
    ("inside", "on boundary"): "float reaches boundary",
    ("on boundary", "inside"): "float leaves boundary",
}


@dataclass(frozen=True, slots=True)
class Event:
    """A change of the active set.

    Attributes
    ----------
    value : float
        Of the parameter, in its unit.
    unit : str
    position : int
        1-based meshing position.
    element : str
        The element that changes its state: a flank, a ring's contact, a spline.
    gear : str or None
        The float concerned, for a ring or spline.
    kind : str
        "contact closes", "contact opens", "float reaches boundary", "float leaves boundary",
        "slip starts", "slip ends", "clearance used up", "clearance opens", "flank changes".
    before, after : str
        State below and above the value.
    together : int
        How many elements change at exactly this value; 1 except in symmetric cases.
    confirmed : bool
        Whether it is proved that these elements change here and, between the certified solves on
        both sides, nothing else does.
    worst : float
        Larger of the worst scaled residuals of the two certificates.
    apart : float
        Distance of the two certified solves from the event, in the unit; if it is not confirmed,
        that of the ends of the unproved interval.
    """

    value: float
    unit: str
    position: int
    element: str
    gear: str | None
    kind: str
    before: str
    after: str
    together: int
    confirmed: bool
    worst: float
    apart: float

    def __str__(self) -> str:
        at = f"{self.value:.6g} {self.unit}".strip()
        return f"{at}: {self.element}: {self.kind}"


def events_of(line: Line, position: int, change: Change) -> list[Event]:
    """Return a change of the set as events, one for each element.

    Parameters
    ----------
    line : Line
    position : int
        1-based.
    change : Change
    """
    structure = line.structure
    rows, kinds = structure.rows, structure.kinds[structure.columns.contacts]
    names = switch_names(structure)
    changed = change.before.changes(change.after, structure)
    event, found = _events(line, position, change, len(changed)), []
    for k in changed:
        ring = k >= rows and structure.radials[k - rows].kind == "ring"
        sides = (change.before, change.after)
        before, after = (_state(side.states[k], k < rows, ring) for side in sides)
        if before == after:
            continue
        gear = None
        if k >= rows:
            gear = structure.radials[k - rows].gear
            kind = _SPLINE.get((before, after), f"{before} becomes {after}")
        elif kinds[k] in ("stop", "arc"):
            gear = next(g for g in structure.train.rings if names[k].startswith(f"ring {g}:"))
            kind = f"float {'reaches' if after == 'closed' else 'leaves'} boundary"
        else:
            kind = f"contact {'closes' if after == 'closed' else 'opens'}"
        found.append(event(element=names[k], gear=gear, kind=kind, before=before, after=after))
    return found


def _events(line: Line, position: int, change: Change, together: int) -> partial[Event]:
    """Return `Event` with a change filled in; element, gear, kind and both states are missing."""
    known = {n: getattr(change, n) for n in ("value", "confirmed", "worst", "apart")}
    unit = line.parameter.unit
    return partial(Event, unit=unit, position=position, together=together, **known)


def _state(states: int, is_row: bool, is_ring: bool) -> str:
    """Return the word for a coded state."""
    if is_row:
        return "open" if states == at.OPEN else "closed"
    if is_ring:
        return "inside" if states == at.OPEN else "on boundary"
    return _STATES[states]


def flanks_changed(line: Line, position: int, gap: Gap) -> list[Event]:
    """Return the meshes without backlash whose loaded flank changes across a gap, as events.

    Such a mesh has a single flank on either side, the loaded one, so no contact opens or closes.

    Parameters
    ----------
    line : Line
    position : int
        1-based.
    gap : Gap
    """
    first, last = gap.first, gap.last
    if not (isinstance(first, PathPoint) and isinstance(last, PathPoint)):
        return []
    names = switch_names(line.structure)
    carrying = {
        name
        for name, *states in zip(names, first.active.states, last.active.states, strict=True)
        if all(state != at.OPEN for state in states)
    }
    before, after = (line.train(point.value).meshes for point in (first, last))
    changed = sorted(
        n for n in carrying & before.keys() if before[n].named_backwards != after[n].named_backwards
    )
    value = 0.0 if first.value <= 0.0 <= last.value else last.value
    event = _events(line, position, change_between(first, last, value), len(changed))
    found = []
    for name in changed:
        here, then = (_FLANKS[m[name].is_drive(True)] for m in (before, after))
        found.append(event(element=name, gear=None, kind="flank changes", before=here, after=then))
    return found
