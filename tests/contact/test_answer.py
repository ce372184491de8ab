"""Contact problems without gears against closed forms, and the residuals that judge answers."""

import dataclasses
import math
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from loadshare.contact import (
    RIGID,
    Arc,
    ArcRow,
    ContactProblem,
    Piece,
    PowerLaw,
    Radial,
    RadialLaw,
    Row,
    TableLaw,
    residuals,
    solve_contact,
)
from loadshare.contact.problem import of_unit_norm
from loadshare.contact.radial import RollingLaw
from loadshare.errors import Refused

METHODS = ("newton", "picard")


def block(load: float, law: PowerLaw = RIGID, spring: float = 1e6) -> ContactProblem:
    """Return a block of one coordinate between two stops 1 mm away, on a spring."""
    stops = (
        Row("right stop", "stop", np.array([1.0]), 1e-3, law),
        Row("left stop", "stop", np.array([-1.0]), 1e-3, law),
    )
    return ContactProblem(("x",), np.array([[spring]]), np.array([load]), stops)


def disc(load: tuple[float, float], law: RadialLaw) -> ContactProblem:
    """Return a disc without springs in a drum."""
    inside = Radial("drum", np.eye(2), np.zeros(2), law)
    return ContactProblem(("x", "y"), np.zeros((2, 2)), np.array(load), radials=(inside,))


@pytest.mark.parametrize("solver", ["clarabel", "osqp", "cvxpy"])
@pytest.mark.parametrize("load", [400.0, 3000.0, -3000.0, 1000.0])
def test_a_block_on_two_rigid_stops(load: float, solver: str) -> None:
    found = solve_contact(block(load), solver=solver)
    x = max(-1e-3, min(1e-3, load / 1e6))
    assert found.passed
    assert found.place["x"] == pytest.approx(x, rel=1e-12)
    assert found.force["right stop"] == pytest.approx(max(load - 1e3, 0.0), abs=1e-9)
    assert found.force["left stop"] == pytest.approx(max(-load - 1e3, 0.0), abs=1e-9)


