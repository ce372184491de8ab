"""What the pictures of both floating pinions have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks.reproduction.drawing import Panel, Printed
from benchmarks.reproduction.seed import PINIONS, Seed
from loadshare.report.palette import Look

Curve = Sequence[tuple[float, float]]


def looks(seed: Seed) -> dict[str, Look]:
    """Looks of the pinions by the names of their curves."""
    return {f"pinion {p}": seed.palette.gear(p) for p in PINIONS}


def named(curves: Mapping[str, Curve]) -> dict[str, Curve]:
    """Curves of the pinions by their names in the legend."""
    return {f"pinion {p}": curve for p, curve in curves.items()}


def clearance_panel(
    seed: Seed,
    of_both: str,
    clearances: Sequence[float],
    curves: Mapping[str, Sequence[float]],
    free: Mapping[str, float],
    printed: Sequence[Printed] = (),
) -> Panel:
    """Ω II over a clearance, with rules where the pinions come free.

    Parameters
    ----------
    seed : Seed
    of_both : str
        What has the clearance: "rings", "splines".
    clearances : sequence of float
        [µm]
    curves : mapping of pinion to coefficients at the clearances
    free : mapping of pinion to clearance [µm]
    printed : sequence of Printed
    """
    return Panel(
        "",
        f"clearance of both {of_both} [µm]",
        "Ω II, within the pair",
        named({p: list(zip(clearances, curve, strict=True)) for p, curve in curves.items()}),
        looks(seed),
        "pair of",
        printed=printed,
        rules=[(value, f"pinion {p} free") for p, value in free.items()],
    )
