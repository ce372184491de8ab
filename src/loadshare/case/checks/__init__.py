"""Checks across the elements of a case, each one rule, all of them run before any is reported."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, islice

from loadshare.case.checks import (
    carriers,
    fit,
    floats,
    flow,
    law_origin,
    layout,
    loads,
    meshing,
    names,
)
from loadshare.case.draft import MORE, Draft
from loadshare.errors import Problem
from loadshare.settings import ALLOWED

CHECKS = (
    names.check_gear_names,
    names.check_mesh_names,
    names.check_about_circles,
    names.check_pairs,
    meshing.check_list_lengths,
    layout.check_distances,
    fit.check_tooth_kinds,
    fit.check_racks,
    fit.check_fit,
    fit.check_formula_laws,
    law_origin.check_law_origins,
    loads.check_masses,
    loads.check_temperatures,
    fit.check_backlash_of_teeth,
    fit.check_tolerance_classes,
    layout.check_tips,
    layout.check_neighbours,
    layout.check_shafts,
    carriers.check_carriers,
    carriers.check_planet_meshes,
    carriers.check_names_of_planet_meshes,
    carriers.check_planet_shafts,
    carriers.check_held,
    carriers.check_twisted_shafts,
    carriers.check_planet_errors,
    floats.check_support,
    floats.check_spline_law,
    floats.check_ring_neighbours,
    floats.check_float_backlashes,
    names.check_stage_groups,
    names.check_measured_names,
    names.check_measured_positions,
    flow.check_taken_part,
    flow.check_output_reached,
    flow.check_loaded_meshes,
    flow.check_pressed_flanks,
    meshing.check_teeth_fit,
    meshing.check_turning,
    meshing.check_march_teeth,
    floats.check_idle_inputs,
    names.check_assumed_patterns,
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
    found = chain.from_iterable(rule(draft) for rule in CHECKS)
    yield from islice(found, ALLOWED.problems)
    if next(found, None) is not None:
        yield draft.problem((), MORE, "", "")
