"""Critical values against closed forms, independent solves, and scans of certified active sets."""

import tomllib
from dataclasses import asdict, replace
from itertools import pairwise

import numpy as np
import pytest
from tests.support import coasting, lost_contact, mostly_slow, round_ring, shipped

import loadshare as ls
from benchmarks import families
from benchmarks.critical_paths.compare import compared
from benchmarks.critical_paths.draw import random_path
from benchmarks.critical_paths.judge import Outcome, followed, judged, shown
from benchmarks.critical_paths.table import text
from loadshare.case.starter import starter_case
from loadshare.study.critical import Critical, Unproved
from loadshare.study.follow.active import switch_names
from loadshare.study.follow.line import Line
from loadshare.study.follow.search import ChangeSearch
from loadshare.study.follow.zero import first_zero
from loadshare.study.parameter import Parameter, read_parameter
from loadshare.study.positions import certified
from loadshare.study.sensitivity.branch import Setting
from loadshare.train import build_train

EXACT = 1e-12
"""Relative accuracy of root-finding on a branch."""


def off_line() -> ls.Case:
    """Return the seed's Fig. 13 with idlers 0.2 µm off the line through their pinion.

    On the line, the forces of a pinion's two meshes are opposite, so its rest position between its
    arcs is undetermined. Off the line, they press the pinion slightly to one side.
    """
    case = shipped("fgfbstts/limit_ring")
    return case.replace({f"gears.{g}.centre.distance": "525.6314 mm" for g in "6789"})


@pytest.fixture(scope="module")
def rings():
    """Return critical values of both float ranges, from zero to more than enough."""
    return ls.critical(off_line(), "rings.*.float", "0 um", "12 um", positions=[1])


def unlimited(case: ls.Case, pinion: str) -> float:
    """Return the displacement of a pinion across its neighbours [µm] when no stop limits it.

    The equilibrium is solved to round-off on its active set: the certificate alone allows an error
    of the displacement of 1e-9 of the deflection, which is thirty times as large.
    """
    train = build_train(case.replace({"rings.4.float": "1 mm", "rings.5.float": "1 mm"}))
    setting = Setting.at(train, 1)
    at = setting.structure.coordinates
    _, z = setting.branch_of(certified(train, 1).equilibrium)
    x = z[: at.size] * setting.structure.length
    return abs(float(train.rings[pinion].across @ at.moved(pinion) @ x)) * 1e6


@pytest.mark.parametrize("pinion", ["4", "5"])
def test_a_stop_is_free_where_the_float_needs_no_more(rings, pinion):
    """The critical range is exactly the displacement without a limit."""
    (event,) = [e for e in rings.of("leaves boundary", pinion) if "stop" in e.element]
    assert event.value == pytest.approx(unlimited(off_line(), pinion), rel=EXACT)


@pytest.fixture(scope="module")
def shipped_rings():
    case = shipped("fgfbstts/limit_ring")
    return ls.critical(case, "rings.*.float", "0 um", "12 um", positions=[1])


@pytest.mark.parametrize(("pinion", "printed"), [("4", 8.36), ("5", 2.91)])
def test_the_thresholds_of_fig_13(shipped_rings, pinion, printed):
    """Printed: 8.36 and 2.91 µm; the reconstruction gives 8.35 and 2.97 µm."""
    case, found = shipped("fgfbstts/limit_ring"), shipped_rings
    (event,) = [e for e in found.of("leaves boundary", pinion) if "stop" in e.element]
    assert event.confirmed
    assert event.value == pytest.approx(printed, abs=0.07)
    # A free pinion, and so its float, may be anywhere between its arcs, which are 0.2 nm apart.
    assert event.value == pytest.approx(unlimited(case, pinion), rel=1e-9)


