"""Files that were changed: each is refused by name, or gives exactly the result that was saved."""

from __future__ import annotations

import copy
import json
import math
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from tests.support import answer, coasting, mostly_slow, round_ring, shipped

import loadshare as ls
from benchmarks.limit import limited
from loadshare.certify import certify
from loadshare.results.claim import claim_of
from loadshare.results.derive import positions_of, result_from
from loadshare.results.digest import sealed
from loadshare.results.document import DOCUMENT, FORMAT, OLDER, as_data
from loadshare.results.reading import read_document
from loadshare.study.march import march
from loadshare.study.memory.step import stepped
from loadshare.train import build_train

METADATA = ("effort", "stop", "input")
"""For readers only: no figure follows from them. The part of the input that affects the mechanics
is hashed; the rest is titles and notes."""
WORDS = ("version", "case", "solver", "method", "reduce", "rung", "kind", "where")
"""Words for readers, which may be any text, but nothing other than text."""

CASES = {
    "rings": lambda: ls.solve(shipped("fgfbstts/limit_ring"), positions=[1]),
    "splines": lambda: ls.solve(shipped("fgfbstts/full_float"), positions=[2]),
    "everything": lambda: ls.solve(shipped("fgfbstts/all_elements"), positions=[3]),
    "coasting": lambda: ls.solve(coasting(), positions=[1]),
    "round ring": lambda: ls.solve(round_ring("2e8 N/m")),
    "march": lambda: (
        march(shipped("fgfbstts/full_float"), gear="4", revolutions=1.0, steps=3).result
    ),
}


@pytest.fixture(scope="module", params=mostly_slow(CASES, ("rings", "coasting")))
def result(request):
    return CASES[request.param]()


def leaves(data: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from leaves(value, (*path, key))
    elif isinstance(data, list):
        for at, value in enumerate(data):
            yield from leaves(value, (*path, at))
    else:
        yield path


def at(data: Any, path: tuple[str | int, ...]) -> Any:
    for step in path:
        data = data[step]
    return data


def changed(document: dict[str, Any], path: tuple[str | int, ...], value: Any) -> dict[str, Any]:
    made = copy.copy(document)
    part = made
    for step in path[:-1]:
        part[step] = copy.copy(part[step])
        part = part[step]
    part[path[-1]] = value
    return made


def without(document: dict[str, Any], path: tuple[str | int, ...]) -> dict[str, Any]:
    made = copy.deepcopy(document)
    del at(made, path[:-1])[path[-1]]
    return made


def loads(document: dict[str, Any]) -> ls.Result | None:
    """Return the result of a document, or None if it is refused by name."""
    with suppress(ls.ResultError):
        return read_document(json.dumps(document), "file.json")[0]
    return None


def is_metadata(path: tuple[str | int, ...]) -> bool:
    return any(step in METADATA for step in path)


def harmless(document: dict[str, Any], result: ls.Result) -> bool:
    """Return whether a document is refused, or gives exactly the result that was saved."""
    found = loads(document)
    return found is None or found == result


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.5, 1.0 + 1e-6, -1.0])
def test_no_figure_can_be_changed(result, factor):
    document = json.loads(result.to_json())
    changes = 0
    for path in leaves(document):
        value = at(document, path)
        if isinstance(value, bool) or not isinstance(value, int | float) or value == 0:
            continue
        made = type(value)(value * factor) if factor != 1.5 else value * factor
        if made == value or is_metadata(path):
            continue
        changes += 1
        assert harmless(changed(document, path, made), result), path
    assert changes > 100


@pytest.mark.slow
def test_no_figure_can_be_something_else_or_missing(result):
    document = json.loads(result.to_json())
    for path in leaves(document):
        if path[0] == "input":
            continue
        value = at(document, path)
        wrong = [None, math.nan, "1.0" if isinstance(value, int | float) else 0.5, [value], {}]
        for made in wrong:
            if type(made) is type(value) and (made is None or {*path} & {*WORDS}):
                continue
            assert loads(changed(document, path, made)) is None, (path, made)
        assert loads(without(document, path)) is None, path