@pytest.mark.parametrize("size", [1e-200, 1.0, 1e200])
def test_rows_have_unit_norm_whatever_their_size(size: float) -> None:
    rows = of_unit_norm(size * np.array([[3.0, -4.0], [0.0, 0.0], [0.0, 5.0]]))
    np.testing.assert_allclose(rows, [[0.6, -0.8], [0.0, 1.0]], rtol=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_a_block_on_a_hertz_contact(method: str) -> None:
    """The overlap follows from F = b x + c x^(2/3) and the spring, by bisection."""
    law = PowerLaw(2e-9, 3e-8)
    found = solve_contact(block(5e3, law), method=method)
    low, high = 0.0, 5e3
    for _ in range(200):
        force = 0.5 * (low + high)
        x = 1e-3 + law.compression(force)
        low, high = (force, high) if 1e6 * x + force < 5e3 else (low, force)
    assert found.force["right stop"] == pytest.approx(force, rel=1e-12)


def test_a_disc_leans_on_its_drum_where_the_load_points() -> None:
    drum = RadialLaw((Piece(0.0, 0.0, 2e-3, "inside"), Piece(0.0, 1e7, math.inf, "wall")))
    found = solve_contact(disc((300.0, 400.0), drum))
    radius = 2e-3 + 500.0 / 1e7
    assert found.place == pytest.approx({"x": 0.6 * radius, "y": 0.8 * radius}, rel=1e-12)
    assert found.pull["drum"] == pytest.approx([300.0, 400.0], rel=1e-12)
    assert not found.undetermined


def test_a_disc_on_a_slope_of_friction() -> None:
    """A friction of 10 N, then 1e5 N/m: the disc stays under 8 N and moves under 50 N."""
    law = RadialLaw((Piece(10.0, 1e5, math.inf, "slip"),))
    rests, moves = solve_contact(disc((8.0, 0.0), law)), solve_contact(disc((30.0, 40.0), law))
    assert rests.place == pytest.approx({"x": 0.0, "y": 0.0}, abs=1e-15)
    assert rests.pull["drum"] == pytest.approx([8.0, 0.0])
    assert moves.place == pytest.approx({"x": 0.6 * 4e-4, "y": 0.8 * 4e-4}, rel=1e-12)


def test_an_arc_turns_its_face() -> None:
    """A body is pressed onto a round neighbour and held sideways by a spring; it rolls."""
    arc = Arc(np.array([0.1, 0.0, 0.0]), np.zeros(3), 1e-3)
    relative = np.vstack([np.eye(2), np.zeros((1, 2))])
    rolls = ArcRow("arc", arc, relative, RIGID, 0.0)
    spring = np.diag([0.0, 1e6])
    problem = ContactProblem(("x", "y"), spring, np.array([-1e3, 500.0]), arcs=(rolls,))
    found = solve_contact(problem)
    x, y, force = found.place["x"], found.place["y"], found.force["arc"]
    way = np.array([0.1 + x, y])
    assert np.linalg.norm(way) == pytest.approx(0.099, rel=1e-12)
    assert force * way / 0.099 + [-1e3, 500.0 - 1e6 * y] == pytest.approx([0.0, 0.0], abs=1e-8)
    assert y > 5e-4


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "law", [PowerLaw(1e-3, 2e-3), TableLaw((0.0, 0.49, 1.0), (0.0, 5e-3, 6e-3))]
)
def test_an_arc_may_yield_by_any_law(law: PowerLaw | TableLaw, method: str) -> None:
    arc = Arc(np.array([1.0, 0.0, 0.0]), np.zeros(3), 1e-2)
    rolls = ArcRow("arc", arc, np.eye(3)[:, :2], law, 0.0)
    problem = ContactProblem(("x", "y"), np.diag([1.0, 2.0]), [-0.5, 0.3], arcs=(rolls,))
    found = solve_contact(problem, method=method)
    place, force = np.array([found.place["x"], found.place["y"]]), found.force["arc"]
    way = place + np.array([1.0, 0.0])
    length = float(np.linalg.norm(way))
    assert length == pytest.approx(0.99 - law.compression(force), rel=1e-12)
    pushed = force * way / length + [-0.5, 0.3] - [1.0, 2.0] * place
    assert pushed == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_contact_does_not_overlap_by_the_offset_of_its_tangent() -> None:
    """The tangent at the load begins at an overlap of 1.1, more than there is."""
    law = TableLaw((0.0, 1.0, 1.5, 2.5), (0.0, 0.1, 1.1, 1.101))
    stop = Row("stop", "stop", np.array([0.26]), 0.0, law)
    found = solve_contact(ContactProblem(("x",), np.array([[4.0]]), [2.0], (stop,)))
    x = (2.0 - 0.26 * (1.0 - 0.05)) / (4.0 + 0.26**2 / 2.0)
    assert found.place["x"] == pytest.approx(x, rel=1e-12)
    assert found.force["stop"] == pytest.approx(1.0 + (0.26 * x - 0.1) / 2.0, rel=1e-12)


def test_what_nothing_holds_is_named() -> None:
    stop = (Row("stop", "stop", np.array([1.0, 0.0]), 0.0, RIGID),)
    found = solve_contact(ContactProblem(("x", "y"), np.zeros((2, 2)), np.array([5.0, 0.0]), stop))
    assert found.undetermined == {"y"}


def test_what_has_no_equilibrium_is_refused() -> None:
    free = ContactProblem(("x",), np.zeros((1, 1)), np.array([1.0]))
    with pytest.raises(Refused, match=r"no equilibrium .*: the load moves x without end"):
        solve_contact(free)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("load", [(30.0, 40.0), (1e5, 3.0), (-1e9, 1e-3), (1e200, 0.0)])
def test_a_load_beyond_all_friction_is_refused(load: tuple[float, float]) -> None:
    """A friction of 10 N, with nothing behind it."""
    slips = RadialLaw((Piece(10.0, 0.0, math.inf, "slip"),))
    with pytest.raises(Refused, match=r"the load moves .* without end"):
        solve_contact(disc(load, slips))


