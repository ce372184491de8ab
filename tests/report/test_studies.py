"""Pictures of sweeps and tolerance studies, from made-up data in the documented form."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from tests.support import shipped

import loadshare as ls
from loadshare.report.figures.sweep import sweep
from loadshare.report.figures.tolerance import tolerance


@pytest.fixture
def line() -> xr.Dataset:
    """Return five points over one parameter; the last one is refused."""
    grid = np.array([0.0, 2.0, 4.0, 6.0, 8.0])
    share = np.column_stack([np.ones(5), 1.05 - 0.005 * grid, 1.05 - 0.005 * grid])
    share[-1] = np.nan
    force = np.zeros((5, 2, 1, 2))
    force[:, 0, 0] = np.column_stack([3.0 * grid, 4.0 * grid])
    force[:, 1, 0] = np.column_stack([6.0 * grid, 8.0 * grid])
    torque = np.stack([1000.0 + grid, 1000.0 - grid], axis=1)[:, None, :].repeat(2, axis=1)
    return xr.Dataset(
        {
            "status": ("rings.4.float", ["certified"] * 4 + ["refused"]),
            "omega": (("rings.4.float", "stage"), share, {"units": "1", "long_name": "largest Ω"}),
            "torque": (("rings.4.float", "position", "mesh"), torque, {"units": "N·m"}),
            "reaction": (
                ("rings.4.float", "position", "float", "component"),
                force,
                {"units": "N", "long_name": "reaction"},
            ),
        },
        coords={
            "rings.4.float": ("rings.4.float", grid, {"units": "um"}),
            "stage": ["I", "II", "system"],
            "mesh": ["a-b", "a-c"],
            "gear": ["a", "b", "c"],
            "position": [1, 2],
            "float": ["b"],
            "component": ["x", "y"],
        },
        attrs={"case": "made up"},
    )


@pytest.fixture
def plane() -> xr.Dataset:
    """Return a grid of three by two points; one of them is refused."""
    values = np.array([[1.0, 1.1], [1.2, 1.3], [1.4, np.nan]])
    status = np.where(np.isfinite(values), "certified", "refused")
    return xr.Dataset(
        {
            "status": (("p", "q"), status),
            "omega": (("p", "q", "stage"), values[..., None], {"units": "1", "long_name": "Ω"}),
        },
        coords={
            "p": ("p", [0.0, 1.0, 3.0], {"units": "um"}),
            "q": ("q", [10.0, 20.0], {"units": "N*m"}),
            "stage": ["II"],
        },
    )


def test_lines_over_one_parameter(line, read):
    spec = read(sweep(line, events=[(3.0, "the stop opens")]).spec)
    rows = spec.rows("point", "name")
    # The system repeats stage II and is left out.
    assert {r["name"] for r in rows} == {"I", "II"}
    shown = {r["x"]: r["y"] for r in rows if r["name"] == "II"}
    assert shown == {x: (None if x == 8.0 else 1.05 - 0.005 * x) for x in (0, 2, 4, 6, 8)}
    words = spec.words()
    assert "rings.4.float [µm]" in words
    assert "1 of 5 points not certified" in words
    assert "made up" in words
    (rule,) = spec.marks("rule")
    assert [(r["x"], r["text"]) for r in rule["rows"]] == [(3.0, "the stop opens")]


def test_words_of_an_event_keep_clear_of_the_lines(line, read):
    """Both lines fall from the upper left, so a label near it starts below them."""
    spec = read(sweep(line, events=[(1.0, "an event"), (7.0, "another event")]).spec)
    (rule,) = spec.marks("rule")
    first, second = (r["top"] for r in rule["rows"])
    assert 30 < first < 200
    assert second == 4


def test_names_and_positions_can_be_chosen(line, read):
    rows = read(sweep(line, "reaction").spec).rows("point", "name")
    # The size of (6, 8) N per µm, the larger of the two positions.
    assert {r["x"]: r["y"] for r in rows} == pytest.approx({x: 10.0 * x for x in (0, 2, 4, 6, 8)})
    rows = read(sweep(line, "reaction", position=1).spec).rows("point", "name")
    assert {r["x"]: r["y"] for r in rows} == pytest.approx({x: 5.0 * x for x in (0, 2, 4, 6, 8)})
    rows = read(sweep(line, "torque", names=["a-c"]).spec).rows("point", "name")
    assert {r["name"] for r in rows} == {"a-c"}
    assert "torque, largest over positions [N·m]" in read(sweep(line, "torque").spec).words()


def test_round_off_does_not_look_like_a_result(line, read):
    """A pinion on its stop has no margin; that of another is a fraction of an atom."""
    margin = np.array([3e-17, -2e-17, 0.0, 1e-16, 0.0]).reshape(5, 1, 1).repeat(2, axis=1)
    attrs = {"units": "m", "long_name": "margin"}
    data = line.assign(margin=(("rings.4.float", "position", "float"), margin, attrs))
    spec = read(sweep(data, "margin").spec)
    assert "margin, largest over positions [µm]" in spec.words()
    low, high = spec.marks("point")[0]["encoding"]["y"]["scale"]["domain"]
    # At least a nanometre, in µm, with a margin on both sides.
    assert high - low == pytest.approx(1.16e-3)
    assert low < 0.0 < high


def test_a_float_without_a_ring_has_no_reaction_to_show(line, read):
    names = {"float": ["b", "c"]}
    data = line.reindex(names, fill_value=0.0).assign(
        margin=(("float",), np.array([1e-6, np.nan]), {"units": "m"})
    )
    assert {r["name"] for r in read(sweep(data, "reaction").spec).rows("point", "name")} == {"b"}
    both = read(sweep(data, "reaction", names=["b", "c"]).spec).rows("point", "name")
    assert {r["name"] for r in both} == {"b", "c"}


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"show": "colour"}, "no variable 'colour'. Allowed: omega, torque, reaction"),
        ({"names": ["III"]}, "no stage III. Allowed: I, II, system"),
        ({"show": "torque", "position": 9}, "no position 9"),
    ],
)
def test_what_is_not_there_is_reported(line, settings, message):
    with pytest.raises(ls.LoadshareError, match=message):
        sweep(line, **settings)


def test_a_sweep_without_any_value_is_not_drawn(line):
    """A case without stages has no Ω."""
    none = line.assign(omega=line["omega"] * np.nan)
    with pytest.raises(ls.LoadshareError, match="no value of omega at any point"):
        sweep(none)


def test_three_parameters_cannot_be_drawn(plane):
    with pytest.raises(ls.LoadshareError, match="over 3 parameters"):
        sweep(plane.expand_dims("r"))


def test_a_map_over_two_parameters(plane, read):
    spec = read(sweep(plane).spec)
    good = [u for u in spec.marks("rect") if "color" in u["encoding"]]
    refused = [u for u in spec.marks("rect") if "color" not in u["encoding"]]
    cells = {(r["a"], r["b"]): r for u in good for r in u["rows"]}
    assert {k: r["value"] for k, r in cells.items()} == {
        (0.0, 10.0): 1.0,
        (0.0, 20.0): 1.1,
        (1.0, 10.0): 1.2,
        (1.0, 20.0): 1.3,
        (3.0, 10.0): 1.4,
    }
    # Cells meet half-way between grid values.
    assert (cells[1.0, 10.0]["x"], cells[1.0, 10.0]["x2"]) == (0.5, 2.0)
    assert [(r["a"], r["b"]) for u in refused for r in u["rows"]] == [(3.0, 20.0)]
    assert "q [N·m]" in spec.words()


def test_a_sweep_of_the_seeds_ring(read):
    """This uses the study's own data set."""
    from tests.support import shipped

    from loadshare.study.sweep import sweep as run

    found = run(shipped("fgfbstts/limit_ring"), {"rings.4.float": ["0 um", "4 um"]}, positions=[1])
    rows = read(sweep(found.dataset, "pair_omega").spec).rows("point", "name")
    shown = {r["x"]: r["y"] for r in rows if r["name"] == "II"}
    # The figures of the tutorial, printed with five decimals.
    assert shown == pytest.approx({0.0: 1.04713, 4.0: 1.02455}, abs=2e-4)


