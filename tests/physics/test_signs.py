"""Signs, sums and energies that any equilibrium has, on every shipped case.

Source: formulation, sections 2, 4 and 10. The sums are computed here from the gears' geometry, not
taken from the certificate.

Tolerance: round-off of the answer over the load of the case, 1e-9 as the certificate requires.
"""

import math
from functools import cache

import numpy as np
import pytest
from tests.support import EVERY_SHIPPED, answer, certified, potential, round_ring, shipped

import loadshare as ls
from benchmarks import families
from loadshare.results import Result
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.ring import DrumRing
from loadshare.train.situations import situation_of

SUM = 1e-9
every_case = pytest.mark.parametrize("name", EVERY_SHIPPED)


@cache
def solved(name: str) -> tuple[Train, list[Equilibrium]]:
    """Return the first two positions and the last."""
    train = build_train(shipped(name))
    indices = sorted({1, min(2, train.count), train.count})
    return train, [answer(train, index)[0] for index in indices]


@cache
def result_of(name: str) -> Result:
    return ls.solve(shipped(name))


@every_case
def test_contacts_only_push(name):
    _, answers = solved(name)
    for found in answers:
        assert min(found.flank_force.values()) >= 0.0
        assert min(found.ring_force.values(), default=0.0) >= 0.0


@every_case
def test_a_flank_does_not_push_both_ways_for_nothing(name):
    """A drive flank and its coast flank do not both carry: there is backlash between them.

    Only a gear pressed into its neighbour wedges both; the stress case's ring does that to pinion
    4.
    """
    train, answers = solved(name)
    for found in answers:
        for mesh in train.meshes.values():
            if 0.0 < mesh.backlash < math.inf:
                both = [found.flank_force[mesh.flank_name(d)] for d in (True, False)]
                # Only eccentric gears pressed into each other could do it. No shipped case has
                # that, except for the pinion that its ring presses into an idler.
                if min(both) > 0.0:
                    assert name == "fgfbstts/all_elements"
                    assert mesh.name == "4-6"


@every_case
def test_the_output_takes_the_sum_of_the_loads(name):
    """The torque on the output gear is the input torque over the speed ratio, whatever the branches
    carry.
    """
    train, answers = solved(name)
    if train.external:
        pytest.skip("a differential has two speeds, and no ratio")
    output = train.gears[train.output]
    for found in answers:
        taken = sum(
            (1 if drive else -1) * mesh.radii[1] * found.flank_force[mesh.flank_name(drive)]
            for mesh in train.meshes.values()
            for drive in mesh.flanks
            if mesh.driven == train.output
        )
        taken += on_carrier(train, found, train.output)
        given = situation_of(train, found.index).torques[train.input] / output.ratio
        # Radii have seven digits, so two paths' ratios differ in the seventh.
        assert taken == pytest.approx(given, rel=1e-6)


@every_case
def test_the_first_stage_takes_the_input_torque(name):
    result = result_of(name)
    train = build_train(shipped(name))
    for position in result.positions:
        first = sum(position.torque[m] for m in result.stages["I"])
        if train.gears[train.input].kind == "carrier":
            first = -on_carrier(train, position.equilibrium, train.input)
        given = situation_of(train, position.position).torques[train.input]
        assert first == pytest.approx(given, rel=SUM)


def on_carrier(train: Train, found: Equilibrium, carrier: str) -> float:
    """Return the moment of its planets' meshes on a carrier [N·m], in its running sense."""
    held, total = train.gears[carrier], 0.0
    for mesh in train.meshes.values():
        for drive in mesh.flanks:
            push = found.flank_force[mesh.flank_name(drive)] * mesh.direction(drive)[2]
            for end, force in ((mesh.driver, -push), (mesh.driven, push)):
                if train.gears[end].carrier == carrier:
                    arm = train.gears[end].centre - held.centre
                    total += held.sense * float(held.axis @ np.cross(arm, force))
    return total


