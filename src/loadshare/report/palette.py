"""The look of gears and meshes: the same gear looks the same in every picture.

A look is a colour, a dash and a shape. The colours can be told apart with the common colour-vision
deficiencies and alternate between dark and light; in grey, dash and shape distinguish them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from loadshare.case.keys import ends_of
from loadshare.results import Result

INK = "#1f2933"
"""Lines and text."""
SOFT = "#616e7c"
"""Secondary elements: axes, references, notes."""
FAINT = "#e4e7eb"
"""Grids and areas."""
WARNING = "#b3261e"
"""Whatever is wrong."""

COLOURS = (
    "#1b4f8f",
    "#d98c00",
    "#0b7a63",
    "#c94f9b",
    "#7a2e12",
    "#3fa0d8",
    "#5b3a9e",
    "#8a9a1b",
    "#c0392b",
    "#4d5b6a",
)
DASHES = ((1, 0), (7, 3), (2, 2), (9, 3, 2, 3), (4, 2), (12, 3), (9, 3, 2, 3, 2, 3))
SHAPES = ("circle", "square", "triangle-up", "diamond", "triangle-down", "cross", "triangle-right")

Ends = Mapping[str, tuple[str, str]]


@dataclass(frozen=True, slots=True)
class Look:
    """How a gear is drawn.

    Attributes
    ----------
    colour : str
        Hexadecimal.
    dash : tuple of int
        Lengths of strokes and gaps; (1, 0) is a full line.
    shape : str
        Shape of its points, by its name in Vega.
    """

    colour: str
    dash: tuple[int, ...]
    shape: str


class Palette:
    """Looks by the order of the gears in a result or a train.

    Parameters
    ----------
    gears : iterable of str
        In the order in which the power reaches them.
    ends : mapping of mesh to (driver, driven)
    """

    def __init__(self, gears: Iterable[str], ends: Ends) -> None:
        self._number = {gear: number for number, gear in enumerate(gears)}
        self._ends = ends
        self._driving = Counter(driver for driver, _ in ends.values())
        self._driven = Counter(driven for _, driven in ends.values())

    def gear(self, name: str) -> Look:
        """Return the look of a gear."""
        return look(self._number.get(name, len(self._number)))

    def mesh(self, name: str) -> Look:
        """Return the look of a mesh: that of the gear that distinguishes its branch."""
        gear = self.branch(name)
        return self.gear(gear) if gear else look(len(self._number) + len(name))

    def branch(self, mesh: str) -> str | None:
        """Return the gear that distinguishes a mesh from its neighbours; None without known gears.

        Where torque paths join (idlers on an output gear) it is the driver; where they divide, or
        simply continue, it is the driven gear.
        """
        if mesh not in self._ends:
            return None
        driver, driven = self._ends[mesh]
        return driver if self._driving[driver] < self._driven[driven] else driven


def look(number: int) -> Look:
    """Return look number `number`; 70 are different, and neighbours differ in everything."""
    return Look(
        COLOURS[number % len(COLOURS)],
        DASHES[number % len(DASHES)],
        SHAPES[number % len(SHAPES)],
    )


def palette_of(result: Result) -> Palette:
    """Return the looks of a result's gears and meshes.

    Parameters
    ----------
    result : Result
    """
    known = result.case.meshes
    meshes = {m: (known[m].driver, known[m].driven) for m in result.positions[0].torque}
    return Palette(list(result.frames), meshes)


def ends_from_names(meshes: Iterable[str], gears: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Return driver and driven gear of the meshes whose names, a-b, give them."""
    known = set(gears)
    found = {mesh: ends_of(mesh, known) for mesh in meshes}
    return {mesh: ends for mesh, ends in found.items() if ends and set(ends) <= known}
