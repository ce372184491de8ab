"""Law files and the cache in which they are kept."""

from pathlib import Path

import numpy as np
import pytest
from platformdirs import user_cache_path
from tests.tooth.use.pairs import SPUR, written

from loadshare import tooth
from loadshare.errors import CaseError
from loadshare.tooth.law import folder as cache
from loadshare.tooth.law.file import law_of, law_text, load_law, parsed_law
from loadshare.tooth.law.folder import computed_law, known_law
from loadshare.tooth.pair.file import load_pair


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
    # Three loads are met exactly; the misfit is that at the others.
    assert all(0.0 < part < 0.05 for part in again.misfit)


@pytest.mark.parametrize(
    ("change", "key", "message"),
    [
        (('kind = "law"', 'kind = "laws"'), "kind", "is no law file"),
        (("rad/(N*m)^(2/3)", "rad/(N*m)"), "c[0]", "is "),
        (("positions = 2", "positions = 3"), "a", "has 2 values, computed.positions is 3"),
        (("misfit", "missfit"), "missfit", "unknown key"),
    ],
)
def test_a_wrong_law_file_is_reported(spur, tmp_path, change, key, message):
    pair = load_pair(spur)
    text = law_text(law_of(pair, pair.analyse()))
    file = written(tmp_path, text.replace(*change), "law.toml")
    with pytest.raises(CaseError) as caught:
        load_law(file)
    problems = {problem.key: problem for problem in caught.value.problems}
    assert message in problems[key].message
    assert problems[key].file == str(file)


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
    monkeypatch.setattr(cache, "code_hash", lambda: "another")
    assert known_law(pair) is None


def test_all_code_of_the_room_counts():
    room = Path(tooth.__file__).parent
    assert cache.code_hash() == cache.code_hash(room)
    assert cache.code_hash(room / "contact") != cache.code_hash(room)


def test_a_cache_that_cannot_be_written_is_done_without(spur, tmp_path, monkeypatch):
    blocked = written(tmp_path, "a file, not a folder", "blocked")
    monkeypatch.setenv("LOADSHARE_CACHE", str(blocked))
    assert computed_law(load_pair(spur)).computed.positions == 2


def test_where_the_cache_is(tmp_path, monkeypatch):
    assert cache.cache_folder() == tmp_path / "cache"
    monkeypatch.delenv("LOADSHARE_CACHE")
    assert cache.cache_folder() == user_cache_path("loadshare", appauthor=False)
