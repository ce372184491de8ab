"""Odd values wherever one may be given: the message names the value and what is allowed."""

import numpy as np
import pytest

import loadshare as ls

FLOAT = "rings.4.float"
UM = "rings.4.float [um]"
KEY = "is not a key path. Allowed: a text such as rings.4.float"
SEED = "allowed: a whole number from 0 on"
TERMS = "allowed: torque, share, pair_share"


@pytest.fixture(scope="module")
def case():
    return ls.examples("fgfbstts/limit_ring")


@pytest.fixture(scope="module")
def bench():
    return ls.examples("fgfbstts/installation_error").replace(
        {"measured.bench": {"position": 1, "pair_share": {"6-10": 0.9}, "uncertainty": 0.1}}
    )


@pytest.mark.parametrize("function", [ls.explain, ls.formulate, ls.search])
@pytest.mark.parametrize("given", ["1", 1.0, True, 0, -1, None, [1], {1}, np.float64(1), "x"])
def test_what_no_position_is(case, function, given):
    with pytest.raises(ValueError, match="this case has positions 1 to 5") as caught:
        function(case, given)
    assert f"positions {given!r}:" in str(caught.value)


@pytest.mark.parametrize("seed", ["1", 1.0, True, -1, None, [1]])
def test_what_no_seed_is(case, bench, seed):
    for study in (
        lambda: ls.search(case, seed=seed),
        lambda: ls.fit(bench, {"errors.6.installation[0]": ("0 um", "9 um")}, seed=seed),
    ):
        with pytest.raises(ValueError, match=SEED) as caught:
            study()
        assert f"seed {seed!r};" in str(caught.value)


@pytest.mark.parametrize("key", [1, None, True, b"rings", (1,), ("rings.4.float", None)])
def test_what_no_key_is(case, bench, key):
    for study in (
        lambda: ls.sweep(case, {key: ["8 um"]}),
        lambda: ls.critical(case, key, "8 um", "9 um"),
        lambda: ls.fit(bench, {key: ("8 um", "9 um")}),
    ):
        with pytest.raises(ls.CaseError) as caught:
            study()
        assert KEY in str(caught.value)
        assert str(key) in str(caught.value)
    if key is not None:
        with pytest.raises(ls.CaseError, match="is not one key"):
            ls.sensitivity(case, key)


@pytest.mark.parametrize("given", [1, True, [("gears", {})], "gears", object()])
def test_what_no_mapping_is(case, bench, given):
    for what, read in (
        ("sections by name", ls.Case),
        ("changes by key path", case.replace),
        ("inputs by key path", lambda given: ls.sweep(case, given)),
        ("bounds by key path", lambda given: ls.fit(bench, given)),
    ):
        with pytest.raises(TypeError) as caught:
            read(given)
        assert str(caught.value).startswith(f"{what} are expected, as in {{")
        assert type(given).__name__ in str(caught.value)


@pytest.mark.parametrize("keep", [None, 1, b"torque", [["torque"]], "work"])
def test_what_no_variable_is(case, keep):
    with pytest.raises(ValueError, match=TERMS):
        ls.solve_many(case, {UM: [8.0]}, positions=[1], keep=keep)


@pytest.mark.parametrize("name", [1, None, [], {}, b"x"])
def test_what_no_study_is(case, name):
    with pytest.raises(ls.CaseError, match="is not in the case"):
        ls.run_study(case, name)


@pytest.mark.parametrize(
    ("key", "given"),
    [
        ("operating.input", b"1"),
        ("title", b"x"),
        ("stages.II.meshes", {"6-10", "7-10"}),
        ("assumed", frozenset(["gears.*.base_radius"])),
        ("operating.positions", {3}),
    ],
)
def test_what_no_file_can_hold(case, key, given):
    """Such values used to be accepted, and the case could not be written afterwards."""
    with pytest.raises(ls.CaseError) as caught:
        case.replace({key: given})
    (problem,) = caught.value.problems
    assert (problem.file, problem.key) == ("changes", key)
    assert problem.message == f"is of type {type(given).__name__}"
    assert problem.allowed == "tables, lists, texts and numbers"
    with pytest.raises(ls.CaseError, match="is of type bytes"):
        ls.Case(title=b"x")


@pytest.mark.parametrize(
    ("kind", "point"), [(None, 0), ("share", 0), ("omega", -1), ("omega", "0")]
)
def test_what_no_point_of_a_sweep_is(case, kind, point):
    found = ls.sweep(case, {FLOAT: ["8 um"]}, positions=[1])
    with pytest.raises(ValueError, match=r"allowed: (omega, pair_omega|a whole number from 0 on)"):
        found.largest(kind, point)


@pytest.mark.parametrize("given", [None, 5, b"result.json", ["result.json"]])
def test_what_no_path_of_a_result_is(given):
    with pytest.raises(TypeError, match="the path of a result file is needed, not"):
        ls.load_result(given)


def test_an_empty_path_of_a_result_is_no_folder():
    with pytest.raises(ls.ResultError, match='"": no such file'):
        ls.load_result("")


@pytest.mark.parametrize("given", [None, 5, b"gearbox", ["gearbox"]])
def test_what_no_name_of_a_case_is(case, given):
    """A file of its result could not be loaded."""
    with pytest.raises(TypeError, match="the name of a case is a text, not"):
        ls.Case(case.to_dict(), name=given)


@pytest.mark.parametrize("mark", ["\0", "\ud800", "\x1b"])
def test_a_result_is_saved_whatever_characters_the_name_of_its_case_has(case, mark, tmp_path):
    found = ls.solve(ls.Case(case.to_dict(), name=f"gear{mark}box"), positions=[1])
    found.to_json(tmp_path / "found.json")
    found.to_netcdf(tmp_path / "found.nc")
    for name in ("found.json", "found.nc"):
        assert ls.load_result(tmp_path / name) == found


def test_samples_of_a_long_float_are_numbers(case):
    samples = np.array([2.0, 4.0])
    plain, long = (
        ls.solve_many(case, {UM: samples.astype(kind)}, positions=[1], workers=1)
        for kind in (np.float64, np.longdouble)
    )
    assert np.array_equal(plain["torque"], long["torque"])