@pytest.mark.quick(1)
def test_every_claim_is_looked_at(result):
    """The quick version of the slow tests: claims and derived figures of the first position."""
    document = json.loads(result.to_json())
    for field in ("claim", "torque", "share", "floats", "displacement", "rotation"):
        paths = leaves(document["positions"][0][field], ("positions", 0, field))
        figures = [p for p in paths if isinstance(at(document, p), float) and at(document, p)]
        # All figures that follow from the claim are judged in the same way.
        for path in figures if field == "claim" else figures[::3]:
            assert harmless(changed(document, path, at(document, path) * 1.5), result), path
        # Reading does not depend on the name of a gear or mesh.
        for path in figures[::4]:
            assert loads(changed(document, path, math.nan)) is None
            assert loads(without(document, path)) is None


def test_what_a_result_holds_certifies_again(result):
    train = build_train(result.case)
    for p in result.positions:
        again = certify(p.claim.train(train), p.equilibrium, result.stamp.tolerance)
        assert again.passed
        assert again == p.certificate


@pytest.fixture(scope="module")
def small():
    return ls.solve(shipped("fgfbstts/limit_ring"), positions=[1, 2])


def refusal_of(document: Any) -> str:
    with pytest.raises(ls.ResultError) as caught:
        read_document(document if isinstance(document, str) else json.dumps(document), "file.json")
    return str(caught.value)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("positions", 0, "torque", "4-6"), 5000.0, r'positions[0].torque."4-6" = 5000.0: does'),
        (("positions",), [], "position 2 is missing"),
        (("positions", 1, "position"), 1, "positions[1].position = 1: appears twice"),
        (("positions", 1, "position"), 7, "is not a position of the case. Allowed: 1 to 5"),
        (("stamp", "case_hash"), "0" * 64, "stamp.case_hash"),
        (("stamp", "tolerance"), 1.0, "tolerance 1.0 cannot be used for a certificate"),
        (("stamp", "positions"), [], "stamp.positions = []: is empty"),
        (("input", "gears", "4", "base_radius"), "3 kg", "file.json: input: gears.4.base_radius"),
        (("input", "rings", "4", "float"), "4.1 um", "is not that of the case under input"),
        (
            ("format",),
            min(OLDER) - 1,
            "again: loadshare run CASE.toml -o FILE.json.",
        ),
        (("format",), FORMAT + 1, "Load it with that version, or a newer one."),
        (("format",), True, "format = true: was written by"),
        (("format",), 99, f"which reads {min(OLDER)} and {FORMAT}"),
        (("refused",), {"message": "no"}, "contains a refusal, not a result"),
        (("colour",), "red", "colour: is not known"),
        (("positions", 0, "claim", "flank_force", "4-6 drive"), 1.0, "position 1 is not an equil"),
        (("positions", 0, "claim", "shaft_torque"), {}, "is missing"),
        (("positions", 0, "claim", "flank_force", "x"), 1.0, "claim.flank_force.x: is not known"),
    ],
)
def test_what_is_wrong_is_named(small, path, value, message):
    document = json.loads(small.to_json())
    if path[-1] == "4-6 drive":
        path = (*path[:-1], next(n for n in at(document, path[:-1]) if n.startswith("4-6")))
    assert message in refusal_of(changed(document, path, value))


@pytest.mark.parametrize("field", ["rotation", "displacement", "flank_force", "support_force"])
@pytest.mark.parametrize("value", [1e41, -1e200, pytest.param(10**308, id="whole")])
def test_a_claim_whose_square_overflows_is_refused(small, field, value):
    """It used to print warnings of overflows in the certificate."""
    document = json.loads(small.to_json())
    name, given = next(iter(document["positions"][0]["claim"][field].items()))
    new = [value, *given[1:]] if isinstance(given, list) else value
    found = refusal_of(changed(document, ("positions", 0, "claim", field, name), new))
    assert re.search(rf"positions\[0\]\.claim\.{field}\..* = .*: is too large", found)