@pytest.mark.parametrize("angle", [0.0, 0.3, math.atan2(4.0, 3.0), math.pi / 2, 2.0, -2.9])
@pytest.mark.parametrize("behind", [(), (Piece(10.0, 1e3, math.inf, "stop"),)])
def test_friction_bears_exactly_what_it_can(angle: float, behind: tuple[Piece, ...]) -> None:
    """Under 10 N, a disc with a friction of 10 N is in equilibrium anywhere along the load."""
    load = (10.0 * math.cos(angle), 10.0 * math.sin(angle))
    slips = Piece(10.0, 0.0, 0.05 if behind else math.inf, "slip")
    found = solve_contact(disc(load, RadialLaw((slips, *behind))))
    assert found.pull["drum"] == pytest.approx(load, rel=1e-9, abs=1e-9)
    assert found.undetermined == {c for c, f in zip("xy", load, strict=True) if abs(f) > 1e-6}


def test_a_load_that_is_refused_without_running_away_is_not_said_to() -> None:
    """Stops that contradict one another by 1 mm, beside friction that is not used up."""
    stops = [Row(name, "stop", [s, 0.0], -5e-4, RIGID) for name, s in (("l", -1.0), ("r", 1.0))]
    slips = Radial("s", np.eye(2), np.zeros(2), RadialLaw((Piece(10.0, 0.0, math.inf, "slip"),)))
    between = ContactProblem(("x", "y"), np.zeros((2, 2)), [0.0, 9.0], stops, (), (slips,))
    with pytest.raises(Refused) as caught:
        solve_contact(between)
    assert "without end" not in str(caught.value)


@pytest.mark.parametrize(
    ("part", "value", "message"),
    [
        ("stiffness", np.array([[-1.0]]), "negative eigenvalue"),
        (
            "rows",
            (Row("stop", "stop", [-0.0], -0.1, TableLaw((0.0, 1.0), (0.0, 1.0))),),
            "vector of stop: is zero, so it touches nothing",
        ),
        (
            "arcs",
            (ArcRow("arc", Arc([1, 0, 0], [0, 0, 0], 0), np.zeros((3, 1)), RIGID, 0),),
            "relative of arc: is zero",
        ),
        (
            "radials",
            (Radial("drum", np.zeros((2, 1)), [0, 0], RadialLaw((Piece(0, 1, 1, "wall"),))),),
            "matrix of drum: is zero",
        ),
        ("stiffness", np.eye(2), r"has shape \(2, 2\), but \(1, 1\) is needed"),
        ("load", np.array([np.nan]), "contains a number that is not finite"),
        ("coordinates", ("right stop",), "two elements or coordinates"),
        ("coordinates", (), "coordinates: there are none"),
        ("load", ["one"], "load: contains something other than numbers"),
        ("load", None, r"load: has shape \(\), but \(1,\) is needed"),
        ("rows", (Row("stop", "stop", [1.0], None, None),), "law of stop: None is not a law"),
        (
            "rows",
            (Row("stop", "stop", [1.0], None, RIGID),),
            "gap of stop: contains a number that is not finite",
        ),
        (
            "radials",
            (Radial("drum", [[1.0]], [0.0, 0.0], None),),
            "source of drum: None is not a law",
        ),
        ("coordinates", 1, "coordinates: 1 is no sequence of str"),
        ("rows", ("stop",), "rows: 'stop' is no Row"),
        ("radials", block(1.0).rows, "radials: Row.* is no Radial"),
        ("rows", (Row(None, "stop", [1.0], 0.0, RIGID),), "rows: the name None is no str"),
        ("rows", (Row("stop", "stop", [1.0], "1.0", RIGID),), "gap of stop: contains something"),
        ("rows", (Row("stop", "stop", [1.0], 0.0, PowerLaw),), "PowerLaw'> is not a law"),
        ("load", [10**400], "load: contains something other than numbers"),
        ("arcs", (ArcRow("arc", None, [[1], [0], [0]], RIGID, 0),), "arc of arc: None is no Arc"),
        (
            "arcs",
            (ArcRow("arc", Arc([0, 0, 0], [0, 0, 0], 0), [[1], [0], [0]], RIGID, 0),),
            "nominal of arc: is zero",
        ),
        (
            "radials",
            (Radial("drum", [[1], [0]], [0, 0], RadialLaw((Piece(0, 1, 1, "a"),)), {"no": 1.0}),),
            "levers of drum: 'no' is no row or arc",
        ),
        (
            "radials",
            (Radial("drum", [[1], [0]], [0, 0], RadialLaw((Piece(0, 1, 1, "a"),)), [1.0]),),
            r"levers of drum: \[1.0\] is no mapping",
        ),
        ("load", np.array([1.0 + 1.0j]), "load: contains something other than numbers"),
        ("load", np.array([5], "m8[s]"), "load: contains something other than numbers"),
        ("load", np.array(["5"]), "load: contains something other than numbers"),
        ("load", np.array(["5"], object), "load: contains something other than numbers"),
        ("load", np.ma.array([5], mask=[True]), "load: contains something other than numbers"),
        (
            "rows",
            (Row("stop", "stop", [1.0], np.datetime64("2026"), RIGID),),
            "gap of stop: contain",
        ),
        ("rows", (Row("stop", "stop", [1.0], Decimal(1), RIGID),), "gap of stop: contains somethi"),
        (
            "rows",
            (Row("stop", "stop", [1.0], 0.0, PowerLaw(Decimal(1))),),
            r"law of stop: b = Decimal\('1'\) is not a finite number",
        ),
    ],
)
def test_arrays_that_do_not_belong_together_are_named(part, value, message) -> None:
    with pytest.raises(ValueError, match=message):
        solve_contact(dataclasses.replace(block(1.0), **{part: value}))


