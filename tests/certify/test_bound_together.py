"""Claims that are bounded together: as closely as each alone, in every way that a bound is found.

Elements on the verge, gears that rigid limits lock, friction that is light, forces of rounding: the
trains are random ones whose samples need them. Source: formulation, section 16.
"""

import numpy as np
import pytest

from benchmarks.random_batches.measure import samples_of
from benchmarks.random_trains.draw import draw
from benchmarks.random_trains.layouts import LAYOUTS
from benchmarks.random_trains.planetary import LOOPS, PLANETARY
from loadshare.certify.bound import Columns, bounds
from loadshare.job.machine import Machine
from loadshare.solver.hot import vectorised
from loadshare.train.samples import samples_of as grouped

SEED, COUNT = 20, 12


@pytest.mark.parametrize("number", [14, 49, 74, 93, 111])
@pytest.mark.quick(2)
def test_claims_together_are_bounded_like_each_alone(number):
    case = draw(SEED, number, LAYOUTS | PLANETARY | LOOPS)
    samples = {key: v[:COUNT] for key, v in samples_of(case, SEED, number).items()}
    ((_, group),) = grouped(case, samples)
    machine = Machine(group.train).at(1)
    here = group.situations(1)
    found = machine.answer(here, 1e-9, vectorised.settle)
    assert found.passed.all()
    columns = Columns(machine.train)
    together = bounds(columns, here, found.equilibria)
    rows = np.arange(COUNT)[:, None]
    alone = np.concatenate(
        [bounds(columns, here.take(one), found.equilibria.take(one)).relative for one in rows]
    )
    assert (together.relative <= 1e-9).all()
    assert (together.relative <= 100.0 * alone + 1e-12).all()
