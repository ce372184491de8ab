"""Figs. 13 and 14: limit rings, with the stiffness of stage II fitted to the rigid shares."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from benchmarks.reproduction import geometry, printed
from benchmarks.reproduction.chapter import Chapter
from benchmarks.reproduction.drawing import Panel, Printed, picture
from benchmarks.reproduction.entry import (
    Entry,
    entries_table,
    listed,
    minus,
    point,
    signed,
    table,
)
from benchmarks.reproduction.geometry import Geometry
from benchmarks.reproduction.pinions import clearance_panel, looks, named
from benchmarks.reproduction.seed import PAIRS, PINIONS, Seed, first, pair_omega
from benchmarks.reproduction.stiffness import ALIKE
from loadshare.case import Case
from loadshare.report.figure import Figure
from loadshare.results import Position
from loadshare.study.critical import critical
from loadshare.study.events import Event
from loadshare.study.fit import Fit, fit

CLEARANCES = tuple(0.5 * k for k in range(25))
"""Ring clearances of the picture [µm]."""
AMPLE = "200 um"
KEYS = tuple(f"rings.{p}.float" for p in PINIONS)
FITTED = ("4-6", "6-10")
"""Meshes whose stiffness is fitted; each stands for all meshes with the same teeth."""


@dataclass(frozen=True)
class Variant:
    """Fig. 13 with one reading of the error of gear 9.

    Attributes
    ----------
    held : Position
        Ring clearance 0.
    free : Position
        Ample clearance.
    """

    held: Position
    free: Position

    @property
    def branch(self) -> str:
        """Overloaded mesh of pinion 5's pair."""
        return max(PAIRS["5"], key=lambda m: self.held.pair_share[m] or 0.0)

    def point(self, pinion: str) -> tuple[float, float]:
        """Balance point in full float [µm]."""
        return _micrometres(self.free.displacement[pinion])


@dataclass(frozen=True)
class Rings:
    """Figs. 13 and 14.

    Attributes
    ----------
    as_printed, mirrored, exchanged : Variant
        With ΔA_y9 = −0.1 mm, with +0.1 mm, and with −0.1 mm on gear 8 instead.
    resting : Position
        With ring clearances equal to the distances of the printed balance points from the centre.
    curves : mapping of pinion to coefficients at `CLEARANCES`
    paths : mapping of pinion to balance points [µm] at `CLEARANCES`
    events : tuple of Event
    stiffness : Fit
        Stiffness of stage II, fitted to the two shares without float.
    geometries : tuple of Geometry
    """

    as_printed: Variant
    mirrored: Variant
    exchanged: Variant
    resting: Position
    curves: Mapping[str, tuple[float, ...]]
    paths: Mapping[str, tuple[tuple[float, float], ...]]
    events: tuple[Event, ...]
    stiffness: Fit
    geometries: tuple[Geometry, ...]

    @property
    def thresholds(self) -> dict[str, float]:
        """Ring clearance from which each pinion floats fully [µm]."""
        kind = "float leaves boundary"
        return {e.gear: e.value for e in self.events if e.kind == kind and e.gear}

    def resting_point(self, pinion: str) -> tuple[float, float]:
        """Balance point on the ring [µm]."""
        return _micrometres(self.resting.displacement[pinion])


def rings(seed: Seed) -> Rings:
    """Solve Figs. 13 and 14."""
    case = seed.case("limit_ring")
    positions = [first(case, dict.fromkeys(KEYS, f"{c!r} um")) for c in CLEARANCES]
    return Rings(
        as_printed=_variant(case),
        mirrored=_variant(case.replace({"errors.9.installation": ["0 um", "100 um"]})),
        exchanged=_variant(
            case.replace({"errors.9": None, "errors.8.installation": ["0 um", "-100 um"]})
        ),
        resting=first(case),
        curves={p: tuple(pair_omega(at, p) for at in positions) for p in PINIONS},
        paths={p: tuple(_micrometres(at.displacement[p]) for at in positions) for p in PINIONS},
        events=critical(case, KEYS, "0 um", "12 um", positions=[1]).events,
        stiffness=_stiffness(case),
        geometries=tuple(geometry.geometries(seed)),
    )