@every_case
def test_forces_on_a_float_balance(name):
    """Forces of flanks, rings, splines and bearing on every gear that can move add up to zero."""
    train, answers = solved(name)
    for found in answers:
        load = max(found.flank_force.values())
        for gear, body in train.gears.items():
            if body.support is None:
                continue
            total = -(body.support * (body.frame @ found.displacement[gear])) @ body.frame
            for mesh in train.meshes.values():
                for drive in mesh.flanks:
                    push = found.flank_force[mesh.flank_name(drive)] * mesh.direction(drive)[2]
                    for end, force in ((mesh.driver, -push), (mesh.driven, push)):
                        # A force on a planet reaches its carrier through the pin.
                        if gear in (end, train.gears[end].carrier):
                            total = total + force
            for ring in train.rings.values():
                total = total + ring_force(train, found, ring, gear)
            for element in (f"spline {gear}", f"ring {gear}"):
                total = total + found.radial_reaction.get(element, np.zeros(3))
            assert np.linalg.norm(body.frame @ total) < SUM * load, (gear, found.index)


def ring_force(train: Train, found: Equilibrium, ring: object, gear: str) -> np.ndarray:
    """Return the force of a drum ring on `gear` [N]: stops on the limited gear, arcs on both."""
    total = np.zeros(3)
    if not isinstance(ring, DrumRing):
        return total
    if gear == ring.gear:
        up, down = (found.ring_force[n] for n in ring.stop_names)
        total = (down - up) * ring.across
    for neighbour in ring.neighbours:
        between = train.gears[ring.gear].centre - train.gears[neighbour].centre
        between = between + found.displacement[ring.gear] - found.displacement[neighbour]
        push = found.ring_force[ring.arc_name(neighbour)] * between / np.linalg.norm(between)
        total = total + push * ((gear == ring.gear) - (gear == neighbour))
    return total


@every_case
def test_coefficients_average_to_one(name):
    """The mean of Ω over a stage is 1, that of the pairwise Ω over every group too, and the largest
    is reported.
    """
    result = result_of(name)
    train = build_train(shipped(name))
    for stage in train.stages:
        for position in result.positions:
            mean = np.mean([position.share[m] for m in stage.meshes])
            assert mean == pytest.approx(1.0, abs=1e-12)
            for group in stage.groups:
                mean = np.mean([position.pair_share[m] for m in group])
                assert mean == pytest.approx(1.0, abs=1e-12)
        largest = max(p.share[m] for p in result.positions for m in stage.meshes)
        assert result.omega[stage.name] == largest
    assert result.omega["system"] == max(result.omega[s.name] for s in train.stages)


RELAXED = {
    "a free pinion": lambda: (
        shipped("fgfbstts/both_errors"),
        shipped("fgfbstts/both_errors").replace({"gears.1.support": "free"}),
    ),
    "a softer bearing": lambda: (
        shipped("fgfbstts/both_errors").replace({"gears.6.support": "5.5e8 N/m"}),
        shipped("fgfbstts/both_errors").replace({"gears.6.support": "5.5e7 N/m"}),
    ),
    "a wider drum": lambda: (
        shipped("fgfbstts/limit_ring"),
        shipped("fgfbstts/limit_ring").replace({"rings.5.float": "2.9 um"}),
    ),
    "a wider circle": lambda: (round_ring(), round_ring().replace({"rings.sun.radius": "4 um"})),
    "a softer circle": lambda: (round_ring(), round_ring("1e9 N/m")),
    "more spline clearance": lambda: (
        shipped("fgfbstts/spline_clearance"),
        shipped("fgfbstts/full_float"),
    ),
    "less friction": lambda: (
        shipped("fgfbstts/full_float"),
        shipped("fgfbstts/full_float").replace({"splines.4.normal_force": "100 N"}),
    ),
    "a floating sun": lambda: (families.star(4, floating=False), families.star(4)),
}


@pytest.mark.parametrize("change", RELAXED)
def test_energy_falls_when_a_loaded_constraint_is_relaxed(change):
    """An equilibrium is a minimum of energy: with more freedom it is lower, because the constraint
    carried force.
    """
    tight, loose = RELAXED[change]()
    energies = [potential(build_train(c), certified(c)[0]) for c in (tight, loose)]
    assert energies[1] < energies[0] - 1e-9 * abs(energies[0])
