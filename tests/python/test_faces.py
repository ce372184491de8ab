"""What a Python user sees: public names, representations, tables, joined pictures."""

import html.parser
import pickle
import re
from dataclasses import replace
from pathlib import Path

import altair as alt
import numpy as np
import pytest

import loadshare as ls
from loadshare.contact import ContactProblem, solve_contact
from loadshare.table import text_table
from loadshare.view import ROWS, WIDTH, View

HOSTILE = '"><script>alert(1)</script><img src=x onerror=alert(2)>'


@pytest.fixture(scope="module")
def ring():
    return ls.solve(ls.examples("fgfbstts/limit_ring"), positions=[1])


@pytest.fixture(scope="module")
def studies(ring):
    case = ring.case
    measured = {"measured.bench": {"position": 1, "pair_share": {"6-10": 0.9}, "uncertainty": 0.1}}
    bench = ls.examples("fgfbstts/installation_error").replace(measured)
    fitted = ls.fit(bench, {"errors.6.installation[0]": ("0 um", "100 um")})
    return {
        "sweep": ls.sweep(case, {"rings.*.float": "0 um:10 um:12"}, positions=[1]),
        "critical": ls.critical(case, "rings.4.float", "8 um", "9 um", positions=[1]),
        "sensitivity": ls.sensitivity(case, ["rings.*.float"], positions=[1]),
        "march": ls.march(ls.examples("fgfbstts/full_float"), gear="6", revolutions=1, steps=2),
        "fit": fitted,
        "compare": fitted.comparison,
        "tolerance": ls.tolerance(
            ls.examples("star/floating_sun_4").replace(SCATTER), samples=64, indices=0, worst=False
        ),
    }


SCATTER = {
    "study.gaps": {
        "kind": "tolerance",
        "inputs": {
            'meshes."sun-planet1".gap': {
                "distribution": "uniform",
                "low": "0 mrad",
                "high": "0.4 mrad",
            }
        },
    }
}
NAMES = ("sweep", "critical", "sensitivity", "march", "fit", "compare", "tolerance")