def _micrometres(place: tuple[float, float]) -> tuple[float, float]:
    return 1e6 * place[0], 1e6 * place[1]


def _variant(case: Case) -> Variant:
    held = first(case, dict.fromkeys(KEYS, "0 um"))
    return Variant(held, first(case, dict.fromkeys(KEYS, AMPLE)))


def _stiffness(case: Case) -> Fit:
    """Fit the stiffnesses of stage II, within the printed ranges, to the shares without float."""
    figure = {
        "position": 1,
        "pair_share": {"7-10": printed.RIGID_RINGS["4"], "9-10": printed.RIGID_RINGS["5"]},
        "uncertainty": 0.0005,
        "source": "Seed paper, Fig. 13; 9-10 in place of 8-10",
    }
    held = case.replace({**dict.fromkeys(KEYS, "0 um"), "measured.fig13": figure})
    unknowns = {
        tuple(f'meshes."{mesh}".stiffness' for mesh in ALIKE[kind]): (
            f"{low!r} N*m/rad",
            f"{high!r} N*m/rad",
        )
        for kind, (low, high) in ((kind, printed.STIFFNESS[kind]) for kind in FITTED)
    }
    return fit(held, unknowns)


def fig13_entries(found: Rings) -> list[Entry]:
    """Return the figures of Fig. 13."""
    held, free = found.as_printed.held, found.as_printed.free
    entries = []
    for p in PINIONS:
        pair, omega = f"Ω of pinion {p}'s pair", printed.RIGID_RINGS[p]
        threshold = f"clearance that frees pinion {p} [µm]"
        entries += [
            Entry(f"{pair}, clearance 0", omega, pair_omega(held, p), 4, "fitted"),
            Entry(threshold, printed.THRESHOLDS[p], found.thresholds[p], 3, "fitted"),
            Entry(f"{pair}, ample clearance", printed.FREE_RINGS[p], pair_omega(free, p), 4),
        ]
    return entries


def fig14_entries(found: Rings) -> list[Entry]:
    """Return the balance points on the rings."""
    return [
        Entry(f"balance point of pinion {p}, {axis} [µm]", value, own, 3, "fitted")
        for p in PINIONS
        for axis, value, own in zip("xy", printed.POINTS[p], found.resting_point(p), strict=True)
    ]


def ring_chapter(seed: Seed, found: Rings) -> Chapter:
    """Return the text on Fig. 13."""
    entries = fig13_entries(found)
    worst = max(abs(e.relative or 0.0) for e in entries)
    past = {p: 100 * (pair_omega(found.as_printed.held, p) - 1) for p in PINIONS}
    blocks = (
        "`cases/fgfbstts/limit_ring.toml`: ΔA_y6 = +0.1 mm, ΔA_y9 = −0.1 mm, the same clearance in "
        "both rings. Thresholds from `ls.critical`.",
        entries_table(entries),
        "{rings}",
        f"All are within {100 * worst:.1f} %. By the stricter measure Ω − 1, pinion 4's pair has "
        f"{past['4']:.2f} % (paper 4.7 %) and pinion 5's {past['5']:.2f} % (paper 1.9 %).",
        _geometry_text(found),
        _stiffness_text(found),
        _mirror_text(found),
        "**With an ample clearance**, a free pinion shares evenly here, while the paper keeps 0.3 "
        "to 0.4 %. In full float without friction, nothing could sustain a difference.",
    )
    return Chapter(
        "Fig. 13: limit ring clearance",
        f"all figures within {100 * worst:.1f} % (geometry fitted); pinion 5's overloaded branch "
        f"is {found.as_printed.branch}, in the paper 8-10",
        "fitted, with ample clearance predicted",
        blocks,
        {"rings": _ring_picture(seed, found)},
    )


