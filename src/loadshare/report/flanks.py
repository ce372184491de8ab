"""The loaded flanks at a position, each with its own force."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from loadshare.results import Position
from loadshare.settings import CERTIFY


class Flank(NamedTuple):
    """A loaded flank.

    Attributes
    ----------
    mesh : str
    drive : bool
        Whether it is the drive flank of the train's mesh, not the coast flank.
    force : float
        Force along its own line of action [N].
    named_backwards : bool
        Whether the train's mesh has its gears in the reverse order of its name.
    """

    mesh: str
    drive: bool
    force: float
    named_backwards: bool = False

    @property
    def side(self) -> str:
        """Which flank it is, in words."""
        return "drive flank" if self.drive != self.named_backwards else "coast flank"

    @property
    def where(self) -> str:
        """Its mesh, and the flank unless it is the drive flank."""
        return f"mesh {self.mesh}" + (
            "" if self.drive != self.named_backwards else f", {self.side}"
        )


def least_force(position: Position) -> float:
    """Return the force [N] up to which the certificate counts a contact as open."""
    return CERTIFY.band * position.certificate.load


def reaction_size(position: Position, gear: str) -> float:
    """Return the size of the reaction of a float's ring [N]; 0 where no contact is closed."""
    size = math.hypot(*position.floats[gear].reaction)
    return size if size > least_force(position) else 0.0


def carrying(position: Position) -> Iterator[Flank]:
    """Yield the loaded flanks at a position, mesh by mesh.

    The force of a mesh is that of its drive flank less that of its coast flank; if a mesh is
    jammed, both carry more than the difference.
    """
    forces, least = position.equilibrium.flank_force, least_force(position)
    for name, mesh in position.train.meshes.items():
        for drive in mesh.flanks:
            force = forces[mesh.flank_name(drive)]
            if force > least:
                yield Flank(name, drive, force, mesh.named_backwards)
