"""Pictures of torque, share and law show the content of the result."""

from __future__ import annotations

import pytest
from tests.support import coasting, loaded, shipped

import loadshare as ls


def test_torques_are_drawn_as_they_are(all_elements, read, picture):
    figure = picture("all_elements", "torque")
    rows = {(r["mesh"], r["position"]): r for r in read(figure.spec).rows("point", "torque")}
    changing = {mesh for mesh, _ in rows}
    assert changing == {m for m in all_elements.positions[0].torque if m not in ("1-2", "1-3")}
    for p in all_elements.positions:
        for mesh in changing:
            assert rows[mesh, p.position]["torque"] == p.torque[mesh]
            assert rows[mesh, p.position]["share"] == p.share.get(mesh)
    assert "torque on the driver [N·m]" in read(figure.spec).words()


def test_what_does_not_change_is_drawn_as_bars_with_figures(limit_ring, read, picture):
    spec = read(picture("limit_ring", "torque").spec)
    assert spec.marks("line") == []
    bars = {r["mesh"]: r["torque"] for r in spec.rows("bar", "torque")}
    assert bars == limit_ring.positions[0].torque
    assert "7582.0" in spec.words()
    assert "the same at all 5 positions" in spec.words()


def test_bars_of_torque_start_at_nothing_and_of_shares_at_one(limit_ring, read, picture):
    torque, share = picture("limit_ring", "torque"), picture("limit_ring", "share", "group")
    assert {r["start"] for r in read(torque.spec).rows("bar", "start")} == {0.0}
    rows = read(share.spec).rows("bar", "start")
    assert {r["start"] for r in rows} == {1.0}
    assert {r["mesh"]: r["pair"] for r in rows} == limit_ring.positions[0].pair_share
    for unit in read(torque.spec).marks("bar"):
        assert unit["encoding"]["x"]["scale"]["domain"][0] == 0.0


def test_every_value_lies_on_its_axis(read, picture):
    for figure in (
        picture("all_elements", "share"),
        picture("limit_ring", "share"),
        picture("all_elements", "torque"),
    ):
        for unit in read(figure.spec).units():
            for channel in "xy":
                encoding = unit["encoding"].get(channel, {})
                domain = encoding.get("scale", {}).get("domain")
                if domain and len(domain) == 2 and not isinstance(domain[0], str):
                    for value in (row[encoding["field"]] for row in unit["rows"]):
                        assert value is None or domain[0] <= value <= domain[1]


def test_round_off_does_not_look_like_a_difference(read):
    result = ls.solve(shipped("fgfbstts/base"), positions=[1])
    for unit in read(result.plot.share().spec).marks("bar"):
        low, high = unit["encoding"]["x"]["scale"]["domain"]
        assert low < 0.995 < 1.005 < high


def test_sensitivities_of_no_share_are_not_drawn():
    bare = shipped("fgfbstts/base").replace({"stages": None})
    found = ls.sensitivity(bare, ["gears.4.base_radius"], positions=[1])
    with pytest.raises(ls.LoadshareError, match="no input is known to change Ω of the system"):
        found.plot()


def test_no_share_without_stages_or_load():
    base = shipped("fgfbstts/base")
    bare = ls.solve(base.replace({"stages": None}), positions=[1])
    with pytest.raises(ls.LoadshareError, match="stage"):
        bare.plot.share()
    idle = ls.solve(loaded(base, "0 N*m"), positions=[1])
    with pytest.raises(ls.LoadshareError, match="stage"):
        idle.plot.share()
    assert idle.plot.torque().spec["concat"]
    with pytest.raises(ValueError, match="group"):
        bare.plot.share(over="mean")


def test_a_position_without_load_is_not_like_the_others(read):
    """It has no Ω: lines are interrupted there, and nothing is called the same at all positions."""
    torque = ["1000 N*m", "0 N*m", "1000 N*m"]
    changes = {"operating.torque": torque, "operating.positions": 3}
    spec = read(ls.solve(shipped("star/floating_sun_3").replace(changes)).plot.share().spec)
    assert "the same at all" not in spec.words()
    rows = {(r["mesh"], r["position"]): r["share"] for r in spec.rows("point", "share")}
    (mesh, *_) = {mesh for mesh, _ in rows}
    assert [rows[mesh, k] for k in (1, 2, 3)] == [pytest.approx(1.0, rel=1e-6), None, rows[mesh, 1]]