def test_what_is_as_near_to_a_change_as_round_off_is_given_up_at_once(shipped_rings):
    """The range of a free pinion between its arcs is proportional to the square of the float, so
    none can be reported close to the change. Bisection used to spend 1500 solves on it in vain.
    """
    assert [gap.why for gap in shipped_rings.unproved] == [
        "all of it is too close to a change for double precision"
    ] * 2
    for gap in shipped_rings.unproved:
        assert 0.0 < gap.stop - gap.start < 1e-5
        assert any(abs(e.value - gap.start) < 1e-7 for e in shipped_rings.events)


def test_every_event_is_confirmed_by_certified_solves(rings):
    assert [e.element for e in rings.events] == [
        "ring 5: arc 8",
        "ring 5: arc 9",
        "ring 5: upper stop",
        "ring 4: arc 6",
        "ring 4: arc 7",
        "ring 4: upper stop",
    ]
    for event in rings.events:
        assert event.confirmed
        assert event.worst <= 1e-9
        assert event.together == 1
        assert 0.0 < event.apart < 12.0
    assert rings.unproved == ()
    assert str(rings.events[-1]) == "8.35008 um: ring 4: upper stop: float leaves boundary"


def test_two_events_in_a_millionth_of_the_interval_are_distinguished():
    """Over 20 mm, the load of pinion 5 passes from one arc to the other within 20 nm."""
    case = off_line().replace({"rings.4.float": "20 um"})
    found = ls.critical(case, "rings.5.float", "0 mm", "20 mm", positions=[1])
    values = [e.value for e in found.events]
    assert [e.element for e in found.events] == [
        "ring 5: arc 8",
        "ring 5: arc 9",
        "ring 5: upper stop",
    ]
    assert values[1] - values[0] < 2.5e-5
    assert all(e.confirmed for e in found.events)


def test_marks_for_a_picture():
    case = shipped("fgfbstts/limit_ring")
    found = ls.critical(case, "rings.4.float", "8 um", "9 um", positions=[2, 3])
    marks = dict(found.marks())
    assert set(marks) == {e.value for e in found.events if e.position == 2}
    assert "gear 4: float leaves boundary" in marks.values()
    assert found.marks(3) == found.marks(2)
    assert ls.critical(case, "rings.4.float", "10 um", "11 um", positions=[1]).marks() == ()


def test_positions_that_differ_in_nothing_have_the_same_events(rings):
    case = shipped("fgfbstts/limit_ring")
    found = ls.critical(case, "rings.5.float", "2 um", "4 um", positions=[1, 3])
    assert {e.position for e in found.events} == {1, 3}
    assert len({e.value for e in found.events if "stop" in e.element}) == 1


def test_the_clearance_that_a_spline_uses_up():
    """The clearance opens at the displacement of the fully floating pinion."""
    case = shipped("fgfbstts/spline_clearance")
    found = ls.critical(case, "splines.*.clearance", "0 um", "20 um", positions=[1])
    free = ls.solve(shipped("fgfbstts/full_float"), positions=[1]).positions[0]
    (event,) = found.of("clearance opens", "4")
    assert event.value == pytest.approx(np.hypot(*free.displacement["4"]) * 1e6, rel=EXACT)
    # Pinion 5 is freed first, as the paper finds; both shafts bend throughout until S2 = F_m / K_w.
    assert found.of("clearance opens", "5")[0].value < event.value
    both = found.of("clearance used up")
    assert [e.value for e in both] == pytest.approx([50.0 / 1.78e7 * 1e6] * 2, rel=1e-9)
    assert {e.together for e in both} == {2}


def test_slip_starts_where_friction_is_what_a_sticking_spline_carries():
    """A sticking spline carries K_w R whatever its bound, so the bound that frees it is known."""
    case = shipped("fgfbstts/full_float")
    stuck = case.replace({"splines.4.normal_force": "1 MN", "splines.5.normal_force": "1 MN"})
    held = ls.solve(stuck, positions=[1]).floats[0]["4"].spline_force
    found = ls.critical(stuck, "splines.4.normal_force", "100 N", "20 kN", positions=[1])
    (event,) = found.of(gear="4")
    assert (event.kind, event.before, event.after) == ("slip ends", "slip", "stick")
    assert event.value * 1e3 == pytest.approx(held / 0.1 * 1e3, rel=1e-10)