@pytest.mark.parametrize("value", [10**400, -(10**400)], ids=["above", "below"])
def test_a_whole_number_beyond_all_doubles_does_not_follow(small, value):
    document = json.loads(small.to_json())
    path = ("positions", 0, "loads", "gears", "4")
    assert isinstance(at(document, path), float)
    with pytest.raises(ls.ResultError, match="does not follow from the case and the claims"):
        read_document(json.dumps(changed(document, path, value)), "file.json")


def test_a_position_left_out_is_missed(small):
    assert "position 2 is missing" in refusal_of(
        without(json.loads(small.to_json()), ("positions", 1))
    )


def test_text_that_is_no_plain_json_is_refused(small):
    text = small.to_json()
    assert "the key omega appears twice" in refusal_of(text.replace('"pair_omega"', '"omega"'))
    torque = f"{small.positions[0].torque['4-6']!r}"
    for number in ("NaN", "Infinity", "-Infinity", "1e999"):
        assert "not a finite number" in refusal_of(text.replace(torque, number))
    assert "contains no loadshare result" in refusal_of(text[: len(text) // 2])
    assert "contains no loadshare result" in refusal_of("[" * 100_000)
    assert "contains no loadshare result" in refusal_of("[]")


def test_results_of_other_cases_are_not_taken_for_this_one(small):
    """Claims of one case under the input and stamp of another."""
    other = ls.solve(
        shipped("fgfbstts/limit_ring").replace({"rings.4.float": "4.1 um"}), positions=[1, 2]
    )
    here, there = json.loads(small.to_json()), json.loads(other.to_json())
    assert "not an equilibrium of the case" in refusal_of(here | {"positions": there["positions"]})
    mixed = there | {"input": here["input"], "stamp": here["stamp"]}
    assert "not an equilibrium of the case" in refusal_of(mixed)


def test_a_march_begins_where_the_step_before_ended():
    found = CASES["march"]()
    document = json.loads(found.to_json())
    path = ("positions", 2, "claim", "slip")
    assert harmless(changed(document, path, at(document, ("positions", 1, *path[2:]))), found)
    assert loads(changed(document, path, None)) is None
    # An equilibrium of the same step from a different slip, which the march never had.
    train = build_train(found.case).remembering({"4": [1e-5, 0.0, 0.0], "5": np.zeros(3)})
    step = stepped(train, 3)
    claim = as_data(claim_of(train, step.equilibrium))
    strange = changed(document, path[:-1], claim)
    assert "is not the slip at the end of the previous step" in refusal_of(strange)
    later = {**document, "positions": document["positions"][1:]}
    later["stamp"] = {**document["stamp"], "positions": [2, 3]}
    assert "a march does not begin at its step 2" in refusal_of(later)
    assert found.passed
    assert ls.solve(found.case.replace({"march": None})).positions[0].claim.slip is None


def test_a_meaningless_equilibrium_is_refused_on_loading_too(small):
    """An answer that `solve` refuses for its displacements is refused in a file as well."""
    soft = shipped("fgfbstts/base").replace({"gears.10.support": "1e5 N/m"})
    train = build_train(soft)
    found, _ = answer(train, 1)
    certificate = certify(train, found)
    assert certificate.passed
    p = small.positions[0]
    judged = SimpleNamespace(equilibrium=found, certificate=certificate, effort=p.effort)
    positions = positions_of([(train, 1, found.flank_force, judged)])
    stamp = replace(small.stamp, case=soft.name, case_hash=soft.hash, positions=(1,))
    made = result_from(soft, soft, train, positions, lambda: stamp)
    assert "the displacements are too large for the geometry" in refusal_of(made.to_json())


def test_a_result_of_some_positions_is_whole_if_no_more_were_requested(small):
    assert small.passed
    assert small.stamp.positions == (1, 2)


@pytest.mark.parametrize(
    "change",
    [
        lambda a: a.assign(torque=a.torque * 1.5),
        pytest.param(
            lambda a: a.assign(torque=a.torque.where(a.position > 1)), marks=pytest.mark.slow
        ),
        lambda a: a.drop_vars("share"),
        pytest.param(lambda a: a.assign(other=a.torque), marks=pytest.mark.slow),
        pytest.param(lambda a: a.isel(position=[0]), marks=pytest.mark.slow),
        lambda a: a.assign_coords(mesh=a.mesh.values[::-1]),
        lambda a: a.assign_attrs(case_hash="0" * 64),
        lambda a: a.assign_attrs({DOCUMENT: a.attrs[DOCUMENT].replace("on boundary", "inside")}),
        lambda a: a.assign_attrs({DOCUMENT: 1.0}),
    ],
)
@pytest.mark.quick(1)
def test_arrays_that_do_not_agree_with_their_result_are_refused(small, tmp_path, change):
    file, changed_file = tmp_path / "good.nc", tmp_path / "changed.nc"
    small.to_netcdf(file)
    assert ls.load_result(file) == small
    with xr.open_dataset(file, engine="h5netcdf") as arrays:
        change(arrays.load()).to_netcdf(changed_file, engine="h5netcdf")
    changed_file.write_bytes(sealed(changed_file.read_bytes()))
    with pytest.raises(ls.ResultError, match=r"changed\.nc"):
        ls.load_result(changed_file)


def test_a_digest_is_of_what_a_file_holds_and_not_of_how_it_is_laid_out(small):
    document = small.to_dict()
    assert loads(document) == small
    laid_out = json.dumps(document, indent=3, sort_keys=True)
    assert read_document(laid_out, "file.json")[0] == small
    for path in (("positions", 0, "effort", "rung"), ("input", "source"), ("digest",)):
        assert "was changed after it was written" in refusal_of(changed(document, path, "another"))
    last = np.nextafter(document["omega"]["I"], 2.0)
    assert "was changed after it was written" in refusal_of(changed(document, ("omega", "I"), last))
    assert "digest" in refusal_of(without(document, ("digest",)))


def test_arrays_that_another_program_wrote_again_are_refused(small, tmp_path):
    file = tmp_path / "result.nc"
    small.to_netcdf(file)
    with xr.open_dataset(file, engine="h5netcdf") as arrays:
        arrays = arrays.load()
    arrays.to_netcdf(file, engine="h5netcdf")
    with pytest.raises(ls.ResultError, match="it lacks its digest"):
        ls.load_result(file)


@pytest.mark.parametrize(
    ("change", "wanted"),
    [
        ({"positions": [{}] * 1_000_000}, "positions[0].position"),
        ({"frames": {f"g{k}": 1 for k in range(100_000)}}, "more problems"),
        ({"stamp": {f"x{k}": 1 for k in range(100_000)}}, ""),
    ],
)
@pytest.mark.quick(2)
def test_a_small_file_of_many_mistakes_takes_a_moment_and_little_memory(tmp_path, change, wanted):
    """A million empty positions (4 MB) used to take more than 5 GB and ended the process."""
    document = json.loads(ls.solve(shipped("star/floating_sun_3")).to_json())
    file = tmp_path / "result.json"
    file.write_text(json.dumps({**document, **change}), encoding="utf-8")
    with limited(10.0), pytest.raises(ls.ResultError) as caught:
        ls.load_result(file)
    assert wanted in str(caught.value)
    assert len(caught.value.problems) <= 1000


def test_positions_are_compared_in_a_moment(tmp_path):
    document = json.loads(ls.solve(shipped("star/floating_sun_3")).to_json())
    document["stamp"]["positions"] = list(range(1, 100_000)) * 2
    file = tmp_path / "result.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    with limited(10.0), pytest.raises(ls.ResultError, match="appears twice"):
        ls.load_result(file)
