"""Check that a mesh law is not used for teeth other than those it was computed from."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping

from loadshare.case.draft import Draft
from loadshare.case.gears import OF_TEETH, USUAL_TEETH, Gear
from loadshare.case.line_of_action import centre_distance
from loadshare.case.meshes import Mesh
from loadshare.case.place import Vector, axis_of, dot, minus
from loadshare.case.quantity import Quantity
from loadshare.errors import Problem

WITHOUT_STIFFNESS = {"thickness_allowance", "tolerance_class", "density", "ovalisation"}
"""Keys of teeth that no law depends on."""
OF_LAWS = (
    *("type", "teeth", "module", "base_radius", "inner_radius", "outer_radius"),
    *(key for key in OF_TEETH if key not in WITHOUT_STIFFNESS),
)
"""Keys of a gear that its mesh laws depend on."""


def teeth_digest(
    mesh: Mesh, gears: Mapping[str, Gear], centres: Mapping[str, Vector], *, written: bool = False
) -> str:
    """Return a digest of the teeth of a mesh and of their distances.

    Parameters
    ----------
    mesh : Mesh
    gears : mapping of str to Gear
    centres : mapping of str to tuple of float
        Centres of both gears [m].
    written : bool
        Whether a default that is written out counts as given, as in the digests of older laws.
    """
    pair = gears[mesh.driver], gears[mesh.driven]
    offset = minus(centres[mesh.driven], centres[mesh.driver])
    lengths = centre_distance(pair[0], offset), abs(dot(offset, axis_of(pair[0])))
    # Rounded to a picometre: turning or moving all centres changes distances by round-off.
    content = [f"{length:.12f}" for length in lengths]
    content += [f"{_value(gear, key, written)!r}" for gear in pair for key in OF_LAWS]
    return hashlib.sha256("\n".join(content).encode()).hexdigest()[:16]


def check_law_origins(draft: Draft) -> Iterator[Problem]:
    """Yield laws that were computed from other teeth than those of their gears."""
    centres = draft.centres()
    for name, mesh in draft.meshes.items():
        law = mesh.power_law
        if law is None or not law.teeth or not {*mesh.ends} <= draft.gears.keys() & centres.keys():
            continue
        if law.teeth not in (
            teeth_digest(mesh, draft.gears, centres),
            teeth_digest(mesh, draft.gears, centres, written=True),
        ):
            message = "its numbers were computed from teeth other than those of its gears"
            hint = (
                'law = "iso" or "ltca" computes them from the gears\' teeth; '
                "remove law.teeth to keep the numbers as they are."
            )
            yield draft.problem(("meshes", name, "law"), message, hint=hint)


def _value(gear: Gear, key: str, written: bool) -> object:
    given = getattr(gear, key)
    value = given.si if isinstance(given, Quantity) else given
    usual = None if written or gear.tooth is None else USUAL_TEETH.get(key)
    # Writing out a default does not change the teeth.
    return None if value == usual else value