def test_load_and_gap_scale_alike():
    """With linear springs, a star loses contact at a gap in proportion to the load."""
    star = families.star(4)
    gap = ls.critical(star, 'meshes."sun-planet1".gap', "0.1 mrad", "3 mrad").events[0]
    load = ls.critical(lost_contact(), "operating.torque", "1 N*m", "1 kN*m").events[0]
    assert load.value / 1000.0 == pytest.approx(0.4 / gap.value, rel=EXACT)
    # The planet's other mesh and the opposite planet lose contact at the same load.
    assert load.together == 4
    assert load.kind == "contact closes"


def sets_along(
    case: ls.Case, key: str, values: np.ndarray, unit: str
) -> list[tuple[float, set[str]]]:
    """Return changes of the certified active set between neighbouring values, by upper value."""
    changes, last = [], None
    for value in values:
        answer = ls.explain(case.replace({key: f"{float(value)!r} {unit}"}))
        setting = Setting.at(answer.train, 1)
        active = setting.active_set(answer.equilibrium)
        moved = active.changes(last or active, setting.structure)
        if moved:
            names = switch_names(setting.structure)
            changes.append((float(value), {names[k] for k in moved}))
        last = active
    return changes


@pytest.mark.parametrize(
    ("case", "key", "ends", "unit"),
    [
        (coasting, "operating.torque", (1.0, 300.0), "N*m"),
        (round_ring, "rings.sun.radius", (0.5, 20.0), "um"),
        pytest.param(
            lambda: shipped("fgfbstts/all_elements"),
            *("operating.power", (20.0, 2000.0), "kW"),
            marks=pytest.mark.slow,
        ),
    ],
    ids=["coast flanks", "round ring", "all elements"],
)
@pytest.mark.quick(1)
def test_a_scan_of_certified_sets_finds_the_same_events(case, key, ends, unit):
    low, high = ends
    found = ls.critical(case(), key, f"{low} {unit}", f"{high} {unit}", positions=[1])
    values = np.linspace(low, high, 41)
    events = [(e.value, e.element) for e in found.events]
    for upper, changed in sets_along(case(), key, values, unit):
        step = values[1] - values[0]
        between = {name for value, name in events if upper - step <= value <= upper}
        assert changed == between
        events = [e for e in events if not upper - step <= e[0] <= upper]
    assert events == []


FULL = "fgfbstts/full_float"
ECCENTRICITY = "errors.6.eccentricity.amount"


@pytest.mark.parametrize("end", mostly_slow((100.0, 300.0, 600.0), (300.0,)))
def test_events_do_not_depend_on_where_the_range_ends(end):
    """Slip, stick, slip: the gauge has a V-shaped minimum within 2 % of the range."""
    found = ls.critical(shipped(FULL), ECCENTRICITY, "0 um", f"{end} um", positions=[1])
    known = [61.187254352177, 68.846000995651, 598.339078636623]
    assert [e.value for e in found.events] == pytest.approx(
        [v for v in known if v < end], rel=1e-12
    )
    assert all(e.confirmed for e in found.events)
    assert found.unproved == ()


@pytest.mark.parametrize("end", mostly_slow((230.0, 450.0), (230.0,)))
def test_a_branch_that_ends_on_the_way_is_left_in_time(end):
    """Ends of the range at which following used to lose the branch."""
    case = shipped(FULL).replace(
        {"splines.4.clearance": "119 um", "splines.4.normal_force": "886 N"}
    )
    found = ls.critical(case, ECCENTRICITY, "0 um", f"{end} um", positions=[3])
    values = [58.230978147796, 71.802277200032, 223.804985881803]
    assert [e.value for e in found.events] == pytest.approx(values, rel=1e-12)
    assert found.unproved == ()


