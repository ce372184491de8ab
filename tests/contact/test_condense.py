"""Coordinates that only springs hold are condensed, which changes no answer."""

import numpy as np
from tests.support import shipped

from benchmarks import families
from loadshare.certify import certify
from loadshare.contact.condense import condense, nothing_condensed
from loadshare.scene import assemble
from loadshare.solver import Options, solve_scene
from loadshare.train import build_train

FLANGE = {"centre": ["0 mm", "0 mm", "-1500 mm"], "base_radius": "30 mm"}


def with_flange():
    """Return the two-path box driven by a torsion shaft from a flange without meshes."""
    case = families.two_path("0.0012 rad")
    data = case.to_dict()
    data["gears"]["flange"] = FLANGE
    data["shafts"]["quill"] = {
        "ends": ["flange", data["operating"]["input"]],
        "stiffness": "2e4 N*m/rad",
    }
    data["operating"]["input"] = "flange"
    return type(case)(data)


def test_a_flange_between_shafts_is_condensed_and_recovered():
    train = build_train(with_flange())
    scene = assemble(train, 1)
    lean, record = solve_scene(scene, Options())
    whole, _ = solve_scene(scene, Options(reduce=False))
    assert ("gear flange rotation", "only springs hold it") in record.removed
    assert "gear flange rotation" not in record.coordinates
    assert certify(train, lean).passed
    # The wind-up of the quill shaft follows Hooke's law, to round-off.
    wind = lean.rotation["flange"] - lean.rotation[train.shafts["quill"].second]
    assert np.isclose(wind, train.input_torque[0] / 2e4, rtol=1e-12)
    for gear, angle in whole.rotation.items():
        assert np.isclose(lean.rotation[gear], angle, rtol=1e-10, atol=1e-18)


def test_every_coordinate_of_the_seed_train_is_touched():
    scene = assemble(build_train(shipped("fgfbstts/limit_ring")), 1)
    assert len(scene.condensation.kept) == scene.size


def test_condensing_is_minimising():
    rng = np.random.default_rng(7)
    root = rng.normal(size=(6, 6))
    stiffness, load = root @ root.T, rng.normal(size=6)
    touched = np.array([True, False, True, True, False, True])
    reduced = condense(stiffness, load, touched)
    x = reduced.expand(rng.normal(size=4))
    # The gradient along condensed coordinates vanishes, whatever the others are.
    assert np.abs((stiffness @ x - load)[~touched]).max() < 1e-12


def test_what_no_spring_holds_is_kept():
    touched = np.array([True, False])
    free = condense(np.diag([1.0, 0.0]), np.zeros(2), touched)
    assert len(free.kept) == len(nothing_condensed(2).kept) == 2
