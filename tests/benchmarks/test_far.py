"""Which random trains count as displaced too far, against exact involutes."""

import pytest
from tests.certify.test_validity import exact, pair

from benchmarks.random_trains.draw import draw
from benchmarks.random_trains.far import TURNED, is_far, is_far_before, neglected, turned
from benchmarks.reference import reference
from benchmarks.stress.families import FAMILIES
from loadshare.train import build_train


@pytest.mark.parametrize("kind", ["external", "internal"])
@pytest.mark.parametrize("torque", ["100 N*m", "3e4 N*m"])
def test_missed_approach_is_that_of_exact_involutes(kind: str, torque: str) -> None:
    case = pair(kind).replace({"operating.torque": torque, "gears.1.support": "1e6 N/m"})
    train = build_train(case)
    found = reference(train, 1)
    mesh = train.meshes["1-2"]
    moved = train.gears["1"].frame.T @ found.displacement["1"]
    missed = exact(kind, mesh.radii[1], moved[:2]) - float(mesh.drive_normal @ moved)
    deflection = mesh.law(0).compression(found.force["1-2"])
    assert neglected(train, 1, found) == pytest.approx(abs(missed) / deflection, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(("number", "far"), [(681, True), (796, False)])
def test_only_flanks_with_a_force_are_far(number: int, far: bool) -> None:
    """At light loads, a wedged planet is displaced far in one train, an idle one in the other."""
    train = build_train(draw(1, number))
    assert is_far(train, 1, reference(train, 1)) == far


def test_teeth_that_are_compressed_by_more_than_their_height_are_far() -> None:
    train = build_train(draw(1, 363))
    assert is_far(train, 1, reference(train, 1))


def test_errors_that_turn_the_line_of_action_are_far() -> None:
    """Errors of 4 to 6 mm turn lines of action by over 10°; without them, the train is not far."""
    case = FAMILIES["stiffness-ratio"].problem(197).case
    train = build_train(case)
    found = reference(train, 1)
    assert turned(train, 1, found) > TURNED
    assert is_far(train, 1, found)
    train = build_train(case.replace({"errors": None}))
    assert not is_far(train, 1, reference(train, 1))


def test_part_of_the_load_may_be_too_much_already() -> None:
    """Soft rings yield, and the input rolls along an arc; in the other train nothing moves far."""
    assert is_far_before(build_train(draw(1, 1292)), 1)
    assert not is_far_before(build_train(draw(1, 796)), 1)