@pytest.mark.parametrize("end", [800.0, 763.7, 500.0])
@pytest.mark.quick(1)
def test_an_event_is_exact_where_gauges_go_on_steeper_beyond_it(end):
    """A contact opens and lets an idler float: the room beyond it shrinks 400 times as fast."""
    key = "errors.5.eccentricity.amount"
    found = ls.critical(shipped("fgfbstts/load"), key, "0 um", f"{end} um", positions=[1])
    event = next(e for e in found.events if e.element == "4-6")
    assert event.value == pytest.approx(190.9036884315901, rel=1e-13)


@pytest.mark.parametrize(("before", "beyond"), [(2e-3, 0.8), (0.8, 2e-3), (1.0, 1.0)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_zero_is_found_whatever_the_gauges_do_beyond_it(before, beyond, sign):
    zero, requested = sign * 1.9090368843159013, []

    def of(values: np.ndarray) -> np.ndarray:
        requested.append(values)
        left = sign * (zero - values)
        least = np.where(left > 0.0, before, beyond) * left
        return np.stack([least, 1.0 + 0.0 * values], axis=1)

    values = sign * np.array([1.8, 1.9, 2.0])
    assert first_zero(of, values, of(values), 2) == pytest.approx(zero, rel=1e-15)
    assert len(requested) <= 5


def searched(case: ls.Case, key: str, low: float, high: float, unit: str) -> ChangeSearch:
    line = Line(case, read_parameter(case, key, unit), low, high)
    return ChangeSearch(line, 1, low, high)


def test_no_set_is_proved_to_hold_over_its_events():
    """On either side of two events the spline slips: one set, which does not hold in between."""
    search = searched(shipped(FULL), ECCENTRICITY, 0.0, 100.0, "um")
    values = [61.1, 61.15, 68.9, 68.95]
    points = search.points(np.array(values))
    assert len({p.active for p in points}) == 1
    left = search.proved_alike(list(pairwise(points)))
    assert [first.value for first, _ in left] == [61.15]


def test_a_ring_without_play_pins_its_gear_only_there():
    """A set that holds at one value only is left immediately, and not followed further."""
    case = round_ring().replace({"rings.sun.offset": ["0 um", "0 um"]})
    search = searched(case, "rings.sun.radius", 0.0, 2.0, "um")
    first, last = search.points(np.array([0.0, 1.0]))
    assert first.active != last.active
    assert search.exit(first, last) == 0.0


def drawn(number: int) -> ChangeSearch:
    path = random_path(number)
    line = Line(path.case, read_parameter(path.case, path.keys, path.unit), path.start, path.stop)
    return ChangeSearch(line, 1, path.start, path.stop)


def test_a_spline_without_friction_and_force_is_free():
    """A pinion has lost its branch, and its spline the torque that determines its friction."""
    points = drawn(329).points(np.array([680.0, 1000.0, 2000.0, 3295.5, 3295.512343928895]))
    assert len({p.active for p in points}) == 1


def test_a_float_comes_to_its_round_limit_where_the_limit_lets_go_of_it():
    """The force of a spline at the end of its clearance is zero where the float begins."""
    search = drawn(37)
    pressed = search.points(np.array([2.1867, 2.18701]))
    (floating,) = search.points(np.array([2.19]))
    beyond = []
    for point in pressed:
        equations = search.equations(point.active)
        state = equations.state(point.z[None], search.line.numbers(1, np.array([point.value])))
        spline = equations.radials[1]
        beyond.append(float(state.polars[spline].radius[0] - state.laws[spline].reach[0]))
    values = [p.value for p in pressed]
    zero = values[1] + beyond[1] * (values[1] - values[0]) / (beyond[0] - beyond[1])
    assert search.exit(floating, pressed[1]) == pytest.approx(zero, rel=1e-9)


@pytest.mark.parametrize("number", mostly_slow((1, 6, 193), (1, 6)))
@pytest.mark.quick(1)
def test_random_paths_agree_with_a_scan(number):
    """On path 193 an enclosure neither contracts nor diverges, because a matrix is singular."""
    outcome = judged(random_path(number), 400, "vectorised")
    faults = (outcome.missed, outcome.invented, outcome.moved, outcome.refused, outcome.raised)
    assert faults == ([], [], [], "", "")


def test_a_table_tells_what_a_run_came_to():
    fine = {"number": 6, **asdict(Outcome(("operating.torque",), "N*m", 1.0, 2.0, events=2))}
    wrong = {**fine, "number": 7, "missed": ["sun-planet at 1.5: 1 changes, 0 events"]}
    table = text([fine, wrong])
    assert "\n- 7: operating.torque 1 to 2 N*m: 0 unproved" in table
    assert "| events | 4 |" in table
    assert "| missed | 1 |" in table
    assert "| invented | 0 |" in table


@pytest.mark.slow
@pytest.mark.parametrize("number", range(20))
def test_more_random_paths_agree_with_a_scan(number):
    outcome = judged(random_path(number), 10_000, "vectorised")
    assert (outcome.missed, outcome.invented, outcome.moved, outcome.raised) == ([], [], [], "")


def test_a_scan_shows_what_events_leave_out():
    """This tests the comparison itself: with one event missing, or one too many, it complains."""
    path = random_path(3)
    found = followed(path, path.stop)
    assert found.events
    values, seen = shown(path, found, 400, "vectorised")
    assert compared(found, values, seen) == ([], [])
    fewer = replace(found, events=found.events[1:])
    assert compared(fewer, values, seen)[0]


def test_an_interval_without_events():
    found = ls.critical(shipped("fgfbstts/limit_ring"), "rings.4.float", "9 um", "12 um")
    assert found.events == ()


@pytest.mark.parametrize(
    ("key", "start", "stop", "message"),
    [
        ("rings.4.float", "3 um", "2 um", "start 3 um is not below stop 2 um"),
        ("rings.4.flot", "0 um", "2 um", "Did you mean float?"),
        ("rong.*.float", "0 um", "2 um", "matches no key of the case"),
        ("rings.4.float [um]", 0, 2, "has a unit in its name"),
        ("rings.4.float", "0 um", "2 kg", "cannot be expressed in um"),
        ("rings.4.float", "0 um", "2 N", "cannot be expressed in um"),
        ("rings..float", "0 um", "2 um", "is not a key path"),
        ("gears.1.teeth", 20, 30, "is a count: .* Allowed: an input that is not a count"),
        ("gears.*.teeth", 20, 30, "gears.1.teeth: is a count"),
        ("operating.positions", 1, 5, "is a count"),
        ("gears.1.copies", 2, 4, "is a count"),
    ],
)
def test_what_cannot_be_followed_is_reported(key, start, stop, message):
    with pytest.raises(ls.CaseError, match="(?s)" + message.replace("?", r"\?")):
        ls.critical(shipped("fgfbstts/limit_ring"), key, start, stop)


def test_an_end_without_an_equilibrium_is_refused():
    # Gear 6 floats with its pinion, and nothing limits either of them.
    case = shipped("fgfbstts/limit_ring").replace({"rings": None})
    case = case.replace({"gears.6.support": "free"})
    with pytest.raises(ls.Refused, match="position 1"):
        ls.critical(case, "operating.power", "1000 kW", "2000 kW", positions=[1])


def two_paths(support: str) -> ls.Case:
    """Return two paths without errors; one has the larger backlash, and idles when it brakes."""
    backlash = {"backlash": "30 um"}
    return ls.Case(
        {
            "operating": {"input": "s", "output": "o", "torque": "500 N*m"},
            "gears": {
                "s": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]},
                "i1": {"base_radius": "80 mm", "centre": ["0 mm", "140 mm"], "support": support},
                "i2": {"base_radius": "80 mm", "centre": ["0 mm", "-140 mm"]},
                "o": {"base_radius": "160 mm", "centre": ["215 mm", "0 mm"]},
            },
            "meshes": {
                "s-i1": {"stiffness": "5e5 N*m/rad"} | backlash,
                "s-i2": {"stiffness": "4e5 N*m/rad"} | backlash,
                "i1-o": {"stiffness": "5e5 N*m/rad"} | backlash,
                "i2-o": {"stiffness": "6e5 N*m/rad", "backlash": "50 um"},
            },
        }
    )