@pytest.mark.parametrize("lever", ["1", 1j, math.nan, math.inf, None])
def test_a_lever_that_is_no_number_is_named(lever) -> None:
    law = RadialLaw((Piece(0, 1, 1, "a"),))
    drum = Radial("drum", [[1], [0]], [0, 0], law, {"left stop": lever})
    with pytest.raises(ValueError, match="lever of left stop over drum: contains"):
        solve_contact(dataclasses.replace(block(1.0), radials=(drum,)))


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("clearance", -1e-3, "of at least 0"),
        ("clearance", "a", "of at least 0"),
        ("stiffness", 0.0, "above 0"),
        ("stiffness", math.inf, "above 0"),
        ("power", 0.5, "above 1"),
        ("faint", 0.0, "above 0"),
    ],
)
def test_a_bearing_that_is_no_law_is_named(name: str, value: object, allowed: str) -> None:
    law = dataclasses.replace(RollingLaw(1e-3, 1e6, 1.5, 1e-9), **{name: value})
    with pytest.raises(ValueError, match=f"{name} = {value!r} is not a finite number {allowed}"):
        solve_contact(disc((3.0, 4.0), law))


def test_a_force_that_is_none_counts_as_infinitely_wrong() -> None:
    assert residuals(block(1.0), [0.0], {"left stop": None}, {}).worst == math.inf


def test_claims_that_do_not_fit_the_problem_are_named() -> None:
    stops = block(1.0)
    with pytest.raises(TypeError, match="a ContactProblem is expected, not str"):
        solve_contact("block")
    with pytest.raises(TypeError, match="forces by name are expected"):
        residuals(stops, [0.0], [1.0], {})
    with pytest.raises(ValueError, match="no array of numbers") as caught:
        residuals(stops, [0.0, 0.0], {"stop": "1 N"}, {"drum": 5.0})
    for wrong in ("x: [0.0, 0.0] is", "stop: no row", "force of stop: '1 N' is", "drum: no radial"):
        assert wrong in str(caught.value)


def test_an_answer_cannot_be_changed() -> None:
    found = solve_contact(block(1.0))
    for mapping in (found.place, found.force, found.pull):
        with pytest.raises(TypeError, match="cannot be changed"):
            mapping["x"] = 1.0


def test_a_load_far_beyond_its_spring_is_refused() -> None:
    """The displacement would exceed the range of doubles."""
    with pytest.raises(Refused), np.errstate(all="ignore"):
        solve_contact(ContactProblem(["x"], [[1e-300]], [1e300]))


