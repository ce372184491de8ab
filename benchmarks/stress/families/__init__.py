"""The families, one a file, in the order of the map."""

from __future__ import annotations

from benchmarks.stress.families import (
    branches,
    free_pinion,
    friction,
    impossible,
    large_clearance,
    large_errors,
    light_load,
    lost_contact,
    no_load,
    parallel_contacts,
    sizes,
    soft_supports,
    stick_limit,
    stiffness_ratio,
    verge,
    wedging,
    zero_clearance,
)
from benchmarks.stress.problem import Family

FAMILIES: dict[str, Family] = {
    room.FAMILY.name: room.FAMILY
    for room in (
        stiffness_ratio,
        light_load,
        no_load,
        verge,
        lost_contact,
        zero_clearance,
        large_clearance,
        friction,
        stick_limit,
        parallel_contacts,
        soft_supports,
        free_pinion,
        wedging,
        large_errors,
        sizes,
        branches,
        impossible,
    )
}
"""All families by name."""
