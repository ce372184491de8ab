"""Where gears stand: what must be told of it."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.gears import Polar
from loadshare.case.place import Vector, along_z, on_axis
from loadshare.case.quantity import LENGTH
from loadshare.errors import Problem


def check_distances(draft: Draft) -> Iterator[Problem]:
    """Yield distances from a pole that are neither given nor follow from teeth."""
    if not draft.sound("gears", "meshes"):
        return
    centres = draft.centres()
    for name, gear in draft.gears.items():
        centre = gear.centre
        if not isinstance(centre, Polar) or centre.distance is not None or name in centres:
            continue
        if centre.about is None or centre.about in centres:
            pole = centres[centre.about] if centre.about is not None else (0.0, 0.0, 0.0)
            path = ("gears", name, "centre", "distance")
            hint = _what_is_missing(draft, name, centre.about, pole, centres)
            yield draft.problem(path, "is missing", LENGTH.allowed, hint)


def _what_is_missing(
    draft: Draft, name: str, about: str | None, pole: Vector, centres: dict[str, Vector]
) -> str:
    """Say which keys would let a distance follow from teeth."""
    partners = {end for mesh in draft.meshes.values() if name in mesh.ends for end in mesh.ends}
    there = sorted(
        partner
        for partner in partners & draft.gears.keys() - {name}
        if partner == about
        or (
            partner in centres
            and not draft.gears[partner].is_carrier
            and on_axis(pole, centres[partner], draft.gears[partner].acting_radius)
        )
    )
    if not there:
        with_whom = f"with {about} or " if about is not None else ""
        return f"It follows where the gear meshes {with_whom}with a gear on the axis of its pole."
    bare = [n for n in (name, *there) if draft.gears[n].tooth is None]
    if bare:
        return f"It follows from the teeth: give teeth and module of {' and '.join(bare)}."
    if not all(along_z(draft.gears[n]) for n in (name, *there)):
        return "It follows from the teeth where axes are along z."
    return f"The teeth of {name} and {there[0]} cannot mesh without backlash at any distance."