def test_meshes_without_stages_share_a_panel(read):
    bare = ls.solve(shipped("star/floating_sun_3").replace({"stages": None}))
    spec = read(bare.plot.torque().spec)
    assert {r["mesh"] for r in spec.rows("bar", "torque")} == set(bare.positions[0].torque)


def test_law_points_lie_on_the_law_of_the_case(all_elements, read, picture):
    figure = picture("all_elements", "law")
    rows = read(figure.spec).rows("point", "angle")
    assert rows
    assert "deformation at the driver [mrad]" in read(figure.spec).words()
    law = shipped("fgfbstts/all_elements").meshes["7-10"].law
    found = 0
    for row in rows:
        if row["mesh"] == "7-10":
            k, torque = row["cycle"] - 1, row["torque"]
            a, b, c = (values[k].si for values in (law.a, law.b, law.c))
            expected = a + b * torque + c * torque ** (2 / 3)
            assert row["angle"] == pytest.approx(1e3 * expected, rel=1e-9)
            found += 1
    assert found == len(all_elements.positions)


def test_the_law_is_followed_by_the_torque_of_every_flank(read):
    """If the coast flank carries as well, the drive flank carries more than the mesh transmits."""
    result = ls.solve(coasting(), positions=[1])
    p = result.positions[0]
    squeezed = [m for m, t in p.coast_torque.items() if t > 0.0]
    assert squeezed
    rows = read(result.plot.law().spec).rows("point", "torque")
    torques = {(row["mesh"], row["flank"]): row["torque"] for row in rows}
    for mesh in squeezed:
        drive, coast = p.torque[mesh] + p.coast_torque[mesh], p.coast_torque[mesh]
        assert torques[mesh, "coast flank"] == pytest.approx(coast, rel=1e-12)
        assert torques[mesh, "drive flank"] == pytest.approx(drive, rel=1e-12)


def test_a_brake_follows_the_law_on_its_coast_flanks(read):
    """The backlash that they cross first is not part of the law."""
    case = shipped("fgfbstts/all_elements").replace({"operating.power": "-2000 kW"})
    result = ls.solve(case, positions=[1])
    rows = read(result.plot.law().spec).rows("point", "angle")
    torque = result.positions[0].torque
    law = case.meshes["7-10"].law
    (row,) = (row for row in rows if row["mesh"] == "7-10")
    assert row["torque"] == pytest.approx(-torque["7-10"], rel=1e-12)
    a, b, c = (values[row["cycle"] - 1].si for values in (law.a, law.b, law.c))
    expected = a - b * torque["7-10"] + c * (-torque["7-10"]) ** (2 / 3)
    assert row["angle"] == pytest.approx(1e3 * expected, rel=1e-9)


def test_curves_are_drawn_once_for_each_law(read, picture):
    spec = read(picture("limit_ring", "law").spec)
    # The case has three constant stiffnesses, one for each of the three panels.
    curves = [{r["curve"] for r in u["rows"]} for u in spec.marks("line")]
    assert curves == [{0}, {0}, {0}]


@pytest.mark.slow
def test_a_loaded_result_draws_what_the_solved_one_draws(limit_ring, tmp_path, picture):
    file = tmp_path / "result.json"
    limit_ring.to_json(file)
    again = ls.load_result(file)
    assert again == limit_ring
    for name in ("torque", "floats", "law", "train"):
        assert getattr(again.plot, name)().spec == picture("limit_ring", name).spec


def test_few_positions_have_a_tick_each_and_lines_are_broken_where_there_is_no_answer(read):
    case = shipped("fgfbstts/all_elements")
    result = ls.solve(case, positions=[1, 3, 9, 10])
    spec = read(result.plot.share().spec)
    lines = [unit for unit in spec.marks("line") if "x" in unit["encoding"]]
    assert lines
    for unit in lines:
        assert unit["encoding"]["x"]["axis"]["values"] == [1, 3, 9, 10]
        by_position = {row["position"]: row.get("share") for row in unit["rows"]}
        there = [at for at, share in by_position.items() if share is not None]
        assert sorted(there) == [1, 3, 9, 10]
        assert by_position.keys() == {*range(1, 11)}
