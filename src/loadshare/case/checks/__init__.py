"""Checks across the elements of a case, each one rule, all of them run before any is reported."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.checks.assumed import check_assumed_patterns
from loadshare.case.checks.fit import check_fit, check_tooth_kinds
from loadshare.case.checks.floats import (
    check_float_backlashes,
    check_ring_neighbours,
    check_spline_law,
    check_support,
)
from loadshare.case.checks.flow import (
    check_loaded_meshes,
    check_output_reached,
    check_pressed_flanks,
    check_taken_part,
)
from loadshare.case.checks.idle import check_idle_inputs
from loadshare.case.checks.measured import check_measured_names, check_measured_positions
from loadshare.case.checks.names import (
    check_about_circles,
    check_gear_names,
    check_mesh_names,
    check_pairs,
)
from loadshare.case.checks.positions import check_list_lengths
from loadshare.case.checks.stages import check_stage_groups
from loadshare.case.checks.turning import (
    check_march_teeth,
    check_teeth_fit,
    check_turning,
)
from loadshare.case.draft import Draft
from loadshare.errors import Problem

CHECKS = (
    check_gear_names,
    check_mesh_names,
    check_about_circles,
    check_pairs,
    check_list_lengths,
    check_tooth_kinds,
    check_fit,
    check_support,
    check_spline_law,
    check_ring_neighbours,
    check_float_backlashes,
    check_stage_groups,
    check_measured_names,
    check_measured_positions,
    check_taken_part,
    check_output_reached,
    check_loaded_meshes,
    check_pressed_flanks,
    check_teeth_fit,
    check_turning,
    check_march_teeth,
    check_idle_inputs,
    check_assumed_patterns,
)


def check(draft: Draft) -> Iterator[Problem]:
    """Yield the problems across the valid elements of a case.

    Parameters
    ----------
    draft : Draft
        The elements that were read.

    Yields
    ------
    Problem
        What is wrong between them.
    """
    for rule in CHECKS:
        yield from rule(draft)