def test_lists_and_whole_numbers_will_do() -> None:
    stops = [Row(name, "stop", [sign], 0, RIGID) for name, sign in (("right", 1), ("left", -1))]
    problem = ContactProblem(["x"], [[1000000]], [-3000], stops)
    found = solve_contact(problem)
    assert found.force == pytest.approx({"right": 0.0, "left": 3000.0})
    assert residuals(problem, [0], found.force, {}).worst < 1e-12
    drum = Radial("drum", [[1, 0], [0, 1]], [0, 0], RadialLaw((Piece(0, 1000, math.inf, "wall"),)))
    found = solve_contact(ContactProblem(["x", "y"], np.zeros((2, 2), int), [3, 4], radials=[drum]))
    assert found.place == pytest.approx({"x": 3e-3, "y": 4e-3})
    rolls = ArcRow("arc", Arc([1, 0], [0, 0], 0), [[1]], RIGID, 0)
    with pytest.raises(ValueError, match="nominal of arc: has shape") as caught:
        solve_contact(ContactProblem(["x"], [[1]], [1], arcs=[rolls]))
    assert "relative of arc: has shape (1, 1), but (3, 1) is needed" in str(caught.value)


@pytest.mark.parametrize(
    ("x", "force", "part"),
    [
        (1e-3, {"right stop": 1900.0}, "balance"),
        (1.1e-3, {"right stop": 1900.0}, "law"),
        (4e-3, {"left stop": -1000.0}, "sign"),
    ],
)
def test_wrong_answers_do_not_pass(x: float, force: dict[str, float], part: str) -> None:
    judged = residuals(block(3000.0), np.array([x]), force, {})
    assert getattr(judged, part) > 1e-3
    right = residuals(block(3000.0), np.array([1e-3]), {"right stop": 2000.0}, {})
    assert right.worst < 1e-12


def test_a_force_across_the_offset_does_not_pass() -> None:
    drum = RadialLaw((Piece(0.0, 0.0, 2e-3, "inside"),))
    problem = disc((0.0, 500.0), drum)
    judged = residuals(problem, np.array([2e-3, 0.0]), {}, {"drum": np.array([0.0, 500.0])})
    assert judged.balance < 1e-12
    assert judged.law > 0.1


