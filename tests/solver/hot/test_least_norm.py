"""Places of least norm of many samples against those of each sample alone."""

import numpy as np
import pytest
from tests.solver.hot.trains import VARIED, varied
from tests.support import shipped

from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.scene.assemble import scene_of
from loadshare.settings import CERTIFY
from loadshare.solver.hot.answer import equilibria
from loadshare.solver.hot.least_norm import least_norm
from loadshare.solver.position import coordinates_of, of_least_norm
from loadshare.train.samples import samples_of
from loadshare.train.situations import Situations

SAME = 1e-9
RING = {"rings.4.float [um]": np.linspace(1.0, 30.0, 12)}


def compared(machine: Machine, situations: Situations, away: float) -> tuple[int, int, int]:
    """Compare places of samples, first moved away from where the solver left them.

    Returns
    -------
    tuple of int
        Samples that are not determined; of these, those whose place the batch knows, and moves.
    """
    structure = machine.structure
    found = machine.answer(situations, CERTIFY.tolerance, engine_named("vectorised", 1))
    rows = np.flatnonzero(found.passed & ~found.determined)
    if not len(rows):
        return 0, 0, 0
    here, loading, iterate = (
        situations.take(rows),
        found.loading.take(rows),
        found.iterate.take(rows),
    )
    dice = np.random.default_rng(5)
    iterate.x += away * dice.standard_normal(iterate.x.shape) * np.abs(iterate.x).max()
    places = least_norm(structure, here, loading, iterate)
    claims = equilibria(structure, here, iterate)
    for k in np.flatnonzero(places.known).tolist():
        scene = scene_of(structure, here.take(slice(k, k + 1)), loading.one(k))
        claimed = claims.one(k, scene.position)
        least = of_least_norm(scene, claimed)
        expected = coordinates_of(scene, least) / structure.length
        size = np.abs(expected).max()
        assert np.abs(places.x[k] - expected).max() <= SAME * size
        assert places.moved[k] == (least.displacement is not claimed.displacement)
    return len(rows), int(places.known.sum()), int(places.moved.sum())


@pytest.mark.parametrize("away", [0.0, 1e-6, 1e-3])
@pytest.mark.parametrize("name", VARIED)
def test_samples(name, away):
    ((_, group),) = samples_of(*varied(name, 24, seed=7))
    compared(Machine(group.train), group.situations(1), away)


def test_all_places_between_stops_and_arcs_are_known():
    ((_, group),) = samples_of(shipped("fgfbstts/limit_ring"), RING)
    machine = Machine(group.train)
    count, known, moved = compared(machine, group.situations(1), 1e-6)
    assert moved == known == count > 0
