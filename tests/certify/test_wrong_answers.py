"""The certificate refuses wrong answers of every kind, and names what is wrong with them.

Source: formulation, section 8. Each scenario is solved once; then one thing in the answer is
altered, and the residual that must show it is named together with the element. Nothing here depends
on how the answer was found.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from tests.support import answer, coasting, lost_contact, round_ring, shipped

from benchmarks import families
from loadshare.certify import Certificate, certify
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of

SCENARIOS = {
    "drum ring": lambda: shipped("fgfbstts/limit_ring"),
    "slipping spline": lambda: shipped("fgfbstts/full_float"),
    "spline stop": lambda: shipped("fgfbstts/spline_clearance"),
    "every element": lambda: shipped("fgfbstts/all_elements"),
    "lost contact": lost_contact,
    "round ring": round_ring,
    "elastic round ring": lambda: round_ring("5e8 N/m"),
    "coast flanks": coasting,
    "two path": lambda: families.two_path("1.2 mrad"),
}


@dataclass(frozen=True)
class Wrong:
    """An altered answer, the residual that must show it, and the element (None: any)."""

    what: str
    answer: Equilibrium
    residual: str
    where: str | None


@cache
def solved(scenario: str) -> tuple[Train, Equilibrium]:
    train = build_train(SCENARIOS[scenario]())
    found, _ = answer(train)
    assert certify(train, found).passed
    return train, found


def altered(found: Equilibrium, field: str, changes: Mapping[str, object]) -> Equilibrium:
    return replace(found, **{field: {**getattr(found, field), **changes}})


def deflection(train: Train, found: Equilibrium) -> float:
    return certify(train, found).deflection


def load(train: Train, found: Equilibrium) -> float:
    return certify(train, found).load


def flipped_flank(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    for name, force in found.flank_force.items():
        if force > 0.0:
            answer = altered(found, "flank_force", {name: -force})
            yield Wrong(name, answer, "cone_membership", name)


def scaled_flank(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    for name, force in found.flank_force.items():
        if force > 0.0:
            answer = altered(found, "flank_force", {name: 1.001 * force})
            yield Wrong(name, answer, "deformation_law", name)


def scaled_everything(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Make all forces and displacements slightly too large: only the external torque disagrees."""
    grown = {
        field: {k: 1.001 * v for k, v in getattr(found, field).items()}
        for field in ("flank_force", "ring_force", "radial_reaction", "displacement", "rotation")
    }
    yield Wrong("everything", replace(found, **grown), "moment_balance", None)


