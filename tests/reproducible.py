"""Examples that are the same in every run.

Hypothesis sometimes draws a number that it finds in the code of imported modules. A run of a single
file would then draw other examples than a run of all, and a failure would not be reproduced.
"""

from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from hypothesis.internal.conjecture.providers import AVAILABLE_PROVIDERS, HypothesisProvider


class Drawn(HypothesisProvider):
    """Hypothesis's own way to draw, without numbers from code."""

    def _maybe_draw_constant(self, *_: object, **__: object) -> None:
        return None


# This also avoids reading all imported modules for their numbers, which takes as long as many
# tests.
providers._get_local_constants = lambda: providers._local_constants
AVAILABLE_PROVIDERS["reproducible"] = f"{Drawn.__module__}.{Drawn.__name__}"
SAME = settings(backend="reproducible", deadline=None, derandomize=True, database=None)
"""Profile of every property test."""
TRAINS = settings(SAME, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
"""Profile for tests that draw whole trains."""

QUICK = False
"""Whether slow tests are left out; `conftest` sets it from the options of the run."""


def examples(quick: int, every: int) -> int:
    """Return the number of examples of a property test: `every` if slow tests run, else `quick`."""
    return quick if QUICK else every
