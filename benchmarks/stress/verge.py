"""Problems on the verge: gap and force of a contact both zero, or a spline just about to slip.

Closed forms give these points. In a star with a fixed sun, a planet whose gap equals the deflection
of the others carries no load but is not open. A sun on a spring between two opposite planets, one
of them with the gap g, moves by g/(2 + k c), where c is the compliance of a branch along the line
of action; a ring or a stick limit of that size is just reached.
"""

from __future__ import annotations

import numpy as np

from benchmarks.stress.workbench import Workbench, star

SUN, RING = 0.036 * 1.5, 0.084 * 1.5
"""Pitch radii of the star's sun and ring [m]; only their ratios and cosines matter."""
FIRST, SECOND = 1.4e6, 7.5e5
"""Stiffnesses of the star's meshes [N·m/rad] at their drivers."""
RATIO = 24.0 / 36.0
"""Ratio of planet to sun."""


def branch_yield(torque: float, hertz: float) -> float:
    """Return the angle of the sun [rad] under which one branch carries `torque` [N·m]."""
    total = 0.0
    for stiffness, ratio in ((FIRST, 1.0), (SECOND, RATIO)):
        # The planet's angle, like its torque, is referred to the sun by the ratio of the radii.
        carried, rated = torque * ratio, 1e-3 * stiffness
        curved = hertz * np.cbrt(rated) * np.cbrt(carried) ** 2
        total += ratio * ((1.0 - hertz) * carried + curved) / stiffness
    return float(total)


def on_the_verge(off: float, generator: np.random.Generator) -> Workbench:
    """Build a train with a contact at a relative distance `off` from its verge, on either side."""
    kind = generator.choice(["flank", "ring", "spline", "stop"])
    side = 1.0 + off * generator.choice([-1.0, 1.0])
    torque = 1000.0 * float(generator.uniform(0.1, 1.0))
    if kind == "flank":
        planets = int(generator.integers(2, 7))
        hertz = float(generator.choice([0.0, 0.3, 1.0]))
        idle = int(generator.integers(1, planets))
        bench = star(planets, "rigid")
        if hertz:
            bench.hertz(hertz)
        for number in range(1, idle + 1):
            verge = branch_yield(torque / (planets - idle), hertz)
            bench.gap(f"sun-planet{number}", side * verge)
        bench.torque(torque)
        return bench
    bench = star(2)
    bench.torque(torque)
    radius = float(bench.data["gears"]["sun"]["base_radius"].split()[0]) * 1e-3
    compliance = (1.0 / FIRST + RATIO**2 / SECOND) * radius**2
    gap = 0.3 * torque / radius * compliance
    bench.gap("sun-planet1", gap / radius)
    stiffness = float(10.0 ** generator.uniform(5, 8))
    moved = gap / (2.0 + stiffness * compliance)
    if kind == "spline":
        bench.spline("sun", stiffness, 3.0 * moved, stiffness * moved * side)
    elif kind == "stop":
        bench.spline("sun", stiffness, moved * side, 100.0 * stiffness * moved)
    else:
        bench.support("sun", stiffness)
        bench.circle("sun", moved * side)
    return bench