@pytest.fixture
def scattered() -> xr.Dataset:
    """Return samples of Ω and indices of three inputs."""
    omega = 1.0 + np.abs(np.random.default_rng(5).normal(0.02, 0.01, (2000, 2)))
    order = np.array([[0.1, 0.6, 0.2]] * 2)
    return xr.Dataset(
        {
            "omega": (("sample", "stage"), omega),
            "quantile": (("stage", "level"), np.quantile(omega, [0.5, 0.95], axis=0).T),
            "exceedance": ("stage", [0.1, 0.0123]),
            "exceedance_low": ("stage", [0.1, 0.01]),
            "exceedance_high": ("stage", [0.1, 0.02]),
            "first_order": (("stage", "input"), order),
            "total_order": (("stage", "input"), order + 0.05),
            "total_order_low": (("stage", "input"), order),
            "total_order_high": (("stage", "input"), order + 0.1),
        },
        coords={"stage": ["II", "system"], "level": [0.5, 0.95], "input": ["a", "b", "c"]},
        attrs={"case": "made up", "limit": 1.045},
    )


def test_the_distribution_holds_every_sample(scattered, read):
    spec = read(tolerance(scattered).spec)
    bars = spec.rows("rect", "share")
    assert sum(r["count"] for r in bars) == 2000
    assert sum(r["share"] for r in bars) == pytest.approx(1.0, rel=1e-12)
    reached = [r["p"] for r in spec.rows("line", "p")]
    assert reached[0] == 0.0
    assert reached[-1] == pytest.approx(1.0, rel=1e-12)
    assert reached == sorted(reached)
    words = spec.words()
    assert "P(Ω > 1.045) = 0.0123 (95 %: 0.01 to 0.02)" in words
    assert "2,000 samples" in words
    marks = {r["text"]: r["x"] for r in spec.rows("rule", "text")}
    assert set(marks) == {"50 %", "95 %", "limit"}
    assert marks["limit"] == 1.045
    # Half of the samples are below the median, to the width of a bin.
    below = max(r["p"] for r in spec.rows("line", "p") if r["x"] <= marks["50 %"])
    assert below == pytest.approx(0.5, abs=0.05)


