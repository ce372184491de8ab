"""The common parts of the pictures of both floating pinions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks.reproduction.drawing import Panel, Printed
from benchmarks.reproduction.seed import PINIONS, Seed
from loadshare.report.palette import Look

Curve = Sequence[tuple[float, float]]


def looks(seed: Seed) -> dict[str, Look]:
    """Return the looks of the pinions by the names of their curves."""
    return {f"pinion {p}": seed.palette.gear(p) for p in PINIONS}


def named(curves: Mapping[str, Curve]) -> dict[str, Curve]:
    """Return the curves of the pinions by their names in the legend."""
    return {f"pinion {p}": curve for p, curve in curves.items()}


def clearance_panel(
    seed: Seed,
    of_both: str,
    clearances: Sequence[float],
    curves: Mapping[str, Sequence[float]],
    free: Mapping[str, float],
    printed: Sequence[Printed] = (),
) -> Panel:
    """Return Ω II over a clearance, with lines at the clearances that free the pinions.

    Parameters
    ----------
    seed : Seed
    of_both : str
        The elements with the clearance: "rings" or "splines".
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
