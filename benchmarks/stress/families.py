"""The families of problems, in the order of the map, each with its knob and the knob's levels."""

from __future__ import annotations

from benchmarks.stress import builders
from benchmarks.stress.problem import Family
from benchmarks.stress.verge import on_the_verge
from benchmarks.stress.without_answer import without_answer

DECADES = tuple(10.0**k for k in range(13))
NEARLY_ONE = (1.0, 1.0 - 1e-15, 1.0 - 1e-12, 1.0 - 1e-9, 1.0 - 1e-6)

_TABLE = (
    Family(
        "stiffness-ratio", "stiffness ratio", "stiffest over softest [-]",
        DECADES, builders.spread_stiffnesses,
    ),
    Family(
        "light-load", "light load, c > 0", "load over rated [-]",
        tuple(10.0**-k for k in range(10)), builders.lightly_loaded,
    ),
    Family(
        "no-load", "load exactly zero", "errors over deflection [-]",
        (0.0, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0), builders.without_load,
    ),
    Family(
        "verge", "contact on the verge", "distance from the verge [-]",
        (1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-15, 0.0), on_the_verge,
    ),
    Family(
        "lost-contact", "contact lost", "part of the branches that are lost [-]",
        (0.01, 0.25, 0.5, 0.75, 1.0), builders.contacts_lost,
    ),
    Family(
        "zero-clearance", "zero clearance everywhere", "errors over deflection [-]",
        (0.0, 1e-6, 1e-3, 0.03, 0.3, 1.0, 3.0, 10.0), builders.without_play,
    ),
    Family(
        "large-clearance", "clearance without end", "clearance over deflection [-]",
        (1.0, 3.0, 10.0, 30.0, 100.0, 1e3, 1e4, 1e5), builders.wide_play,
    ),
    Family(
        "friction", "friction", "friction over 1 kN [-]",
        (1.0, 0.1, 1e-3, 1e-6, 1e-9, 1e-12, 0.0, 10.0, 1e3, 1e6, 1e9), builders.rubbing_splines,
    ),
    Family(
        "stick-limit", "stick limit, jumping law", "K_w S1 over F_m [-]",
        (*NEARLY_ONE, 0.9, 0.5, 0.1, 1e-3, 1e-6, 1e-9, 0.0), builders.jumping_splines,
    ),
    Family(
        "parallel-contacts", "redundant, nearly parallel", "angle between normals [rad]",
        (0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0.0), builders.nearly_parallel,
    ),
    Family(
        "soft-supports", "rigid beside very soft", "softness [-]",
        DECADES, builders.softly_supported,
    ),
    Family(
        "free-pinion", "float without support", "bend off the line [rad]",
        (0.0, 0.001, 0.01, 0.03, 0.1, 0.3, 0.5), builders.unsupported,
    ),
    Family(
        "wedging", "wedged between neighbours", "pressed in, over deflection [-]",
        (0.0, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0), builders.wedged,
    ),
    Family(
        "large-errors", "errors beyond the deflection", "errors over deflection [-]",
        (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0), builders.displaced_far,
    ),
    Family(
        "sizes", "micro to macro", "scale [-]",
        (1.0, 3.0, 10.0, 100.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6), builders.scaled,
    ),
    Family(
        "branches", "2 to 64 branches", "branches [-]",
        (2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 56, 64), builders.of_many_branches,
    ),
    Family(
        "impossible", "no answer exists", "what is missing, relative [-]",
        (10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01, 1e-3), without_answer,
    ),
)  # fmt: skip
FAMILIES: dict[str, Family] = {family.name: family for family in _TABLE}
"""All families by name."""
