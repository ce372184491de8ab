"""Rest positions of what no force holds: the nearest place among half-planes and discs."""

import numpy as np
import pytest
from scipy.optimize import minimize

import loadshare as ls
from loadshare.job.hot import HOT
from loadshare.solver.hot.rest import rest


def test_a_half_plane_and_a_disc_leave_the_nearest_point_between_them():
    """Outside x ≥ 3 and a disc of radius 2 around (4, 1): the point (3, 1 − √3) is too far off; the
    nearest to the origin is (3, 0), inside the disc.
    """
    share = rest(
        np.array([[-1.0, 0.0]]), np.array([-3.0]), [(np.eye(2), -np.array([4.0, 1.0]), 2.0)], 4.0
    )
    assert share == pytest.approx([3.0, 0.0], abs=1e-11)


def test_a_disc_alone_is_met_on_the_way_to_its_middle():
    share = rest(np.zeros((0, 2)), np.zeros(0), [(np.eye(2), -np.array([3.0, 4.0]), 2.0)], 5.0)
    assert share == pytest.approx([1.8, 2.4], rel=1e-9)
    assert np.hypot(*(share - [3.0, 4.0])) <= 2.0 * (1.0 + 1e-11)


def test_discs_that_one_move_closes_both_are_met():
    """With new tangents alone, the place alternated between the two discs."""
    row, room = np.array([[1.0, -1.0, 1.0]]), np.array([-2.0])
    discs = [
        (np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([-2.0, 1.0]), 1.0),
        (np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]), np.array([2.0, -1.0]), 3.0),
    ]
    share = rest(row, room, discs, 4.0)
    assert (row @ share <= room + 1e-11).all()
    for matrix, start, reach in discs:
        assert np.linalg.norm(start + matrix @ share) <= reach + 1e-11
    inside = [
        {"type": "ineq", "fun": lambda u, m=m, q=q, r=r: r * r - ((q + m @ u) ** 2).sum()}
        for m, q, r in discs
    ]
    inside.append({"type": "ineq", "fun": lambda u: room - row @ u})
    nearest = minimize(lambda u: u @ u, share, method="SLSQP", constraints=inside)
    assert share == pytest.approx(nearest.x, abs=1e-5)


def test_no_room_is_reported():
    rows, rooms = np.array([[1.0], [-1.0]]), np.array([1.0, -2.0])
    assert rest(rows, rooms, [], 1.0) is None


def test_an_unloaded_planet_outside_its_ring_rests_in_it():
    """Its flank has room; only the least displacement would leave it outside its ring."""
    gears = {
        "sun": {"centre": ["0 mm", "0 mm"], "base_radius": "50 mm"},
        "ring": {"centre": ["0 mm", "0 mm"], "base_radius": "110 mm", "type": "internal"},
    }
    reach = float(80.0 / np.cos(np.radians(20.0)))
    meshes = {}
    for k, angle in enumerate((0.0, 120.0, 240.0), start=1):
        centre = {"distance": f"{reach!r} mm", "angle": f"{angle} deg"}
        gears[f"p{k}"] = {"centre": centre, "base_radius": "30 mm"}
        for mesh in (f"sun-p{k}", f"p{k}-ring"):
            meshes[mesh] = {"pressure_angle": "20 deg", "stiffness": "1e6 N*m/rad"}
    meshes["sun-p3"]["gap"] = "20 mrad"
    rings = {"p3": {"radius": "3 um", "offset": ["10 um", "5 um"]}}
    operating = {"input": "sun", "output": "ring", "torque": "100 N*m"}
    case = ls.Case(operating=operating, gears=gears, meshes=meshes, rings=rings)
    found = ls.explain(case, 1)
    assert found.rung == HOT
    x, y, _ = found.equilibrium.displacement["p3"]
    assert np.hypot(x - 10e-6, y - 5e-6) <= 3e-6 * (1.0 + 1e-9)
    assert found.equilibrium.flank_force["sun-p3"] == 0.0