def missing_contact(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    for name, force in found.flank_force.items():
        if force > 0.0:
            yield Wrong(name, altered(found, "flank_force", {name: 0.0}), "penetration", name)


def force_on_open_flank(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Give an open flank a small force: it must not push at all."""
    for name, force in found.flank_force.items():
        if force == 0.0:
            push = 1e-4 * load(train, found)
            answer = altered(found, "flank_force", {name: push})
            yield Wrong(name, answer, "complementarity", name)


def pulling_ring(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    for name in found.ring_force:
        pull = -1e-3 * load(train, found)
        yield Wrong(name, altered(found, "ring_force", {name: pull}), "cone_membership", name)


def missing_ring_force(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    for name, force in found.ring_force.items():
        if force > 1e-6 * load(train, found):
            gear = name.removeprefix("ring ").split(":")[0]
            answer = altered(found, "ring_force", {name: 0.0})
            yield Wrong(name, answer, "force_balance", gear)


def shifted_float(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Move a gear off its place, along each of its two directions that the answer determines."""
    for gear, body in train.gears.items():
        for axis, way in zip("xy", body.frame, strict=True):
            if body.support is None or f"gear {gear} {axis}" in found.undetermined:
                continue
            moved = found.displacement[gear] + 1e-3 * deflection(train, found) * way
            answer = altered(found, "displacement", {gear: moved})
            yield Wrong(f"{gear} {axis}", answer, "deformation_law", None)


def beyond_the_ring(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    for ring in train.rings.values():
        far = 10.0 * deflection(train, found)
        if hasattr(ring, "radius"):
            moved = found.displacement[ring.gear] + far * train.gears[ring.gear].frame[0]
            # An elastic ring has no reach: its graph and the reaction then disagree.
            shows = "penetration" if math.isinf(ring.stiffness) else "cone_membership"
            answer = altered(found, "displacement", {ring.gear: moved})
            yield Wrong(ring.name, answer, shows, None)
            continue
        for name, sign in zip(ring.stop_names, (1.0, -1.0), strict=True):
            moved = found.displacement[ring.gear] + sign * far * ring.across
            answer = altered(found, "displacement", {ring.gear: moved})
            yield Wrong(name, answer, "penetration", None)


def beyond_the_neighbour(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Mirror the limited gear at its neighbour, where the arc's inequality holds."""
    for ring in train.drums:
        for side, neighbour in enumerate(ring.neighbours):
            arc = situation_of(train, found.index).arc(ring, side)
            relative = found.displacement[ring.gear] - found.displacement[neighbour]
            far = found.displacement[ring.gear] - 2.0 * (arc.start + relative)
            answer = altered(found, "displacement", {ring.gear: far})
            yield Wrong(ring.arc_name(neighbour), answer, "penetration", None)


def rigid_gear_moved(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Let a rigid bearing give way, or a floating gear leave its plane."""
    for name, gear in train.gears.items():
        way = gear.frame[0] if gear.support is None else gear.axis
        moved = found.displacement[name] + 1e-3 * deflection(train, found) * way
        answer = altered(found, "displacement", {name: moved})
        yield Wrong(name, answer, "deformation_law", None)


def rotated_gear(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    for name, gear in train.gears.items():
        if f"gear {name} rotation" in found.undetermined:
            continue
        angle = found.rotation[name] + 1e-3 * deflection(train, found) / gear.base_radius
        answer = altered(found, "rotation", {name: angle})
        # The error of a gear that touches nothing shows as an overlap.
        touching = any(
            found.flank_force[n] > 0.0
            for n, m in train.meshes.items()
            if name in (m.driver, m.driven)
        )
        yield Wrong(name, answer, "deformation_law" if touching else "penetration", None)


def swapped_meshes(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Exchange two meshes of one stage that carry different forces."""
    for stage in train.stages:
        a, b = (
            min(stage.meshes, key=found.flank_force.get),
            max(stage.meshes, key=found.flank_force.get),
        )
        low, high = found.flank_force[a], found.flank_force[b]
        if high - low > 1e-6 * load(train, found):
            answer = altered(found, "flank_force", {a: high, b: low})
            yield Wrong(f"{a} and {b}", answer, "deformation_law", None)


def turned_reaction(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Tilt a reaction of a round ring or a spline away from the offset."""
    for pull in (*train.splines.values(), *train.rings.values()):
        name = getattr(pull, "name", None)
        if name not in found.radial_reaction:
            continue
        force = found.radial_reaction[name]
        tilted = force + 1e-3 * np.cross(train.gears[pull.gear].axis, force)
        answer = altered(found, "radial_reaction", {name: tilted})
        yield Wrong(name, answer, "cone_membership", name)


def wrong_size_of_reaction(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Make a reaction larger than the friction bound or the ring's spring gives; on a rigid ring,
    larger than balance allows.
    """
    for pull in (*train.splines.values(), *train.rings.values()):
        name = getattr(pull, "name", None)
        if name not in found.radial_reaction:
            continue
        rigid = math.isinf(getattr(pull, "stiffness", 0.0))
        answer = altered(found, "radial_reaction", {name: 1.001 * found.radial_reaction[name]})
        shows, where = ("force_balance", pull.gear) if rigid else ("cone_membership", name)
        yield Wrong(name, answer, shows, where)


def pulling_reaction(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Make a reaction push outwards."""
    for name, force in found.radial_reaction.items():
        answer = altered(found, "radial_reaction", {name: -force})
        yield Wrong(name, answer, "cone_membership", name)


def other_position(train: Train, found: Equilibrium) -> Iterator[Wrong]:
    """Claim the right answer of a position for another position, if the two differ."""
    if train.count > 1 and train.march is not None:
        yield Wrong("position 2", replace(found, index=2), "deformation_law", None)


SLIPS: dict[str, Callable[[Train, Equilibrium], Iterator[Wrong]]] = {
    slip.__name__: slip
    for slip in (
        flipped_flank, scaled_flank, scaled_everything, missing_contact, force_on_open_flank,
        pulling_ring, missing_ring_force, shifted_float, beyond_the_ring,
        beyond_the_neighbour, rigid_gear_moved,
        rotated_gear, swapped_meshes, turned_reaction, wrong_size_of_reaction, pulling_reaction,
        other_position,
    )
}  # fmt: skip
"""Ways to spoil an answer."""


def applies(slip: str, scenario: str) -> bool:
    return next(SLIPS[slip](*solved(scenario)), None) is not None


@pytest.mark.parametrize("slip", SLIPS)
def test_every_way_to_be_wrong_is_tried(slip):
    assert any(applies(slip, scenario) for scenario in SCENARIOS)


@pytest.mark.parametrize("scenario", SCENARIOS)
@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.quick(8)
def test_a_wrong_answer_is_refused_and_the_right_residual_says_so(slip, scenario):
    train, found = solved(scenario)
    for wrong in SLIPS[slip](train, found):
        verdict = certify(train, wrong.answer)
        assert not verdict.passed, wrong.what
        assert wrong.residual in verdict.failing, (wrong.what, verdict.failing)
        if wrong.where is not None:
            assert verdict.residuals[wrong.residual].where == wrong.where, wrong.what


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_what_is_not_a_number_is_refused_wherever_it_stands(scenario, wrong):
    train, found = solved(scenario)
    fields = ("rotation", "flank_force", "ring_force", "displacement", "radial_reaction")
    for field in fields:
        for name, old in getattr(found, field).items():
            nan = np.full(3, wrong) if isinstance(old, np.ndarray) else wrong
            verdict = certify(train, altered(found, field, {name: nan}))
            assert not verdict.passed, (field, name)
            assert verdict.failing, (field, name)


@pytest.mark.parametrize("scenario", SCENARIOS)
@pytest.mark.quick(3)
def test_the_certificate_answers_in_proportion(scenario):
    """A misfit just below the tolerance passes, one just above it fails, for every loaded contact.

    Whether the torques are then bounded closely enough is another question. The residual is
    proportional to the misfit, so its slope at a thousand tolerances shows where the tolerance is
    crossed. The slope itself is near 1: the certificate neither overlooks a force nor magnifies
    round-off. 20 % on either side allow for the right answer's own residual (below 1e-12) and for
    curvature.
    """
    train, found = solved(scenario)
    scale = load(train, found)
    for field in ("flank_force", "ring_force"):
        carrying = {n: f for n, f in getattr(found, field).items() if f > 1e-5 * scale}
        for name, force in carrying.items():

            def verdict(size: float, field=field, name=name, force=force) -> Certificate:
                return certify(train, altered(found, field, {name: force + size * scale}))

            slope = verdict(1e-6).worst / 1e-6
            assert 1e-2 < slope < 1e2, name
            assert verdict(0.8e-9 / slope).failing == {}, name
            assert not verdict(1.2e-9 / slope).passed, name


@pytest.mark.parametrize("tolerance", [1e-6, 1e-12])
def test_the_tolerance_is_the_callers(tolerance):
    train, found = solved("two path")
    (name, force), *_ = found.flank_force.items()
    wrong = altered(found, "flank_force", {name: force * (1.0 + 1e-9)})
    verdict = certify(train, wrong, tolerance)
    assert verdict.tolerance == tolerance
    assert verdict.passed == (tolerance == 1e-6)


def test_a_free_displacement_does_not_blind_the_certificate():
    """Pinion 1 may be anywhere along its free direction; other errors must still be found."""
    train = build_train(shipped("fgfbstts/limit_ring"))
    other = {"errors.6.installation": ["0 um", "100.4 um"], "rings.4.float": "8.3 um"}
    found, _ = answer(build_train(shipped("fgfbstts/limit_ring").replace(other)))
    free = np.cross(train.gears["1"].axis, train.meshes["1-2"].drive_normal)
    far = found.displacement["1"] + 1e3 * free / np.linalg.norm(free)
    assert not certify(train, altered(found, "displacement", {"1": far})).passed


def test_a_preload_between_rigid_stops_does_not_blind_the_certificate():
    """Two opposite stops may press each other with any force; other errors must still be found."""
    case = shipped("fgfbstts/limit_ring").replace({"rings.4.float": "0 um"})
    train = build_train(case)
    found, _ = answer(build_train(case.replace({"operating.power": "1998 kW"})))
    up, down = train.rings["4"].stop_names
    pressed = {up: found.ring_force[up] + 1e13, down: found.ring_force[down] + 1e13}
    assert not certify(train, altered(found, "ring_force", pressed)).passed


def test_a_torque_at_which_a_spline_has_no_law_is_refused():
    """With S1 fixed and F_m from the torque, a claim of zero torque makes the spline's law drop."""
    spline = {
        "bending_stiffness": "1.78e7 N/m",
        "clearance": "100 um",
        "stick_limit": "5 um",
        "friction": 0.1,
        "radius": "5 m",
    }
    train = build_train(shipped("fgfbstts/both_errors").replace({"splines": {"4": spline}}))
    found, _ = answer(train)
    assert certify(train, found).passed
    verdict = certify(train, altered(found, "flank_force", {"4-6": 0.0, "4-7": 0.0}))
    assert not verdict.passed
    assert "spline 4" in verdict.failing["cone_membership"].where