class Tags(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: set[str] = set()

    def handle_starttag(self, tag, attrs):
        self.found.add(tag)
        assert {name for name, _ in attrs} <= {"style"}


PLAIN = {"div", "strong", "table", "thead", "tbody", "tr", "th", "td", "p"}


def tags(text: str) -> set[str]:
    parser = Tags()
    parser.feed(text)
    return parser.found


def test_what_is_listed_is_there_and_documented():
    listed = [name for name in dir(ls) if not name.startswith("__")]
    assert {"solve", "examples", "sweep", "Sweep"} <= set(listed)
    pages = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")
    for name in listed:
        thing = getattr(ls, name)
        place = re.search(rf"^::: loadshare\.\S*\.{name}$", pages, re.MULTILINE)
        assert place, f"docs/api.md does not document {name}"
        assert callable(thing)


@pytest.mark.parametrize("name", NAMES)
def test_a_study_shows_itself_on_a_screen_and_in_a_notebook(studies, name):
    found = studies[name]
    lines = repr(found).splitlines()
    assert 1 < len(lines) <= ROWS + 10
    assert max(map(len, lines)) <= WIDTH
    assert tags(found._repr_html_()) <= PLAIN


def test_a_case_and_a_result_show_themselves(ring):
    assert len(repr(ring.case).splitlines()) == 1
    for thing in (ring, ring.case):
        text = thing._repr_html_()
        assert tags(text) <= PLAIN
        assert "Limit rings on the floating pinions" in text
    assert "4 on boundary" in ring._repr_html_() or "stop" in ring._repr_html_()


def test_what_a_position_was_solved_with_shows_itself_on_a_screen(ring):
    case = ls.examples("fgfbstts/limit_ring")
    found = ls.search(case)
    known = found.answer.equilibrium
    other = replace(known, flank_force=dict.fromkeys(known.flank_force, 0.0))
    every = (
        ring.positions[0],
        ls.explain(case),
        ls.formulate(case),
        found,
        replace(found, others=(other,)),
    )
    titles = ("Position 1", "Answer of", "Formulation of", "Search at", "Search at")
    for thing, title in zip(every, titles, strict=True):
        lines = repr(thing).splitlines()
        assert lines[0].startswith(title)
        assert 1 < len(lines) <= ROWS + 10
        assert max(map(len, lines)) <= WIDTH
        assert tags(thing._repr_html_()) <= PLAIN


def test_what_was_found_is_equal_to_its_pickle_and_to_nothing_else(ring, studies):
    case = ring.case
    answered = (ring.positions[0], ls.explain(case), ls.formulate(case), ls.search(case))
    parts = (
        solve_contact(ContactProblem(("x",), np.eye(1), np.ones(1))),
        ring.positions[0].equilibrium,
        studies["sweep"].points[0],
        studies["sensitivity"].rates[1, "rings.5.float", "rising"],
        next(iter(studies["march"].slips[0].values())),
        studies["tolerance"].of("system"),
        studies["tolerance"].of("system").summary,
    )
    every = [case, ring, *answered, *studies.values(), ring.plot.floats(), *parts]
    again = [pickle.loads(pickle.dumps(one)) for one in every]
    assert [[one == other for other in again] for one in every] == np.eye(len(every)).tolist()
    assert len({*every, *again}) == len(every)


def test_studies_that_found_something_else_are_not_equal(ring, studies):
    """This holds even if they asked the same question."""
    more = ring.case.replace({"operating.power": "2100 kW"})
    found = ls.sweep(more, {"rings.*.float": "0 um:10 um:12"}, positions=[1])
    assert found.points == studies["sweep"].points
    assert found != studies["sweep"]
    assert ls.sensitivity(more, ["rings.*.float"], positions=[1]) != studies["sensitivity"]


def test_hostile_titles_and_names_inject_nothing():
    plain = ls.examples("star/floating_sun_4")
    data = plain.to_dict() | {"title": HOSTILE, "source": HOSTILE}
    data["gears"] = dict(data["gears"])
    data["gears"][HOSTILE] = data["gears"].pop("planet1")
    meshes = {}
    for name, mesh in data["meshes"].items():
        first, second = (HOSTILE if g == "planet1" else g for g in name.split("-"))
        known = {"driver": first, "driven": second}
        meshes["m<b>" + name if HOSTILE in known.values() else name] = {**mesh, **known}
    data["meshes"] = meshes
    data["stages"] = {HOSTILE: {"meshes": ["m<b>sun-planet1", "sun-planet2"]}}
    case = ls.Case(data, name=HOSTILE)
    result = ls.solve(case)
    found = ls.sweep(case, {"operating.torque": ["900 N*m", "1000 N*m"]})
    for thing in (case, result, found):
        text = thing._repr_html_()
        assert tags(text) <= PLAIN
        assert "&lt;script&gt;" in text


def test_a_view_counts_what_it_leaves_out():
    rows = tuple((str(k), "x" * 200) for k in range(ROWS + 3))
    made = text_table("", ("n", "x"), rows)
    view = View("T", (("left out", ""), ("kept", "a\nb")), (made,))
    assert "… and 3 more" in view.text
    assert "… and 3 more" in view.html
    assert "left out" not in view.text
    assert "kept: a b" in view.text
    assert max(map(len, view.text.splitlines())) == WIDTH


@pytest.mark.parametrize("name", NAMES)
def test_a_study_is_a_table(studies, name):
    table = studies[name].to_dataframe()
    assert len(table) > 0


@pytest.mark.parametrize("name", ["sweep", "sensitivity", "march", "tolerance"])
def test_a_study_is_labelled_arrays(studies, name):
    assert studies[name].to_xarray() is studies[name].dataset


def test_tables_tell_their_units_and_hold_the_numbers_of_the_result(ring, studies):
    table = ring.to_dataframe()
    assert table.attrs["units"]["torque"] == "N·m"
    assert ring.to_xarray()["torque"].attrs["units"] == "N·m"
    row = table[(table.mesh == "6-10") & (table.position == 1)]
    assert row.torque.item() == ring.positions[0].torque["6-10"]
    rates = studies["sensitivity"].to_dataframe()
    assert rates.attrs["units"]["torque"] == "N·m per SI unit of the input"
    one = rates[(rates.input == "rings.5.float") & (rates.side == "rising")].set_index("mesh")
    expected = studies["sensitivity"].rates[1, "rings.5.float", "rising"].torque
    assert one.torque.to_dict() == expected


def test_pictures_compose(ring, studies):
    one, other = studies["sweep"].plot(), studies["sweep"].plot("pair_omega")
    assert isinstance((one | other).chart, alt.HConcatChart)
    assert isinstance((one & ring.plot.floats()).chart, alt.VConcatChart)
    rule = alt.Chart(alt.InlineData(values=[{"y": 1.02}])).mark_rule().encode(y="y:Q")
    drawn = one + rule
    assert isinstance(drawn.chart, alt.LayerChart)
    assert "<svg" in drawn.to_svg()
    assert "<svg" in (one | other).to_svg()
    with pytest.raises(ls.LoadshareError, match="several panels"):
        ring.plot.share() + one


def test_every_shipped_case_opens_by_its_name():
    names = ls.examples()
    assert names == tuple(sorted(names))
    assert "fgfbstts/limit_ring" in names
    for name in names:
        assert ls.examples(name).name == name.rpartition("/")[2]
    assert ls.examples(Path("star") / "floating_sun_4").name == "floating_sun_4"


@pytest.mark.parametrize("given", ["limit_ring", "star/floating_sun_44", "nothing/at_all", "../x"])
def test_an_unknown_example_is_refused_with_a_list_of_examples(given):
    with pytest.raises(ls.CaseError, match="is not a case of the package") as caught:
        ls.examples(given)
    assert "fgfbstts/limit_ring" in str(caught.value) or "star/floating_sun_4" in str(caught.value)
