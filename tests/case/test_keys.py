import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.reproducible import examples

from loadshare.case.keys import dotted, parse


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (("gears", "4", "base_radius"), "gears.4.base_radius"),
        (("meshes", "4-6", "stiffness"), 'meshes."4-6".stiffness'),
        (("gears", "a", "centre", 1), "gears.a.centre[1]"),
        (("meshes", "4-6", "stiffness", 1, 2), 'meshes."4-6".stiffness[1][2]'),
    ],
)
def test_paths_as_text(path, text):
    assert dotted(path) == text
    assert parse(text) == path


def test_names_with_dashes_may_stand_bare():
    assert parse("meshes.4-6.stiffness") == ("meshes", "4-6", "stiffness")


names = st.text(min_size=1)
paths = st.tuples(names, names, st.lists(st.integers(0, 99), max_size=2)).map(
    lambda parts: (parts[0], parts[1], *parts[2])
)


@settings(max_examples=examples(40, 100))
@given(paths)
def test_every_path_survives_its_text(path):
    assert parse(dotted(path)) == path


@pytest.mark.parametrize("text", ["", "a.", ".a", "a..b", '"a', '"a"b'])
def test_texts_that_are_no_path(text):
    with pytest.raises(ValueError):
        parse(text)
