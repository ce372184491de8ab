"""Transmission errors and stiffnesses: closed forms, energy, finite differences, files.

Source: formulation, sections 2, 3 and 12.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from tests.physics.test_planetary import PLANET, RING, SUN, planetary
from tests.support import coasting, lost_contact, round_ring, shipped

import loadshare as ls
from loadshare.results.digest import DIGEST, digest_of
from loadshare.results.document import to_document
from loadshare.results.reading import read_document

RADII = {"1": 30.0, "2": 60.0, "3": 20.0, "4": 50.0}


def chain(torque: float, laws: tuple[dict, dict], shaft: str = "rigid", **operating) -> ls.Case:
    """Return two stages in series on rigid bearings, radii in mm; laws at the drivers."""
    places = {"1": 0.0, "2": 100.0, "3": 100.0, "4": 180.0}
    return ls.Case(
        {
            "operating": {"input": "1", "output": "4", "torque": f"{torque} N*m", **operating},
            "gears": {
                name: {"base_radius": f"{r} mm", "centre": [f"{places[name]} mm", "0 mm"]}
                for name, r in RADII.items()
            },
            "meshes": {
                "1-2": {"pressure_angle": f"{np.arccos(0.9):.17g} rad", **laws[0]},
                "3-4": {"pressure_angle": f"{np.arccos(0.875):.17g} rad", **laws[1]},
            },
            "shafts": {"2-3": {"stiffness": shaft}},
        }
    )


def elastic(case: ls.Case, position: int = 1):
    return ls.solve(case, positions=[position]).positions[0].elastic


def test_a_chain_yields_by_the_sum_of_what_is_in_it() -> None:
    """φ = a₁ + b₁T + c₁T^⅔ + i (wind-up + i₁…, the second stage at twice the torque)."""
    a, b, c, k, ks, t = 2e-5, 1e-7, 3e-6, 4e6, 5e6, 100.0
    first = {"law": {"a": f"{a} rad", "b": f"{b} rad/(N*m)", "c": f"{c} rad/(N*m)^(2/3)"}}
    found = elastic(chain(t, (first, {"stiffness": f"{k} N*m/rad"}), f"{ks} N*m/rad"))
    ratio = RADII["2"] / RADII["1"]
    mesh = a + b * t + c * t ** (2 / 3)
    error = mesh + ratio**2 * t * (1 / ks + 1 / k)
    speed = RADII["1"] / RADII["2"] * RADII["3"] / RADII["4"]
    # The tolerance is the rounding of the radii of the input.
    assert found.transmission_error["input"] == pytest.approx(error, rel=1e-12)
    assert found.transmission_error["output"] == pytest.approx(error * speed, rel=1e-12)
    tangent = b + 2 / 3 * c * t ** (-1 / 3)
    total = 1.0 / (tangent + ratio**2 * (1 / ks + 1 / k))
    assert found.torsional_stiffness["input"] == pytest.approx(total, rel=1e-12)
    assert found.torsional_stiffness["output"] == pytest.approx(total / speed**2, rel=1e-12)
    assert found.mesh_torsional_stiffness == pytest.approx({"1-2": 1 / tangent, "3-4": k})
    assert found.mesh_stiffness["1-2"] == pytest.approx(1 / tangent / 0.03**2, rel=1e-12)
    assert found.mesh_transmission_error["1-2"] == pytest.approx(0.03 * mesh, rel=1e-12)
    assert found.mesh_transmission_error["3-4"] == pytest.approx(0.02 * ratio * t / k, rel=1e-12)


@pytest.mark.parametrize("count", [3, 4, 5])
def test_the_planets_of_a_set_yield_side_by_side(count) -> None:
    """At the sun each planet yields by 1/K₁ + (z_p/z_s)²/K₂; the carrier turns slower by Willis."""
    found = elastic(planetary(count))
    total = count / (1 / 2e7 + (PLANET / SUN) ** 2 / 9e7)
    assert found.torsional_stiffness["input"] == pytest.approx(total, rel=1e-9)
    slower = 1.0 + RING / SUN
    assert found.torsional_stiffness["output"] == pytest.approx(total * slower**2, rel=1e-9)


MACHINES = {
    "all elements": lambda: shipped("fgfbstts/all_elements"),
    "limit ring": lambda: shipped("fgfbstts/limit_ring"),
    "two paths": lambda: shipped("two_path/clocking_error"),
    "planetary": lambda: shipped("planetary/four_planets"),
    "gearbox": lambda: shipped("nrel_5mw/gearbox"),
    "rigid ring": round_ring,
    "elastic ring": lambda: round_ring("2e8 N/m"),
    "coasting": coasting,
    "contact lost": lost_contact,
    "slipping": lambda: slipping({"friction_force": "5 N"}),
    "friction by torque": lambda: slipping({"friction": 0.01, "radius": "20 mm"}),
    "stopped": lambda: slipping({"friction": 0.001, "radius": "20 mm"}, "1 um"),
}


def slipping(friction: dict, clearance: str = "60 um") -> ls.Case:
    """Return a star of four, one planet softer, whose sun is pushed across its spline."""
    spline = {"bending_stiffness": "1e8 N/m", "clearance": clearance, **friction}
    case = shipped("star/floating_sun_4")
    soft = next(iter(case.meshes))
    stiffness = f"{0.5 * case.meshes[soft].stiffness.si} N*m/rad"
    return case.replace({"splines.sun": spline, f'meshes."{soft}".stiffness': stiffness})


def test_splines_of_these_cases_slip_and_stop() -> None:
    stages = [
        ls.solve(MACHINES[name]()).positions[0].floats["sun"].spline
        for name in ("slipping", "friction by torque", "stopped")
    ]
    assert stages == ["slip", "slip", "stop"]
    stiffnesses = {
        round(elastic(MACHINES[name]()).torsional_stiffness["input"], -2)
        for name in ("slipping", "friction by torque", "stopped")
    }
    assert len(stiffnesses) == 3, "friction makes a difference"


@pytest.mark.parametrize("name", MACHINES)
def test_stiffness_is_the_slope_of_solved_cases(name) -> None:
    case = MACHINES[name]()
    torque, step = case.operating.input_torque[0], 1e-5
    gone = {f"operating.{k}": None for k in ("power", "speed") if k in case.to_dict()["operating"]}
    ends = [
        elastic(case.replace({**gone, "operating.torque": f"{torque * (1 + s):.17g} N*m"}))
        for s in (-step, step)
    ]
    low, high = (e.transmission_error["input"] for e in ends)
    # Rotations are found to some 1e-15, their difference to a relative 1e-10; central differences
    # of a Hertz law add an error of some (step)².
    slope = 2.0 * step * torque / (high - low)
    assert elastic(case).torsional_stiffness["input"] == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize("name", MACHINES)
def test_errors_of_meshes_and_shafts_make_up_that_of_the_train(name) -> None:
    """Virtual work, T φ = Σ F e + Σ T_s w, from the moments of all gears, whatever the laws."""
    case = MACHINES[name]()
    here = ls.solve(case, positions=[1]).positions[0]
    train, phi = here.train, here.rotation
    work = [
        here.equilibrium.flank_force[mesh.flank_name(drive)]
        * (1.0 if drive else -1.0)
        * here.elastic.mesh_transmission_error[mesh_name]
        for mesh_name, mesh in train.meshes.items()
        for drive in mesh.flanks
    ]
    work += [
        torque * (phi[train.shafts[s].first] - phi[train.shafts[s].second])
        for s, torque in here.loads.shafts.items()
    ]
    outside = [
        (case.operating.input_torque[0] if g == train.input else 0.0) * phi[g] for g in train.gears
    ]
    outside += [train.external[g] * phi[g] for g in train.external]
    assert sum(outside) == pytest.approx(sum(work), rel=1e-9)


def test_what_is_open_has_no_stiffness() -> None:
    here = ls.solve(lost_contact()).positions[0]
    least = 1e-9 * max(here.loads.meshes.values())
    for mesh, force in here.loads.meshes.items():
        assert (here.elastic.mesh_stiffness[mesh] > 0.0) == (force > least)
    assert 0.0 in here.elastic.mesh_stiffness.values()


def test_what_carries_nothing_by_hertz_resists_nothing() -> None:
    law = {"law": {"c": "3e-6 rad/(N*m)^(2/3)"}}
    found = elastic(chain(0.0, (law, law)))
    assert found.torsional_stiffness == {"input": 0.0, "output": 0.0}
    assert set(found.mesh_stiffness.values()) == {0.0}


def test_arrays_and_documents_hold_the_same_figures() -> None:
    result = ls.solve(shipped("fgfbstts/all_elements"))
    assert result.dataset["torsional_stiffness"].dims == ("position", "side")
    document = result.to_dict()
    for p, record in zip(result.positions, document["positions"], strict=True):
        arrays = result.dataset.sel(position=p.position)
        for name, figures in record["elastic"].items():
            assert getattr(p.elastic, name) == figures
            assert dict(zip(figures, arrays[name].values.tolist(), strict=True)) == figures


def test_form_4_without_these_figures_is_read() -> None:
    result = ls.solve(shipped("fgfbstts/limit_ring"), positions=[1])
    older = to_document(result, 4)
    assert older["format"] == 4
    assert "elastic" not in older["positions"][0]
    assert older[DIGEST] == digest_of({k: v for k, v in older.items() if k != DIGEST})
    assert read_document(json.dumps(older), "old.json")[0] == result
    older["positions"][0]["torque"]["4-6"] *= 1.5
    with pytest.raises(ls.ResultError, match=r'torque\."4-6"'):
        read_document(json.dumps(older), "old.json")
