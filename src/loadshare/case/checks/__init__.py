"""Checks across the elements of a case, each one rule, all of them run before any is reported."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from itertools import chain, islice
from typing import TypeAlias

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
from loadshare.case.content import Content
from loadshare.case.draft import MORE, Draft
from loadshare.case.element import same_but_for_values
from loadshare.errors import Problem
from loadshare.settings import ALLOWED

Rule: TypeAlias = Callable[[Draft], Iterator[Problem]]
CHECKS: tuple[Rule, ...] = (
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
    carriers.check_clockings,
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

LOOK_AT_VALUES: Mapping[Rule, frozenset[str]] = {
    carriers.check_names_of_planet_meshes: frozenset({"meshes"}),
    carriers.check_clockings: frozenset({"shafts"}),
    fit.check_fit: frozenset({"meshes"}),
    floats.check_spline_law: frozenset({"splines"}),
    floats.check_idle_inputs: frozenset({"meshes"}),
    flow.check_pressed_flanks: frozenset({"operating"}),
    meshing.check_turning: frozenset({"errors"}),
    meshing.check_march_teeth: frozenset({"meshes"}),
}
"""Rules for which physical values of sections other than the gears matter, and of which."""

LOOK_AT_NO_GEAR: frozenset[Rule] = frozenset(
    {
        names.check_gear_names,
        names.check_mesh_names,
        names.check_about_circles,
        names.check_pairs,
        names.check_stage_groups,
        names.check_measured_names,
        names.check_measured_positions,
        names.check_assumed_patterns,
        meshing.check_list_lengths,
        flow.check_taken_part,
        flow.check_output_reached,
        flow.check_loaded_meshes,
        flow.check_pressed_flanks,
    }
)
"""Rules for which no physical value of a gear matters: of gears, they look at names, words and
counts, and at what is given, as all rules do."""


def check(draft: Draft, before: Content | None = None) -> Iterator[Problem]:
    """Yield the problems across the valid elements of a case.

    Parameters
    ----------
    draft : Draft
        The elements that were read.
    before : Content, optional
        A case without problems: rules for which nothing has changed since are left out.

    Yields
    ------
    Problem
        What is wrong between them.
    """
    rules = CHECKS if before is None else _concerned(draft, before)
    found = chain.from_iterable(rule(draft) for rule in rules)
    yield from islice(found, ALLOWED.problems)
    if next(found, None) is not None:
        yield draft.problem((), MORE, "", "")


def _concerned(draft: Draft, before: Content) -> Collection[Rule]:
    """Rules that may find something in a draft other than in a case before."""
    changed = set()
    for name in Content.model_fields:
        now, then = getattr(draft, name), getattr(before, name)
        if now is then or not (now or then):
            continue
        if not same_but_for_values(now, then):
            return CHECKS
        changed.add(name)
    return [rule for rule in CHECKS if changed & _values_for(rule)]


def _values_for(rule: Rule) -> frozenset[str]:
    """Sections whose physical values matter to a rule."""
    gears = frozenset() if rule in LOOK_AT_NO_GEAR else frozenset({"gears"})
    return gears | LOOK_AT_VALUES.get(rule, frozenset())
