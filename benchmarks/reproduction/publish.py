"""The work of `python -m benchmarks.reproduction`: solve, draw, write."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from benchmarks.reproduction import (
    both_errors,
    loads,
    rings,
    single_errors,
    splines,
    stiffness,
)
from benchmarks.reproduction.chapter import Chapter
from benchmarks.reproduction.page import PICTURES, page
from benchmarks.reproduction.seed import Seed
from loadshare.output import write_whole

PAGE = "reproduction.md"


@dataclass(frozen=True)
class Reproduction:
    """The page and its pictures.

    Attributes
    ----------
    chapters : tuple of Chapter
    used : mapping of path to str
        Hash of every file that was read.
    """

    chapters: tuple[Chapter, ...]
    used: dict[str, str]

    @property
    def text(self) -> str:
        """The page in Markdown."""
        return page(self.chapters, self.used)

    @property
    def pictures(self) -> dict[str, str]:
        """SVG of every picture, by name."""
        return {n: f.to_svg() for c in self.chapters for n, f in c.pictures.items()}

    def write(self, folder: Path) -> list[Path]:
        """Write page and pictures into a folder; return the files."""
        texts = {folder / PAGE: self.text}
        texts |= {folder / PICTURES / f"{n}.svg": svg for n, svg in self.pictures.items()}
        for path, text in texts.items():
            write_whole(path, text)
        return list(texts)


def reproduce(folder: Path, tell: Callable[[str], None]) -> Reproduction:
    """Compute every figure of the seed paper.

    Parameters
    ----------
    folder : pathlib.Path
        Of the shipped cases.
    tell : callable
        Called with each step.

    Raises
    ------
    LoadshareError
        If a case is missing, cannot be used, or has no certified equilibrium.
    """
    seed = Seed(folder)
    teeth = stiffness.stiffnesses(seed, tell)
    tell("Figs. 8 and 9: one gear at a time")
    displaced, turning = single_errors.installation(seed), single_errors.eccentricity(seed)
    tell("Fig. 10: fitting the directions of the eccentricities")
    both = both_errors.both_errors(seed)
    others = both_errors.alternatives(seed)
    cycle = stiffness.over_cycle(both.case, teeth) if teeth else None
    tell("Figs. 11 and 12: clearance splines")
    full = splines.full_float(seed, both.case)
    other_floats = {name: splines.full_float(seed, case) for name, case in others.items()}
    float_cycle = stiffness.over_cycle(full.case, teeth) if teeth else None
    clearance = splines.clearance(seed, both.case)
    tell("Figs. 13 and 14: limit rings")
    limited = rings.rings(seed)
    tell("Table 2 and Fig. 18: loads")
    loaded = loads.loads(seed, both.case, full.case)
    chapters = (
        stiffness.chapter(seed, teeth),
        single_errors.installation_chapter(seed, displaced),
        single_errors.eccentricity_chapter(seed, turning),
        both_errors.chapter(seed, both, others, cycle),
        splines.float_chapter(seed, full, both, other_floats, float_cycle),
        splines.clearance_chapter(seed, clearance, full),
        rings.ring_chapter(seed, limited),
        rings.point_chapter(seed, limited),
        loads.chapter(loaded),
    )
    return Reproduction(chapters, seed.used)