@pytest.mark.parametrize("support", ["rigid", "2e8 N/m"])
@pytest.mark.parametrize("ends", [(-300, 300), (-300, 0), (-10, -0.0001), (-3, 3), (-0.02, 300)])
@pytest.mark.quick(1)
def test_what_carries_nothing_does_not_change(support, ends) -> None:
    """While an idler may turn freely, contact at the end of its range is no event."""
    case = two_paths(support)
    low, high = (f"{end} N*m" for end in ends)
    found = ls.critical(case, "operating.torque", low, high)
    before = [e for e in found.events if e.value < -1e-6]
    (opens,) = {e.value for e in before} or {None}
    assert (opens is not None) == (ends[0] == -300)
    if opens is not None:
        assert {e.element for e in before} == {"s-i2 coast", "i2-o coast"}
        for torque, carries in ((opens - 0.01, True), (opens + 0.01, False)):
            at = ls.solve(case.replace({"operating.torque": f"{torque} N*m"})).positions[0]
            assert (abs(at.torque["s-i2"]) > 1e-9) == carries


def test_a_torque_that_turns_round_changes_the_flanks_of_meshes_without_backlash() -> None:
    """One flank of each mesh carries on either side, so no contact opens; the change has a name."""
    case = ls.Case(tomllib.loads(starter_case("box", "planetary")))
    found = ls.critical(case, "operating.torque", "-300 N*m", "500 N*m")
    assert {(e.value, e.kind, e.before, e.after) for e in found.events} == {
        (0.0, "flank changes", "coast", "drive")
    }
    assert {e.element for e in found.events} == set(case.meshes)
    assert not any(e.confirmed for e in found.events)
    assert ls.critical(case, "operating.torque", "100 N*m", "500 N*m").events == ()


