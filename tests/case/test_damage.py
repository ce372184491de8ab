import contextlib

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.reproducible import examples
from tests.support import shipped

from loadshare.case import Case
from loadshare.case.keys import look_up
from loadshare.errors import CaseError

GARBAGE = st.recursive(
    st.sampled_from(
        [
            0,
            -1,
            2.5,
            float("nan"),
            True,
            "",
            "a",
            "4",
            "rigid",
            "1 mm",
            "1 N*m",
            "0 deg",
            "a-b",
            "*",
        ]
    ),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["a", "about", "law", "b", "float"]), inner, max_size=3)
    ),
    max_leaves=4,
)


def places(data, above=()):
    """Yield the path of every item in nested data, including list items."""
    items = data.items() if isinstance(data, dict) else enumerate(data)
    for step, value in items:
        yield (*above, step)
        if isinstance(value, dict | list):
            yield from places(value, (*above, step))


@settings(max_examples=examples(50, 100), suppress_health_check=list(HealthCheck))
@given(st.data())
def test_no_damage_ends_in_anything_but_problems(data):
    everything = shipped("fgfbstts/all_elements").to_dict()
    for _ in range(data.draw(st.integers(1, 3))):
        path = data.draw(st.sampled_from(list(places(everything))))
        holder = look_up(everything, path[:-1])
        if isinstance(holder, dict) and data.draw(st.booleans()):
            del holder[path[-1]]
        else:
            holder[path[-1]] = data.draw(GARBAGE)
    with contextlib.suppress(CaseError):
        Case(everything).to_toml()