def point_chapter(seed: Seed, found: Rings) -> Chapter:
    """Return the text on Fig. 14."""
    entries = fig14_entries(found)
    worst = max(abs(e.relative or 0.0) for e in entries)
    rows = []
    for p in PINIONS:
        radius = math.hypot(*printed.POINTS[p])
        there, own = printed.POINTS[p], found.as_printed.point(p)
        rows.append(
            (
                p,
                f"{radius:.3f}",
                f"{printed.THRESHOLDS[p]:.2f}",
                minus(f"{_angle(there):.2f}"),
                minus(f"{_angle(found.resting_point(p)):.2f}"),
                point(own, 3),
                found.resting.floats[p].state,
            )
        )
    beyond = [
        f"{100 * (found.thresholds[p] / math.hypot(*printed.POINTS[p]) - 1):.1f} % (pinion {p})"
        for p in PINIONS
    ]
    one = 1e6 * math.hypot(*found.resting.displacement["1"])
    four = math.hypot(*found.resting_point("4"))
    gears = seed.case("limit_ring").gears
    ratio = gears["2"].acting_radius / gears["4"].acting_radius
    blocks = (
        "The same case, with rings that end where the printed points are. The distance from the "
        "centre is therefore given; what is tested is the direction, and that both pinions press "
        "on their rings.",
        entries_table(entries),
        table(
            (
                "pinion",
                "distance of the printed point [µm]",
                "printed threshold [µm]",
                "printed direction [°]",
                "computed direction [°]",
                "computed point, ample ring [µm]",
                "state in the ring",
            ),
            rows,
        ),
        "{points}",
        f"On these rings all coordinates are within {100 * worst:.1f} %. The printed points are "
        "nearer to the centre than the printed thresholds, while a pinion that floats freely would "
        "be at the threshold. So the points belong to slightly smaller rings that the paper does "
        "not print, and lie on their boundaries, as it says. In ample rings, the computed points "
        f"are {listed(beyond)} further out.\n\n"
        f"The paper says that these floats are obviously larger than pinion 1's. Here pinion 1, "
        f"which is assumed to be free, moves by {one:.1f} µm and pinion 4 by {four:.1f} µm: a gap "
        f"at a pinion's base circle becomes {ratio:.1f} times as large at the radius of the face "
        "gear, where pinion 1 compensates it. The paper prints neither the support nor the float "
        "of pinion 1 in this figure.",
    )
    return Chapter(
        "Fig. 14: balance points",
        f"within {100 * worst:.1f} % on rings of that size; both pinions press on their rings",
        "direction fitted by the geometry",
        blocks,
        {"points": _point_picture(seed, found)},
    )


def _angle(point: tuple[float, float]) -> float:
    return math.degrees(math.atan2(point[1], point[0]))


def _geometry_text(found: Rings) -> str:
    header = ("weights", *geometry.NAMES, *geometry.FIGURES)
    paper = ("*paper*", "–", "–", "–", *(f"{v:g}" for v in geometry.PRINTED))
    spread = [(min(v), max(v)) for v in zip(*(g.values for g in found.geometries), strict=True)]
    return (
        "**What is fitted, and how well it is determined.** The paper prints no radius and no "
        "angle. The base radius r_b4 of pinion 4, the angle ψ of the idlers and the pressure angle "
        "α_t in the case files are fitted to these figures and those of Fig. 14. So Figs. 13 and "
        "14 do not test the geometry independently; but three numbers reproduce all their "
        "figures. Fits to the four figures below with other weights give:\n\n"
        + table(header, [*geometry.rows(list(found.geometries)), paper])
        + f"\n\nr_b4 between {spread[0][0]:.1f} and {spread[0][1]:.1f} mm, ψ between "
        f"{spread[1][0]:.2f}° and {spread[1][1]:.2f}° and α_t between {spread[2][0]:.1f}° and "
        f"{spread[2][1]:.1f}° fit about equally well: ψ is well determined, the other two are "
        "not. No geometry of this kind reproduces all four figures to the last digit."
    )