@st.composite
def problems(draw: st.DrawFn) -> ContactProblem:
    """Draw springs, compliant contacts of every law, and drums, in up to five coordinates."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, m, k = draw(st.integers(2, 5)), draw(st.integers(1, 6)), draw(st.integers(0, 2))
    root = rng.normal(size=(n, n))
    rows = tuple(
        Row(
            f"contact {e}",
            "stop",
            rng.normal(size=n),
            float(rng.normal()),
            PowerLaw(rng.uniform(0.1, 1.0), rng.choice([0.0, 0.5])),
        )
        for e in range(m)
    )
    wall = (Piece(0.0, 0.0, 0.4, "inside"), Piece(0.3, 2.0, math.inf, "wall"))
    radials = tuple(
        Radial(f"drum {j}", rng.normal(size=(2, n)), rng.normal(size=2), RadialLaw(wall))
        for j in range(k)
    )
    names = tuple(f"x{i}" for i in range(n))
    return ContactProblem(names, root @ root.T, 3.0 * rng.normal(size=n), rows, (), radials)


@given(problems(), st.integers(0, 2**32 - 1))
def test_an_answer_has_the_least_energy(problem: ContactProblem, seed: int) -> None:
    """Formulation, section 4: the equilibrium of a convex problem is the minimum of its energy."""

    def energy(x: np.ndarray) -> float:
        total = 0.5 * x @ problem.stiffness @ x - problem.load @ x
        total += sum(r.law.energy(float(r.vector @ x) - r.gap) for r in problem.rows)
        for radial in problem.radials:
            radius = float(np.linalg.norm(radial.matrix @ x - radial.centre))
            total += radial.law(0.0).energy(radius)
        return float(total)

    found = solve_contact(problem)
    x = np.array(list(found.place.values()))
    here, rng = energy(x), np.random.default_rng(seed)
    for size in (1.0, 1e-2, 1e-4):
        for _ in range(5):
            assert energy(x + size * rng.normal(size=len(x))) >= here - 1e-12 * (1.0 + abs(here))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (PowerLaw(-1e-9), "law of stop: b = -1e-09 is not a finite number of at least 0"),
        (PowerLaw(0.0, math.inf), "law of stop: c = inf"),
        (
            TableLaw((0.0, 1.0, 0.5), (0.0, 1e-6, 2e-6)),
            "forces are not finite numbers rising from 0",
        ),
        (TableLaw((0.0, 1.0), (1e-6, 2e-6)), "compressions are not finite numbers rising from 0"),
        (TableLaw((0.0,), (0.0,)), "has 1 forces and 1 compressions"),
        (TableLaw(None, None), "its forces None are no sequence of numbers"),
        (TableLaw("012", "012"), "its forces are not finite numbers rising from 0"),
        (PowerLaw("1e-9"), "b = '1e-9' is not a finite number"),
    ],
)
def test_laws_under_which_a_stop_would_push_from_afar_are_refused(law, message) -> None:
    stop = Row("stop", "stop", np.ones(1), 0.0, law)
    problem = ContactProblem(("x",), np.array([[1e3]]), np.array([3.0]), rows=(stop,))
    with pytest.raises(ValueError, match=message):
        solve_contact(problem)


@pytest.mark.parametrize(
    ("pieces", "message"),
    [
        ((), "source of drum: has no piece"),
        (Piece(0.0, 1.0, 1.0, "wall"), "are no sequence of Piece"),
        ((0.0, 1.0, 1.0), "are no sequence of Piece"),
        ((Piece("0", 1.0, 1.0, "wall"),), r"piece 1 \(wall\): force and stiffness"),
        ((Piece(5.0, 0.0, 1e-3, "slip"), Piece(1.0, 1e3, math.inf, "wall")), "force falls"),
        ((Piece(0.0, -1.0, math.inf, "wall"),), r"piece 1 \(wall\): force and stiffness"),
        ((Piece(0.0, 1.0, -1.0, "wall"),), "length -1.0"),
        ((Piece(0.0, 1.0, math.inf, "a"), Piece(0.0, 1.0, 1.0, "b")), "endless but not the last"),
    ],
)
def test_radial_laws_that_are_no_rising_graph_are_refused(pieces, message) -> None:
    drum = Radial("drum", np.eye(2), np.zeros(2), RadialLaw(pieces))
    problem = ContactProblem(("x", "y"), np.eye(2), np.array([3.0, 0.0]), radials=(drum,))
    with pytest.raises(ValueError, match=message):
        solve_contact(problem)


def test_round_off_in_a_stiffness_is_no_lack_of_symmetry() -> None:
    """Springs along directions B give BᵀKB, whose halves differ in their last digits."""
    along = np.random.default_rng(3).normal(size=(4, 3))
    stiffness = along.T @ np.diag([1e6, 3e7, 2e5, 1e8]) @ along
    stiffness[0, 1] = np.nextafter(stiffness[1, 0], np.inf)
    load = np.array([100.0, -20.0, 5.0])
    found = solve_contact(ContactProblem(("x", "y", "z"), stiffness, load))
    wanted = np.linalg.solve(stiffness, load)
    np.testing.assert_allclose([found.place[name] for name in "xyz"], wanted, rtol=1e-9)
    stiffness[0, 1] *= 1.0 + 1e-6
    with pytest.raises(ValueError, match="is not symmetric"):
        solve_contact(ContactProblem(("x", "y", "z"), stiffness, load))


SLIPS = RadialLaw((Piece(3.0, 0.0, math.inf, "slip"),))
XY, YX = np.eye(2), np.eye(2)[::-1]


@pytest.mark.parametrize("method", METHODS)
def test_of_two_pads_that_hold_one_body_at_two_places_one_slips(method: str) -> None:
    """Without load, and under a load that is exactly the friction of one of them."""
    pads = (
        Radial("a", XY, np.array([0.0, 1.0]), SLIPS),
        Radial("b", YX, np.zeros(2), SLIPS),
    )
    limit = Row("limit", "stop", np.array([1.0, -1.0]), 2.0, RIGID)
    for load in ([0.0, 0.0], [3.0, 3.0]):
        problem = ContactProblem(("x", "y"), np.zeros((2, 2)), load, (limit,), (), pads)
        found = solve_contact(problem, method=method)
        x = np.array([found.place["x"], found.place["y"]])
        energy = 3.0 * (math.hypot(x[0], x[1] - 1.0) + math.hypot(*x)) - x @ load
        assert energy == pytest.approx(3.0 - load[1], abs=1e-9)


def test_a_pad_holds_by_exactly_its_friction_what_others_could_move() -> None:
    spring = RadialLaw((Piece(0.0, 5.0, math.inf, "spring"),))
    law = RadialLaw((Piece(2.0, 5.0, 2.0, "slip"), Piece(12.0, 0.0, math.inf, "end")))
    radials = (
        Radial("spring", np.array([[-2.0, 2.0, -1.0], [0.0, -2.0, 1.0]]), np.zeros(2), spring),
        Radial("pad", np.eye(3)[1:], np.zeros(2), law),
    )
    load = [0.0, 0.0, -2.0]
    found = solve_contact(ContactProblem(("x", "y", "z"), np.zeros((3, 3)), load, radials=radials))
    assert found.place == pytest.approx({"x": 0.0, "y": 0.0, "z": 0.0}, abs=1e-12)
    assert found.pull["pad"] == pytest.approx([0.0, -2.0])


def test_limits_without_any_room_that_contradict_one_another_are_named() -> None:
    """A pin whose graph is all steps, and a stop that lets the body nowhere near it."""
    steps = RadialLaw((Piece(1.0, 5.0, 0.0, "first"), Piece(2.0, 0.0, 0.0, "second")))
    pin = Radial("pin", XY, np.array([1.0, 2.0]), steps)
    stop = Row("stop", "stop", np.array([2.0, 1.0]), 1.0, RIGID)
    with pytest.raises(Refused, match="rigid limits contradict one another: stop, pin"):
        solve_contact(ContactProblem(("x", "y"), XY, [-2.0, -1.0], (stop,), (), (pin,)))


def test_a_stop_that_just_touches_where_friction_is_used_up_is_no_hindrance() -> None:
    """At rest the pad carries exactly its friction; the limit beside it carries nothing."""
    law = RadialLaw((Piece(3.0, 0.0, 1.0, "slip"), Piece(3.0, 10.0, math.inf, "stop")))
    pad = Radial("pad", XY, np.array([1.0, -1.0]), law)
    rows = [
        Row(f"{k}", "stop", vector, gap, PowerLaw(b, 0.0))
        for k, (vector, gap, b) in enumerate(
            [([1, -1], 2, 1), ([1, 1], 1, 1), ([0, 1], 0, 1), ([1, 1], 0, 0.01), ([2, 0], 2, 0.1)]
        )
    ]
    springs = np.array([[10.0, 10.0], [10.0, 11.0]])
    found = solve_contact(ContactProblem(("x", "y"), springs, [0.0, -4.0], rows, (), (pad,)))
    assert found.place == pytest.approx({"x": 1.0, "y": -1.0})
    assert found.pull["pad"] == pytest.approx([0.0, -3.0])


def test_what_comes_to_rest_only_at_infinity_is_refused() -> None:
    """The pad's friction equals the load along y; springs hold it off its centre across."""
    along = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    pad = Radial("pad", along, np.array([1.0, 0.0]), SLIPS)
    limit = Row("limit", "stop", np.array([1.0, -1.0, -1.0]), -1.0, RIGID)
    springs = np.array([[110.0, 0.0, -90.0], [0.0, 0.0, 0.0], [-90.0, 0.0, 110.0]])
    problem = ContactProblem(("x", "y", "z"), springs, [-1.0, 3.0, 0.0], (limit,), (), (pad,))
    with pytest.raises(Refused, match="under the load y would come to rest only at infinity"):
        solve_contact(problem)
