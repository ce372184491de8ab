"""Checks across the elements of a case: one function per rule, all run before any is reported."""

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
CHECKS: Mapping[Rule, tuple[str, ...]] = {
    names.check_gear_names: (),
    names.check_mesh_names: (),
    names.check_about_circles: (),
    names.check_pairs: (),
    meshing.check_list_lengths: (),
    layout.check_distances: ("gears",),
    fit.check_tooth_kinds: ("gears",),
    fit.check_racks: ("gears",),
    fit.check_fit: ("gears", "meshes"),
    fit.check_formula_laws: ("gears",),
    law_origin.check_law_origins: ("gears",),
    loads.check_external: (),
    loads.check_masses: ("gears",),
    loads.check_temperatures: ("gears",),
    fit.check_backlash_of_teeth: ("gears",),
    fit.check_tolerance_classes: ("gears",),
    layout.check_tips: ("gears",),
    layout.check_neighbours: ("gears",),
    layout.check_shafts: ("gears",),
    carriers.check_carriers: ("gears",),
    carriers.check_planet_meshes: ("gears",),
    carriers.check_names_of_planet_meshes: ("gears", "meshes"),
    carriers.check_planet_shafts: ("gears",),
    carriers.check_held: ("gears",),
    carriers.check_twisted_shafts: ("gears",),
    carriers.check_clockings: ("gears", "shafts"),
    carriers.check_planet_errors: ("gears",),
    floats.check_support: ("gears",),
    floats.check_spline_law: ("gears", "splines"),
    floats.check_ring_neighbours: ("gears",),
    floats.check_float_backlashes: ("gears",),
    names.check_stage_groups: (),
    names.check_measured_names: (),
    names.check_measured_positions: (),
    flow.check_taken_part: (),
    flow.check_output_reached: (),
    flow.check_loaded_meshes: (),
    flow.check_pressed_flanks: ("operating",),
    meshing.check_teeth_fit: ("gears",),
    meshing.check_turning: ("gears", "errors"),
    meshing.check_march_teeth: ("gears", "meshes"),
    floats.check_idle_inputs: ("gears", "meshes"),
    names.check_assumed_patterns: (),
}
"""All rules, each with the sections whose physical values it uses. Names, words, counts, and which
keys are given may matter to every rule."""


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
    """Return the rules whose findings in a draft may differ from those in an earlier case."""
    changed = set()
    for name in Content.model_fields:
        now, then = getattr(draft, name), getattr(before, name)
        if now is then or not (now or then):
            continue
        if not same_but_for_values(now, then):
            return CHECKS
        changed.add(name)
    return [rule for rule, sections in CHECKS.items() if not changed.isdisjoint(sections)]
