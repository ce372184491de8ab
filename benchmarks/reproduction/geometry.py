"""The geometry behind Figs. 13 and 14, fitted again: how well the printed figures determine it.

`ls.fit` gives several keys the same value; here pinion radius, idler angle and pressure angle
change radii and centres by formulae, so the least squares are set up in this module.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.reproduction import printed
from benchmarks.reproduction.seed import PINIONS, Seed, first, pair_omega
from loadshare.array_types import Array
from loadshare.case import Case

RATIO = 2.5
"""I46, as in the reconstruction."""
STAGE_II = ("4-6", "4-7", "5-8", "5-9", "6-10", "7-10", "8-10", "9-10")
START = (45.9, 18.83, 18.75)
"""r_b4 [mm], ψ [°], α_t [°] of the case files."""
PLACES = (1, 2, 2)
NAMES = ("r_b4 [mm]", "ψ [°]", "α_t [°]")
AMPLE = "50 um"
"""Ring clearance in which both pinions float freely."""


@dataclass(frozen=True)
class Geometry:
    """A geometry and the figures that follow from it.

    Attributes
    ----------
    weights : str
        How the figures were weighted.
    values : tuple of float
        r_b4 [mm], ψ [°], α_t [°].
    figures : tuple of float
        As in `FIGURES`.
    """

    weights: str
    values: tuple[float, ...]
    figures: tuple[float, ...]


FIGURES = ("Ω of pinion 4's pair", "Ω of pinion 5's pair", "threshold 4 [µm]", "threshold 5 [µm]")
PRINTED = np.array([*printed.RIGID_RINGS.values(), *printed.THRESHOLDS.values()])


def geometries(seed: Seed) -> list[Geometry]:
    """Return the geometry of the case files, and fits with other weightings of the figures."""
    from scipy.optimize import least_squares

    case = seed.case("limit_ring")
    weighings: Mapping[str, Callable[[Array], Array]] = {
        "each figure relative": lambda f: (f - PRINTED) / PRINTED,
        "each Ω − 1 and threshold relative": lambda f: np.concatenate(
            [(f[:2] - PRINTED[:2]) / (PRINTED[:2] - 1), (f[2:] - PRINTED[2:]) / PRINTED[2:]]
        ),
        "each in half of its last digit": lambda f: (f - PRINTED) / [5e-4, 5e-4, 5e-3, 5e-3],
    }
    found = [Geometry("the case files", START, tuple(figures(case, START)))]
    for name, weigh in weighings.items():
        best = least_squares(
            _missed,
            START,
            jac="3-point",
            diff_step=np.full(3, 1e-4),
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            args=(case, weigh),
        )
        values = tuple(float(v) for v in best.x)
        found.append(Geometry(name, values, tuple(figures(case, values))))
    return found


def _missed(values: Array, case: Case, weigh: Callable[[Array], Array]) -> Array:
    return weigh(figures(case, values))


def figures(case: Case, values: Array | tuple[float, ...]) -> Array:
    """Return, for a geometry, the shares without float and the clearances that free both pinions.

    Parameters
    ----------
    case : Case
        With the errors of Fig. 13.
    values : r_b4 [mm], ψ [°], α_t [°]
    """
    changed = case.replace(layout(*(float(v) for v in values)))
    held = first(changed, {f"rings.{p}.float": "0 um" for p in PINIONS})
    free = first(changed, {f"rings.{p}.float": AMPLE for p in PINIONS})
    shares = [pair_omega(held, p) for p in PINIONS]
    return np.array([*shares, *(1e6 * math.hypot(*free.displacement[p]) for p in PINIONS)])


def layout(radius: float, idler: float, pressure: float) -> dict[str, object]:
    """Return radii and centres of the seed's transmission (reconstruction, point 6).

    Parameters
    ----------
    radius : float
        r_b4 [mm].
    idler, pressure : float
        ψ and α_t [°].

    Returns
    -------
    dict
        Changes of a case. The output gear's ratio follows from ψ.
    """
    cosine = math.cos(math.radians(pressure))
    pinion, wheel = radius / cosine, RATIO * radius / cosine
    centres = (pinion + wheel) / math.sin(math.radians(idler))
    distance = centres * math.cos(math.radians(idler))
    changes: dict[str, object] = {
        "gears.10.base_radius": _mm((centres - wheel) * cosine),
        **{f'meshes."{mesh}".pressure_angle': f"{pressure!r} deg" for mesh in STAGE_II},
    }
    places = {"4": 60.0, "5": -60.0}
    angles = {"6": 60.0 - idler, "7": 60.0 + idler, "8": -60.0 - idler, "9": -60.0 + idler}
    for gear, angle in (places | angles).items():
        own = distance if gear in places else centres
        changes[f"gears.{gear}.centre"] = {
            "about": "10",
            "distance": _mm(own),
            "angle": f"{angle!r} deg",
        }
        changes[f"gears.{gear}.base_radius"] = _mm(radius if gear in places else RATIO * radius)
    # Face gears are on the axes of their pinions, and pinion 1 between them.
    x, y = distance * math.cos(math.radians(60.0)), distance * math.sin(math.radians(60.0))
    height = 40.0 / math.cos(math.radians(20.0))
    changes["gears.1.centre"] = [_mm(x), "0 mm", "0 mm"]
    changes["gears.2.centre"] = [_mm(x), _mm(y), _mm(height)]
    changes["gears.3.centre"] = [_mm(x), _mm(-y), _mm(-height)]
    return changes


def rows(found: list[Geometry]) -> list[tuple[str, ...]]:
    """Return the rows of the page's table."""
    return [
        (
            g.weights,
            *(f"{v:.{places}f}" for v, places in zip(g.values, PLACES, strict=True)),
            *(f"{v:.4f}" for v in g.figures[:2]),
            *(f"{v:.2f}" for v in g.figures[2:]),
        )
        for g in found
    ]


def _mm(length: float) -> str:
    return f"{length!r} mm"
