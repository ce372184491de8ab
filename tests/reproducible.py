"""Examples that are the same in every run.

Hypothesis draws now and then a number that it finds in the code of what has been imported, so that
a run of a single file draws other examples than a run of all, and a failure is not met again.
"""

from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from hypothesis.internal.conjecture.providers import AVAILABLE_PROVIDERS, HypothesisProvider


class Drawn(HypothesisProvider):
    """Hypothesis's own way to draw, without numbers from code."""

    def _maybe_draw_constant(self, *_: object, **__: object) -> None:
        return None


# So nobody need read all that is imported for its numbers, which takes as long as many a test.
providers._get_local_constants = lambda: providers._local_constants
AVAILABLE_PROVIDERS["reproducible"] = f"{Drawn.__module__}.{Drawn.__name__}"
SAME = settings(backend="reproducible", deadline=None, derandomize=True, database=None)
"""Every test of a property has this profile."""
TRAINS = settings(SAME, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
"""For what draws whole trains."""

QUICK = False
"""Whether slow tests are left out; `conftest` finds it in the options of the run."""


def examples(quick: int, every: int) -> int:
    """How many examples a property is tried on: every one where slow tests run."""
    return quick if QUICK else every
