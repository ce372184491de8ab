"""Every prescribed displacement does work, and the energies of the certificate include it.

Source: formulation, section 8. Clocking, gaps, backlash, errors, clearances, ring offsets and slips
of the previous position are displacements that a case prescribes: a force F over a prescribed
displacement d adds F d to the complementary energy. Each work is computed here from forces and case
alone; it is more than a ten-thousandth of the case's work, so a certificate that left it out would
refuse.
"""

from collections.abc import Callable

import numpy as np
import pytest
from tests.support import answer, coasting, round_ring, shipped

import loadshare as ls
from benchmarks import families
from loadshare.certify import RESIDUALS, Judge, certify
from loadshare.study.memory.step import stepped
from loadshare.train import Train, build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of

LEAST = 1e-4
"""Smallest work of a prescribed displacement, over load times deflection, that cannot be
overlooked."""

Work = Callable[[Train, Equilibrium], float]


def clocked(stiffness: str, turned: bool = False) -> ls.Case:
    """Return a split-path box with a clocked shaft, named from either end."""
    case = families.two_path("1.2 mrad")
    shaft = {"stiffness": stiffness, "clocking": "1.2 mrad"}
    name = "pinionA-wheelA" if turned else "wheelA-pinionA"
    return case.replace({"shafts.wheelA-pinionA": None, f"shafts.{name}": shaft, "assumed": []})


def on_the_output() -> ls.Case:
    """Return the same with the output gear itself behind two clocked rigid shafts."""
    case = families.two_path("1.2 mrad")
    height = [*case.to_dict()["gears"]["out"]["centre"][:2]]
    behind = {
        f"gears.{name}": {"centre": [*height, f"{z} mm"], "base_radius": "50 mm"}
        for name, z in (("flange", 200), ("hub", 300))
    }
    shafts = {
        "shafts.out-flange": {"stiffness": "rigid", "clocking": "0.3 mrad"},
        "shafts.hub-flange": {"stiffness": "rigid", "clocking": "0.8 mrad"},
    }
    return case.replace({**behind, **shafts, "operating.output": "hub"})


def shaft_work(shaft: str, gear: str) -> Work:
    """Return T β of a shaft; T, from first to second, is the torque transmitted to a gear."""

    def work(train: Train, found: Equilibrium) -> float:
        ends = train.shafts[shaft]
        sign = 1.0 if gear == ends.first else -1.0
        return sign * train.transmitted(gear, found.flank_force) * ends.clocking

    return work


def flank_work(flank: str, part: str) -> Work:
    """Return F times gap, backlash or errors along the line of action."""

    def work(train: Train, found: Equilibrium) -> float:
        here = situation_of(train, found.index)
        mesh = next(m for m in train.meshes.values() for d in m.flanks if m.flank_name(d) == flank)
        drive = flank == mesh.flank_name(True)
        lengths = {
            "gap": mesh.gap(train.flank_positions(found.index)[flank], drive),
            "backlash": mesh.gap(train.flank_positions(found.index)[flank], drive),
            "error": mesh.direction(drive)[2]
            @ (here.offset_of(mesh.driver) - here.offset_of(mesh.driven)),
        }
        return found.flank_force[flank] * float(lengths[part])

    return work


def contact_work(contact: str, length: float) -> Work:
    """Return the force of a ring's contact times its float or clearance."""
    return lambda train, found: found.ring_force[contact] * length


def drawn_arc_work(train: Train, found: Equilibrium) -> float:
    """Return the force of the arc towards gear 6 times the errors' shift along its normal."""
    arc = situation_of(train, found.index).arc(train.rings["4"], 1)
    push = found.ring_force[train.rings["4"].arc_name("6")]
    return push * float(arc.normal(np.zeros(3)) @ arc.shift)


def offset_work(train: Train, found: Equilibrium) -> float:
    return float(found.radial_reaction["ring sun"] @ train.rings["sun"].offset)


def arcs(**changes: object) -> ls.Case:
    """Return limit rings with a clearance, so narrow that stop and arc carry."""
    return shipped("fgfbstts/limit_ring").replace(
        {"rings.4.clearance": "1 um", "rings.4.float": "2 um", **changes}
    )


CASES: dict[str, tuple[Callable[[], ls.Case], Work]] = {
    "clocking of an elastic shaft": (
        lambda: clocked("8e4 N*m/rad"),
        shaft_work("wheelA-pinionA", "wheelA"),
    ),
    "clocking of a rigid shaft": (lambda: clocked("rigid"), shaft_work("wheelA-pinionA", "wheelA")),
    "clocking of a rigid shaft named from its other end": (
        lambda: clocked("rigid", turned=True),
        shaft_work("pinionA-wheelA", "wheelA"),
    ),
    "clocking of a rigid shaft behind the output's mesh": (
        on_the_output,
        shaft_work("out-flange", "out"),
    ),
    "gap": (lambda: families.star(4), flank_work("sun-planet1", "gap")),
    "backlash": (coasting, flank_work("5-8 coast", "backlash")),
    "error": (lambda: shipped("fgfbstts/both_errors"), flank_work("6-10", "error")),
    "float of a ring": (
        arcs,
        contact_work("ring 4: upper stop", 2e-6),
    ),
    "clearance of a ring": (arcs, contact_work("ring 4: arc 6", 1e-6)),
    "errors of a ring made to the drawing": (
        lambda: arcs(**{"rings.4.measured": "nominal", "rings.4.clearance": "60 um"}),
        drawn_arc_work,
    ),
    "offset of a rigid ring": (round_ring, offset_work),
    "offset of an elastic ring": (lambda: round_ring("5e8 N/m"), offset_work),
}


@pytest.mark.parametrize("name", CASES)
def test_work_of_a_prescribed_displacement_is_counted(name):
    case, work = CASES[name]
    train = build_train(case())
    found, _ = answer(train)
    single = certify(train, found)
    scale = single.load * single.deflection
    assert abs(work(train, found)) > LEAST * scale
    assert single.passed, single.failing

    claim = Equilibria.empty(train, 1)
    claim.put(0, found)
    for compiled in (False, True):
        many = Judge(train).judge(situation_of(train, found.index), claim, compiled=compiled)
        assert many.passed.all(), dict(zip(RESIDUALS, many.residuals[0], strict=True))


def test_work_of_the_slip_of_the_position_before_is_counted():
    """Friction acts about the previous slip, whose work is F · s₀."""
    train = build_train(shipped("fgfbstts/full_float"))
    before = {gear: np.array([20e-6, -10e-6, 0.0]) for gear in train.splines}
    train = train.remembering(before)
    step = stepped(train, 1)
    certificate = step.certificate
    scale = certificate.load * certificate.deflection
    for gear, spline in train.splines.items():
        friction = step.equilibrium.radial_reaction[spline.name]
        assert abs(friction @ before[gear]) > 1e-2 * LEAST * scale > 1e-9 * scale
    assert certificate.passed
