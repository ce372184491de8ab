"""Checks that splines, rings and bearings can act, and that no input is idle."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from loadshare.case.checks.fit import ANGLE_TOLERANCE, parallel
from loadshare.case.content import FLOATS
from loadshare.case.draft import Draft
from loadshare.case.line_of_action import centre_distance
from loadshare.case.links import Backlashes
from loadshare.case.place import minus
from loadshare.case.power_flow import rides_on
from loadshare.errors import Problem


def check_support(draft: Draft) -> Iterator[Problem]:
    """Yield splines, rings and bearings of gears that cannot move."""
    for section in FLOATS:
        for name in draft.names(section):
            gear = draft.gears.get(name)
            if gear is not None and gear.support == "rigid":
                message = f"cannot move, but there is {section}.{name}"
                hint = "Leave the support out, or make it free."
                yield draft.problem(("gears", name, "support"), message, hint=hint)


def check_spline_law(draft: Draft) -> Iterator[Problem]:
    """Yield splines whose force would drop as they move, or that have no room to slip."""
    for name, spline in draft.splines.items():
        bound, stiffness = spline.fixed_bound, spline.bending_stiffness.si
        stick = None if spline.stick_limit is None else spline.stick_limit.si
        # A stick limit F_m / K_w that was rounded in the file must not fail for its last digit.
        if bound is not None and stick is not None and stiffness * stick > bound * (1 + 1e-6):
            message = (
                f"the force would drop where slip begins: K_w S1 = {stiffness:g} N/m × {stick:g} m"
                f" = {stiffness * stick:g} N is above F_m = {bound:g} N"
            )
            hint = f"A stick_limit of {1e6 * bound / stiffness:.6g} um or less would do."
            yield draft.problem(("splines", name, "stick_limit"), message, hint=hint)
        if stick is not None and spline.clearance.si < stick:
            message = f"is below the stick limit of {1e6 * stick:g} um"
            yield draft.problem(("splines", name, "clearance"), message)


def check_ring_neighbours(draft: Draft) -> Iterator[Problem]:
    """Yield rings whose neighbours are not two other gears with parallel, separate axes."""
    for name, ring in draft.rings.items():
        if ring.neighbours is None:
            continue
        path = ("rings", name, "neighbours")
        if name in ring.neighbours or ring.neighbours[0] == ring.neighbours[1]:
            yield draft.problem(path, f"are not two different gears other than {name}")
            continue
        for number, neighbour in enumerate(ring.neighbours):
            own, other = draft.gears.get(name), draft.gears.get(neighbour)
            if own is None or other is None:
                continue
            if not parallel(own, other):
                message = f"its axis is not parallel to that of gear {name}"
                yield draft.problem((*path, number), message)
        together = next(_on_one_axis(draft, (name, *ring.neighbours)), None)
        if together is not None:
            message = f"{' and '.join(together)} are on one axis"
            hint = "A drum rolls on two other gears; each of the three needs its own axis."
            yield draft.problem(path, message, hint=hint)


def _on_one_axis(draft: Draft, names: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Yield pairs of gears that turn about the same axis, where all centres are known."""
    centres = draft.centres()
    if not centres.keys() >= set(names):
        return
    first, *others = gears = [draft.gears[name] for name in names]
    if rides_on(draft.gears, *names) or not all(parallel(first, other) for other in others):
        return  # Either is reported already.
    apart = {
        (one, two): centre_distance(first, minus(centres[two], centres[one]))
        for one, two in combinations(names, 2)
    }
    size = max(*apart.values(), *(gear.acting_radius for gear in gears if not gear.is_carrier))
    yield from (pair for pair, distance in apart.items() if distance <= ANGLE_TOLERANCE * size)


def check_float_backlashes(draft: Draft) -> Iterator[Problem]:
    """Yield float ranges that are to follow from backlashes that are not given."""
    for name, ring in draft.rings.items():
        if not isinstance(ring.float_, Backlashes):
            continue
        for side in ("upward", "downward"):
            for number, key in enumerate(getattr(ring.float_, side)):
                mesh = draft.meshes.get(key)
                if mesh is not None and not mesh.given("backlash", "normal_backlash"):
                    path = ("rings", name, "float", side, number)
                    yield draft.problem(path, "this mesh has no backlash", hint="Give it one.")


def check_idle_inputs(draft: Draft) -> Iterator[Problem]:
    """Yield keys that have no effect, because another is missing or the ring is a circle."""
    for name, mesh in draft.meshes.items():
        helical = mesh.helix_angle is not None and mesh.helix_angle.si
        if helical and not mesh.given("backlash", "normal_backlash"):
            message = "only converts a normal backlash into a transverse one, but"
            path = ("meshes", name, "helix_angle")
            cause = f'meshes."{name}".normal_backlash is missing'
            hint = "Give it, or drop the angle."
            yield draft.problem(path, f"{message} {cause}", hint=hint)
    for name, ring in draft.rings.items():
        if ring.radius is not None and "measured" in ring.model_fields_set:
            path = ("rings", name, "measured")
            message = "is for rings that roll on neighbours: a circle is fixed in the housing"
            yield draft.problem(path, message, hint="Leave it out.")
