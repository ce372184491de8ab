from __future__ import annotations

import pytest
from tests.support import CASES

from benchmarks.reproduction import both_errors, loads, rings, single_errors, splines
from benchmarks.reproduction.both_errors import BothErrors
from benchmarks.reproduction.loads import Loads
from benchmarks.reproduction.rings import Rings
from benchmarks.reproduction.seed import Seed
from benchmarks.reproduction.single_errors import Eccentricity, Installation
from benchmarks.reproduction.splines import Clearance, FullFloat


@pytest.fixture(scope="session")
def seed() -> Seed:
    return Seed(CASES)


@pytest.fixture(scope="session")
def both(seed: Seed) -> BothErrors:
    """Return the fit of figure 10."""
    return both_errors.both_errors(seed)


@pytest.fixture(scope="session")
def full(seed: Seed, both: BothErrors) -> FullFloat:
    """Return the results for figure 11."""
    return splines.full_float(seed, both.case)


@pytest.fixture(scope="session")
def loosened(seed: Seed, both: BothErrors) -> Clearance:
    """Return the results for figure 12."""
    return splines.clearance(seed, both.case)


@pytest.fixture(scope="session")
def loaded(seed: Seed, both: BothErrors, full: FullFloat) -> Loads:
    """Return the results for figure 18."""
    return loads.loads(seed, both.case, full.case)


@pytest.fixture(scope="session")
def limited(seed: Seed) -> Rings:
    """Return the results for figures 13 and 14."""
    return rings.rings(seed)


@pytest.fixture(scope="session")
def displaced(seed: Seed) -> Installation:
    """Return the results for figure 8."""
    return single_errors.installation(seed)


@pytest.fixture(scope="session")
def turning(seed: Seed) -> Eccentricity:
    """Return the results for figure 9."""
    return single_errors.eccentricity(seed)