def test_flanks_that_change_at_one_value_are_one_event() -> None:
    """A reversed torque leaves one flank and presses the other."""
    found = ls.critical(two_paths("rigid"), "operating.torque", "-30 N*m", "30 N*m")
    (value,) = {e.value for e in found.events}
    assert value == 0.0
    assert {e.together for e in found.events} == {len(found.events)}


def test_keys_that_can_be_read_only_once_are_tied():
    keys = ["rings.4.float", "rings.5.float"]
    ends = {"start": "9 um", "stop": "10 um", "positions": [1]}
    once = ls.critical(shipped("fgfbstts/limit_ring"), iter(keys), **ends)
    assert once.parameter.keys == tuple(keys)


def test_a_range_without_events_says_so():
    found = ls.critical(
        shipped("fgfbstts/limit_ring"), "rings.4.float", "8.5 um", "9 um", positions=[1]
    )
    assert "events: none" in repr(found)


def test_a_single_interval_is_no_intervals():
    parameter = Parameter("float", ("rings.4.float",), "um")
    found = Critical(parameter, 0.0, 1.0, (), (Unproved(1, 0.0, 1.0, "of a test"),))
    assert dict(found._view().facts)["not proved"] == "1 interval"
    assert found.plot().spec["title"]["subtitle"] == ["1 interval not proved, grey"]