def _stiffness_text(found: Rings) -> str:
    rows = [
        (
            f"K of {kind} and its like",
            " … ".join(f"{end / 1e6:.2f}" for end in printed.STIFFNESS[kind]),
            f"{sum(printed.STIFFNESS[kind]) / 2e6:.3f}",
            # Two decimals, because the third is round-off for values that are not determined.
            f"{u.value / 1e6:.2f}" + (" (bound)" if u.at_bound else ""),
            f"{u.deviation / 1e6:.2f}" if math.isfinite(u.deviation) else "not determined",
        )
        for u, kind in zip(found.stiffness.unknowns, FITTED, strict=True)
    ]
    header = (
        "in MN·m/rad",
        "printed range",
        "case files: middle",
        "fitted",
        "standard deviation",
    )
    four, five = (d.computed for d in found.stiffness.comparison.deviations)
    covariance = found.stiffness.covariance
    apart = (
        "The two cannot be determined separately: only the compliance of a branch as a whole "
        "affects the shares."
        if not math.isfinite(covariance[0, 1])
        else f"Their covariance is {covariance[0, 1] / 1e12:.3g} (MN·m/rad)²."
    )
    return (
        "`ls.fit` on the two shares without float, stiffnesses of stage II within the printed "
        "ranges:\n\n"
        + table(header, rows)
        + f"\n\n{apart} The fit reaches {four:.4f} and {five:.4f}: the stiffness scales both "
        "imbalances alike, and their ratio follows from the geometry. The predictions on this page "
        "use the middle of the printed ranges."
    )


def _mirror_text(found: Rings) -> str:
    readings = {
        "as printed: ΔA_y9 = −0.1 mm": found.as_printed,
        "other sign: ΔA_y9 = +0.1 mm": found.mirrored,
        "other idler: ΔA_y8 = −0.1 mm": found.exchanged,
    }
    rows = [
        (name, v.branch, f"{pair_omega(v.held, '5'):.4f}", point(v.point("5"), 3))
        for name, v in readings.items()
    ]
    rows.append(("*paper*", "8-10", f"{printed.RIGID_RINGS['5']}", point(printed.POINTS["5"], 2)))
    header = ("", "overloaded branch", "Ω, clearance 0", "balance point of pinion 5, free [µm]")
    return (
        "**Mirrored ΔA_y9.** With the printed sign, pinion 5's overloaded branch is "
        f"{found.as_printed.branch}, in the paper 8-10. With the other sign it is "
        f"{found.mirrored.branch}, with the same Ω, but then the balance point of Fig. 14 moves to "
        "the other side. An error on the other idler is out of the question:\n\n"
        + table(header, rows)
        + "\n\nNo reading gives both. Either one of the two figures takes ΔA_y9 in a mirrored "
        "frame, or the names of the two branches are exchanged in Fig. 13. The values of Ω do not "
        "depend on this, so they can be compared."
    )


def _ring_picture(seed: Seed, found: Rings) -> Figure:
    panel = clearance_panel(
        seed,
        "rings",
        CLEARANCES,
        found.curves,
        found.thresholds,
        [
            *(Printed(0.0, v, f"{v}") for v in printed.RIGID_RINGS.values()),
            Printed(CLEARANCES[-1], printed.FREE_RINGS["4"], "1.004, 1.003", "left above"),
            Printed(CLEARANCES[-1], printed.FREE_RINGS["5"], ""),
            *(Printed(v, 1.0, f"{v} µm", "right above") for v in printed.THRESHOLDS.values()),
        ],
    )
    title = "Load sharing against the clearance of the limit rings"
    return picture("rings", title, "cross: printed", [panel])


def _point_picture(seed: Seed, found: Rings) -> Figure:
    panel = Panel(
        "",
        "displacement along x [µm]",
        "displacement along y [µm]",
        named(found.paths),
        looks(seed),
        "path of",
        printed=[
            Printed(
                x, y, f"paper ({x}, {signed(y, 2).lstrip('+')})", "left" if p == "4" else "right"
            )
            for p, (x, y) in printed.POINTS.items()
        ],
        true_to_shape=True,
    )
    title = "Balance points as the clearance of the rings grows"
    return picture("points", title, "cross: printed", [panel])
