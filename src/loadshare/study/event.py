"""An event: a change of the active set along a parameter, in words of the field."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.scene.scene import Scene
from loadshare.study.branch import ActiveSet

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
        What changes its state: a flank, a ring's contact, a spline.
    gear : str or None
        The float concerned, for a ring or spline.
    kind : str
        "contact closes", "contact opens", "float reaches boundary", "float leaves boundary",
        "slip starts", "slip ends", "clearance used up", "clearance opens".
    before, after : str
        State below and above the value.
    together : int
        How many elements change at this very value; 1 for all but symmetric cases.
    confirmed : bool
        Whether the certified active sets on both sides differ in exactly the elements that change
        here.
    worst : float
        Larger one of the two certificates' worst scaled residuals.
    apart : float
        Distance of the two certified solves from the event, in the unit.
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


def told(scene: Scene, element: str, before: ActiveSet, after: ActiveSet) -> tuple[str, str | None]:
    """Return the kind of a change and the float that it concerns.

    Parameters
    ----------
    scene : Scene
    element : str
    before, after : ActiveSet
        With the parameter below and above the event.
    """
    here, then = before.state(element), after.state(element)
    for radial in scene.radials:
        if radial.name == element:
            return _SPLINE.get((here, then), f"{here} becomes {then}"), radial.gear
    contacts = [r.name for r in scene.rows if r.kind == "stop"] + [a.name for a in scene.arcs]
    if element in contacts:
        gear = next(g for g in scene.train.rings if element.startswith(f"ring {g}:"))
        return f"float {'reaches' if then == 'closed' else 'leaves'} boundary", gear
    return f"contact {'closes' if then == 'closed' else 'opens'}", None