def test_inputs_are_sorted_by_what_they_do(scattered, read):
    spec = read(tolerance(scattered, "II").spec)
    (bars,) = spec.marks("bar")
    assert bars["encoding"]["y"]["sort"] == ["b", "c", "a"]
    assert {(r["input"], round(r["index"], 6)) for r in bars["rows"] if r["order"] == "alone"} == {
        ("a", 0.1),
        ("b", 0.6),
        ("c", 0.2),
    }


def test_counts_draw_what_samples_draw(scattered, read):
    edges = np.linspace(1.0, 1.07, 31)
    counts = np.array([np.histogram(scattered["omega"][:, k], edges)[0] for k in (0, 1)])
    binned = xr.Dataset(
        {"count": (("stage", "bin"), counts)}, coords={"stage": ["II", "system"], "edge": edges}
    )
    rows = read(tolerance(binned).spec).rows("rect", "share")
    assert [r["count"] for r in rows] == counts[1].tolist()


@pytest.mark.parametrize("stage", ["III", ""])
def test_a_stage_that_is_not_there_is_reported(scattered, stage):
    with pytest.raises(ls.LoadshareError, match="Allowed: II, system"):
        tolerance(scattered, stage)


def test_a_study_without_figures_is_reported(scattered):
    with pytest.raises(ls.LoadshareError, match="needs omega"):
        tolerance(scattered.drop_vars("omega"))
    with pytest.raises(ls.LoadshareError, match="no sample"):
        tolerance(scattered.assign(omega=scattered["omega"] * np.nan))


def test_pictures_print_units_alike():
    """The picture of critical values used to have `um` next to the `µm` of the sweep's."""
    found = ls.critical(
        shipped("fgfbstts/limit_ring"), "rings.4.float", "8 um", "9 um", positions=[1]
    )
    text = str(found.plot().begin().spec)
    assert "rings.4.float [µm]" in text
    assert "[um]" not in text


@pytest.mark.parametrize(
    ("key", "told"), [("gears.planet4.centre.angle", True), ("operating.torque", False)]
)
def test_bars_of_falling_inputs_say_which_way_the_figure_goes(key, told):
    """Ω rises to both sides, and the bar of the falling input points down."""
    found = ls.sensitivity(shipped("planetary/four_planets"), key)
    assert (
        "as an input falls, Ω changes against its bar" in str(found.plot().begin().spec)
    ) == told
