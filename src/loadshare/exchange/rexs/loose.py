"""Gears that turn loose, as those of gears that are not engaged."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from loadshare.exchange.rexs.model import Component

Stage = tuple[Component, Component, Component]
"""A stage and both its gears."""


def loose_stages(
    stages: list[Stage], shaft_of: Mapping[str, Component], held: set[str], opened: set[str]
) -> list[Stage]:
    """Return the meshes of gears that turn loose on open couplings; they carry nothing.

    Parameters
    ----------
    stages : list of (Component, Component, Component)
    shaft_of : mapping of str to Component
        Shaft of every gear, by id.
    held : set of str
        Ids of shafts and gears on which something else than meshes exerts torque.
    opened : set of str
        Ids of the shafts at open couplings.
    """
    left, opened = list(stages), set(opened)
    loose: list[Stage] = []
    while True:
        ends = [gear for stage in left for gear in stage[1:]]
        shafts = Counter(shaft_of[gear.id].id for gear in ends if gear.id in shaft_of)
        free = {
            gear.id
            for gear in ends
            if gear.id in shaft_of
            and gear.id not in held
            and (shaft := shaft_of[gear.id].id) in opened - held
            and shafts[shaft] == 1
        }
        found = [stage for stage in left if {stage[1].id, stage[2].id} & free]
        if not found:
            return loose
        loose += found
        left = [stage for stage in left if stage not in found]
        # What drove only a loose gear is loose itself.
        opened |= {shaft_of[g.id].id for stage in found for g in stage[1:] if g.id in shaft_of}
