"""Tooth counts that follow from those given: gears that mesh have the same base pitch."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from loadshare.case.gears import Gear
from loadshare.case.meshes import Mesh

TEETH_TOLERANCE = 1e-2
"""Largest deviation of given tooth counts from the ratio of the base radii, relative to it [-].

Assumed or rounded radii deviate by less; a tooth too many on a gear of fewer than 100 teeth
deviates by more."""


@dataclass(frozen=True, slots=True)
class CountMisfit:
    """A given tooth count that another one contradicts.

    Attributes
    ----------
    gear, other : str
        The gear, and the one whose teeth contradict its own.
    expected : float
        Teeth that the gear would have by the other's and the base radii [-].
    """

    gear: str
    other: str
    expected: float


def tooth_counts(
    gears: Mapping[str, Gear], meshes: Mapping[str, Mesh]
) -> tuple[dict[str, float], tuple[CountMisfit, ...]]:
    """Return the tooth counts of all gears that meshes connect to a gear whose count is given.

    Parameters
    ----------
    gears : mapping of str to Gear
    meshes : mapping of str to Mesh
        Meshes of carriers, and of gears that do not exist, are ignored.

    Returns
    -------
    dict of gear to float
        Given counts are unchanged; computed ones need not be whole, as radii may be rounded [-].
    tuple of CountMisfit
    """
    given = {name: gear.teeth for name, gear in gears.items() if not gear.is_carrier}
    radii = {name: gears[name].acting_radius for name in given}
    partners: dict[str, list[str]] = {name: [] for name in given}
    for a, b in (mesh.ends for mesh in meshes.values()):
        if a in given and b in given:
            partners[a].append(b)
            partners[b].append(a)
    counts = {name: float(count) for name, count in given.items() if count is not None}
    misfits: list[CountMisfit] = []
    settled: dict[str, tuple[str, float]] = {}
    for source in counts.copy():
        if source in settled:
            continue
        settled[source] = source, counts[source] / radii[source]
        queue = deque([source])
        while queue:
            here = queue.popleft()
            origin, density = settled[here]
            for other in partners[here]:
                if other in settled:
                    continue
                expected = density * radii[other]
                count = counts.setdefault(other, expected)
                if abs(count - expected) > TEETH_TOLERANCE * expected:
                    misfits.append(CountMisfit(other, origin, expected))
                follows = given[other] is None
                settled[other] = (origin, density) if follows else (other, count / radii[other])
                queue.append(other)
    return counts, tuple(misfits)
