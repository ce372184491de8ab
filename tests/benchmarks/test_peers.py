"""Peers get the right problem: those that can solve it must find the certified answer.

Tolerances: 1e-9 for an active-set method (DAQP); 1e-6 for an interior-point method at 1e-11, which
is its tolerance times the condition number of these scenes.
"""

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from benchmarks.chart.measure import Times
from benchmarks.peers import PEERS
from benchmarks.peers.form import form_of
from benchmarks.peers.loop import Failure, force_of
from loadshare.certify import certify
from loadshare.scene import assemble
from loadshare.settings import CERTIFY
from loadshare.train import build_train

EXACT, INTERIOR, BATCHED = 1e-9, 1e-5, 1e-2
"""Residuals that an active-set method, an interior-point method and the batched one reach."""
FAST = [e for e in PEERS.values() if not e.slow and e.name != "trial states"]


def b_and_c_with_errors() -> ls.Case:
    """Return a case with rings, backlash, elastic bearings and b + c laws, but no splines."""
    case = shipped("fgfbstts/all_elements")
    return case.replace({"assumed": None, "splines": None})


CASES = {
    "errors": lambda: shipped("fgfbstts/both_errors"),
    "splines": lambda: shipped("fgfbstts/spline_clearance"),
    "b + c": b_and_c_with_errors,
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("entry", FAST, ids=lambda e: e.name)
@pytest.mark.quick(12)
def test_a_peer_finds_the_certified_answer(entry, name):
    if entry.missing:
        pytest.skip(f"{entry.package} is not installed")
    case = CASES[name]()
    train = build_train(case)
    form = form_of(assemble(train, 1))
    if form.kind not in entry.kinds:
        with pytest.raises(Failure, match="QPs only"):
            entry.make(1e-9).prepare(form)
        return
    peer = entry.make(entry.tolerances[-1])
    peer.prepare(form)
    claim = peer.solve(form)
    found = form.equilibrium(claim.x, claim.forces, claim.pulls)
    limit = {"DAQP": EXACT, "DAQP, reduced": EXACT, "moreau": BATCHED}.get(entry.name, INTERIOR)
    # A peer's answer is in balance to its own tolerance; its torques are not proved that closely.
    certificate = certify(train, found, min(limit, CERTIFY.largest))
    assert certificate.worst <= limit, certificate.residuals


def test_forces_follow_from_compressions_in_closed_form():
    linear = np.array([0.0, 1.0, 0.7, 0.0])
    hertz = np.array([0.3, 0.0, 0.3, 0.0])
    force = np.array([2.0, 3.0, 5.0, 0.0])
    compression = linear * force + hertz * np.cbrt(force) ** 2
    assert force_of(linear, hertz, compression) == pytest.approx(force, rel=1e-14)
    assert not force_of(linear, hertz, -compression).any()


def test_the_trial_states_of_the_literature_work_where_states_are_obvious():
    case = shipped("fgfbstts/both_errors")
    train = build_train(case)
    form = form_of(assemble(train, 1))
    claim = PEERS["trial states"].make(1e-9).solve(form)
    assert certify(train, form.equilibrium(claim.x, claim.forces, claim.pulls), 1e-8).passed


def test_a_missing_peer_is_known_to_be_missing():
    from dataclasses import replace

    assert replace(PEERS["DAQP"], package="no_such_package").missing


def test_time_inside_the_calls_of_a_peer_is_part_of_all_its_time():
    entry, form = PEERS["DAQP"], form_of(assemble(build_train(b_and_c_with_errors()), 1))
    if entry.missing:
        pytest.skip(f"{entry.package} is not installed")
    peer, times = entry.make(1e-9), Times()
    peer.prepare(form)
    for _ in range(5):
        times.take(lambda: peer.solve(form), 1, peer.clock)
    assert all(0.0 < i < w for i, w in zip(times.inside, times.wall, strict=True))
    assert all(0.0 < r < i for r, i in zip(times.reported, times.inside, strict=True))


def test_a_reduced_problem_has_the_same_answer():
    train = build_train(shipped("fgfbstts/both_errors"))
    form = form_of(assemble(train, 1))
    forces = ls.explain(shipped("fgfbstts/both_errors"), 1).equilibrium
    acting = {n for f in (forces.flank_force, forces.ring_force) for n, v in f.items() if v > 0.0}
    reduced = form.only(acting)
    assert set(reduced.names) == acting
    for name in ("DAQP", "DAQP, reduced"):
        if PEERS[name].missing:
            pytest.skip(f"{PEERS[name].package} is not installed")
        peer = PEERS[name].make(1e-12)
        peer.prepare(reduced)
        claim = peer.solve(reduced)
        found = reduced.equilibrium(claim.x, claim.forces, claim.pulls)
        assert certify(train, found, EXACT).worst <= EXACT
