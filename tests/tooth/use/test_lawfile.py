"""Law files, and the cache in which they are stored."""

import math
from pathlib import Path

import numpy as np
import pytest
from platformdirs import user_cache_path
from tests.tooth.use.pairs import CASE, FACE, SPUR, written

import loadshare as ls
from loadshare import tooth, user_cache
from loadshare.case import load_case
from loadshare.errors import CaseError
from loadshare.tooth import resolve
from loadshare.tooth.law import folder
from loadshare.tooth.law.file import law_of, law_text, load_law, parsed_law
from loadshare.tooth.law.folder import code_hash, computed_law, known_law
from loadshare.tooth.pair.file import load_pair
from loadshare.tooth.pair.gears import gears_of


def test_a_law_file_holds_the_law_bit_for_bit(spur, tmp_path):
    pair = load_pair(spur)
    found = pair.analyse()
    law = law_of(pair, found)
    again = load_law(written(tmp_path, law_text(law), "law.toml"))
    assert again == law
    for key in "abc":
        values = [value.si for value in getattr(again, key)]
        np.testing.assert_array_equal(values, getattr(found.law, key))
    assert again.computed.pair_hash == pair.hash
    assert again.computed.torque.si == 100.0
    # Three loads are met exactly; the misfit is that at the other loads.
    assert all(0.0 < part < 0.05 for part in again.misfit)


@pytest.mark.parametrize(
    ("change", "key", "message"),
    [
        (('kind = "law"', 'kind = "laws"'), "kind", "is no law file"),
        (("rad/(N*m)^(2/3)", "rad/(N*m)"), "c[0]", "is "),
        (("positions = 2", "positions = 3"), "a", "has 2 values, but computed.positions is 3"),
        (("misfit", "missfit"), "missfit", "unknown key"),
        (('type = "external"', 'type = "round"'), "computed.gears.driver.type", "is "),
    ],
)
@pytest.mark.quick(2)
def test_a_wrong_law_file_is_reported(spur, tmp_path, change, key, message):
    pair = load_pair(spur)
    text = law_text(law_of(pair, pair.analyse()))
    file = written(tmp_path, text.replace(*change), "law.toml")
    with pytest.raises(CaseError) as caught:
        load_law(file)
    problems = {problem.key: problem for problem in caught.value.problems}
    assert message in problems[key].message
    assert problems[key].file == str(file)


def test_a_law_that_yields_nothing_is_refused_by_its_file(spur, tmp_path):
    pair = load_pair(spur)
    law = law_of(pair, pair.analyse())
    text = law_text(law).replace(law.b[1].text, "0 rad/(N*m)")
    text = text.replace(law.c[1].text, "0 rad/(N*m)^(2/3)")
    file = written(tmp_path, text, "law.toml")
    case = load_case(written(tmp_path, CASE + 'law_file = "law.toml"\n', "case.toml"))
    with pytest.raises(CaseError) as caught:
        resolve(case)
    (problem,) = caught.value.problems
    assert (problem.file, problem.key) == (str(file), "b[1]")
    assert problem.message == "and c are both 0 here: the mesh would be rigid"


def test_a_case_that_is_solved_again_has_the_law_of_the_file_as_it_is(spur, tmp_path):
    pair = load_pair(spur)
    law = law_of(pair, pair.analyse())
    twice = {b.text: f"{2.0 * b.si!r} rad/(N*m)" for b in law.b}
    stiff = soft = law_text(law)
    for once, other in twice.items():
        soft = soft.replace(once, other)
    written(tmp_path, stiff, "law.toml")
    case = load_case(written(tmp_path, CASE + 'law_file = "law.toml"\n', "case.toml"))
    before = ls.solve(case).positions[0].rotation["a"]
    written(tmp_path, soft, "law.toml")
    again = ls.solve(case).positions[0].rotation["a"]
    fresh = ls.solve(load_case(tmp_path / "case.toml")).positions[0].rotation["a"]
    assert again == pytest.approx(fresh, rel=1e-12)
    assert again > 1.2 * before


def test_a_law_file_describes_its_gears(tmp_path):
    """For 25 and 49 teeth: r_b = z m cos α_t/(2 cos β), tan α_t = tan 20°/cos 8°."""
    text = SPUR.replace("[driven]", 'helix_angle = "8 deg"\n[driven]\nprofile_shift = -0.1')
    pair = load_pair(written(tmp_path, text.replace("teeth = 50", "teeth = 49")))
    gears = load_law(written(tmp_path, law_text(computed_law(pair)), "law.toml")).computed.gears
    transverse = math.atan(math.tan(math.radians(20)) / math.cos(math.radians(8)))
    radius = 1.5e-3 * math.cos(transverse) / math.cos(math.radians(8))
    assert gears.driver.base_radius.si == pytest.approx(25 * radius, rel=1e-8)
    assert gears.driven.base_radius.si == pytest.approx(49 * radius, rel=1e-8)
    assert (gears.driver.type, gears.driven.type) == ("external", "external")
    assert (gears.driver.teeth, gears.driven.teeth) == (25, 49)
    assert gears.driven.helix_angle.si == pytest.approx(-math.radians(8))
    assert gears.driven.profile_shift == -0.1
    face = load_pair(written(tmp_path, FACE, "face.toml"))
    assert gears_of(face.geometry).driven.type == "face"
    assert gears_of(face.geometry).driven.module is None


def test_the_cache_gives_back_what_it_was_given(own_cache, spur):
    pair = load_pair(spur)
    assert known_law(pair) is None
    law = computed_law(pair)
    assert known_law(pair) == law
    (file,) = (own_cache / "laws").iterdir()
    assert parsed_law(file.read_text(encoding="utf-8").partition("\n")[2]) == law


@pytest.mark.parametrize(
    "spoil",
    [
        lambda b: b[:-20],
        lambda b: b.replace(b"e-0", b"e-1", 1),
        lambda b: b"",
        lambda b: b"\xff" + b,
    ],
)
@pytest.mark.quick(1)
def test_a_damaged_entry_is_not_believed(own_cache, spur, spoil):
    pair = load_pair(spur)
    law = computed_law(pair)
    (file,) = (own_cache / "laws").iterdir()
    file.write_bytes(spoil(file.read_bytes()))
    assert known_law(pair) is None
    assert computed_law(pair) == law == known_law(pair)


def test_another_pair_is_another_entry(own_cache, spur, tmp_path):
    computed_law(load_pair(spur))
    other = load_pair(written(tmp_path, SPUR.replace("teeth = 25", "teeth = 26")))
    assert known_law(other) is None


def test_other_code_is_another_entry(spur, monkeypatch):
    pair = load_pair(spur)
    computed_law(pair)
    monkeypatch.setattr(folder, "code_hash", lambda: "another")
    assert known_law(pair) is None


def test_all_code_of_the_room_counts():
    room = Path(tooth.__file__).parent
    assert code_hash() == code_hash(room)
    assert code_hash(room / "contact") != code_hash(room)


def test_a_cache_that_cannot_be_written_is_done_without(spur, tmp_path, monkeypatch):
    blocked = written(tmp_path, "a file, not a folder", "blocked")
    monkeypatch.setenv("LOADSHARE_CACHE", str(blocked))
    assert computed_law(load_pair(spur)).computed.positions == 2


def test_where_the_cache_is(tmp_path, monkeypatch):
    assert user_cache.cache_folder() == tmp_path / "cache"
    monkeypatch.delenv("LOADSHARE_CACHE")
    assert user_cache.cache_folder() == user_cache_path("loadshare", appauthor=False)
