"""The laws that the search uses: their forces, tangents and kinks.

Source: formulation, sections 5 and 6. They are compared with differences of the forces.
"""

from itertools import pairwise

import numpy as np
import pytest
from tests.solver.hot.trains import VARIED

from loadshare.job.machine import Machine
from loadshare.scene.loading import loading_of
from loadshare.solver.hot.softened import Laws
from loadshare.train import build_train

CASES = ("splines", "every element", "round ring", "elastic round ring", "tables")
SOFTER, PULL = 1e-6, 1e-3


def machine_of(name: str) -> Machine:
    return Machine(build_train(VARIED[name][0]()))


def drawn(name: str, seed: int) -> tuple[Laws, np.ndarray, np.ndarray]:
    """Return laws, a point at which the elements are pressed, and a direction from there."""
    own, rng = machine_of(name), np.random.default_rng(seed)
    loading = loading_of(own.structure, own.situations([1]))
    count = len(own.structure.vectors)
    force = np.abs(rng.normal(size=count))
    reach = 10.0 ** rng.uniform(-1.0, 1.5)
    laws = Laws(own.structure, loading, force, SOFTER, PULL)
    return laws, *(reach * rng.normal(size=(2, count)))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", CASES)
@pytest.mark.quick(8)
def test_forces_rise_along_every_way_and_are_the_same_one_by_one(name, seed):
    laws, start, way = drawn(name, seed)
    shares = np.linspace(0.0, 1.0, 41)
    forces = laws.forces(start + shares[:, None] * way)
    for share, force in zip(shares, forces, strict=True):
        assert laws.forces(start + share * way) == pytest.approx(force, rel=1e-12)
    slopes = forces @ way
    assert (np.diff(slopes) >= -1e-12 * np.abs(slopes).max()).all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", CASES)
def test_between_two_kinks_the_tangents_are_those_of_the_forces(name, seed):
    laws, start, way = drawn(name, seed)
    kinks = np.concatenate([[0.0], laws.kinks(start, way), [1.0]])
    assert len(kinks) > 2
    scalar = laws.scalar
    for low, high in pairwise(kinks):
        share, step = 0.5 * (low + high), 1e-4 * (high - low)
        near = start + (share + step * np.array([-1.0, 0.0, 1.0]))[:, None] * way
        forces = laws.forces(near)
        compliance, stiffness = laws.tangents(near[1], forces[1])
        two = np.einsum("jab,jb->ja", stiffness, way[scalar:].reshape(-1, 2)).ravel()
        tangent = np.concatenate([way[:scalar] / compliance, two])
        seen = (forces[2] - forces[0]) / (2.0 * step)
        rounding = 1e-12 * np.abs(forces).max() / step
        assert tangent == pytest.approx(seen, rel=1e-4, abs=1e-9 * np.abs(tangent).max() + rounding)
