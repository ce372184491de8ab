"""What a train, a position and an answer bring to the compiled certificate, as tuples of arrays."""

from __future__ import annotations

from collections import namedtuple
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.certificate import BAND
from loadshare.train.equilibria import CLAIMED, Equilibria
from loadshare.train.radial import ROUNDING
from loadshare.train.situations import VARYING, Situations

if TYPE_CHECKING:
    from loadshare.certify.many.judge import Judge

Array = NDArray[np.float64]
Numbers = NDArray[np.uintp]
Flags = NDArray[np.bool_]


class Mechanics(NamedTuple):
    """What is the same for all answers: who touches whom, and how.

    e flanks, g gears, w shafts, d drums, r round rings, n splines; radial elements are the round
    rings, then the splines. Bands stand here so that compiled code never keeps an old one.
    """

    driver: Numbers  # (e,)
    driven: Numbers  # (e,)
    mesh: Numbers  # (e,)
    is_drive: Flags  # (e,)
    is_tabled: Flags  # (e,)
    turning: Array  # (e, 2): approach per rotation of driver and driven gear [m]
    pushing: Array  # (e, 3): approach per relative displacement
    moment: Array  # (e, 2): on driver and driven gear per force [m]
    radius: Array  # (g,)
    frame: Array  # (g, 2, 3)
    axis: Array  # (g, 3)
    is_moving: Flags  # (g,)
    group: Numbers  # (g,): gears joined by rigid shafts have one number
    group_radius: Array  # (groups,): largest base radius; infinite where the output is held
    output: int
    shaft: Numbers  # (w, 2): first and second gear
    is_elastic: Flags  # (w,)
    beyond: Array  # (w, g): torque of a rigid shaft per moment on the gears beyond it
    drum: Numbers  # (d, 3): gear, neighbours
    across: Array  # (d, 3)
    nominal: Array  # (d, 2, 3)
    distance: Array  # (d, 2): length of it
    is_squeezed: Flags  # (d,): whether nothing gives way between its arcs
    pull_gear: Numbers  # (r + n,)
    pull_centre: Array  # (r + n, 3)
    rounds: int
    band: float
    rounding: float


Here = namedtuple("Here", VARYING)  # type: ignore[misc]
"""What a position brings, one row or one per answer: the arrays of `Situations`."""
Claim = namedtuple("Claim", CLAIMED)  # type: ignore[misc]
"""What is claimed: the arrays of `Equilibria`."""


class Sheet(NamedTuple):
    """Figures of the answer on the bench, overwritten by the next."""

    at_rest: Array  # (e,): approach that remains when nothing turns or moves
    compression: Array  # (e,): at the claimed force
    overlap: Array  # (e,): approach less compression
    ring_overlap: Array  # (4 d,)
    pull_offset: Array  # (r + n, 3)
    pull_law: Array  # (r + n, 5)
    moved: Array  # (g, 2): displacement in the gear's frame
    push: Array  # (g, 3): sum of all forces but the bearing's
    moment: Array  # (g,): of flanks; in the end of the load and elastic shafts too
    group_moment: Array  # (groups,)


def mechanics(judge: Judge) -> Mechanics:
    """Return the mechanics that a judge has written down, as compiled code reads them."""
    train, order = judge.train, judge.order
    gears = list(train.gears.values())
    driver = np.array([order[m.driver] for _, m, _ in judge.flanks], dtype=np.uintp)
    driven = np.array([order[m.driven] for _, m, _ in judge.flanks], dtype=np.uintp)
    each = np.arange(len(driver))
    group = np.zeros(len(gears), dtype=np.uintp)
    for number, members in enumerate(judge.groups):
        group[members] = number
    held = group[order[train.output]]
    tabled = np.zeros(len(driver), dtype=np.bool_)
    tabled[[e for e, _ in judge.tabled]] = True
    shafts = list(train.shafts.values())
    nominal = np.array(judge.nominal).reshape(-1, 2, 3)
    pulled = [order[r.gear] for r in train.rounds] + [order[g] for g in train.splines]
    centre = np.zeros((len(pulled), 3))
    for q, ring in enumerate(train.rounds):
        centre[q] = ring.offset
    return Mechanics(
        driver=driver,
        driven=driven,
        mesh=judge.mesh_of.astype(np.uintp),
        is_drive=judge.is_drive,
        is_tabled=tabled,
        turning=np.stack([judge.turning[driver, each], judge.turning[driven, each]], axis=1),
        pushing=np.ascontiguousarray(judge.pushing[driver, :, each]).reshape(-1, 3),
        moment=np.stack([judge.moment[each, driver], judge.moment[each, driven]], axis=1),
        radius=judge.radius,
        frame=np.array([g.frame for g in gears]).reshape(-1, 2, 3),
        axis=np.array([g.axis for g in gears]).reshape(-1, 3),
        is_moving=np.array([g.moves for g in gears], dtype=np.bool_),
        group=group,
        group_radius=np.array(
            [np.inf if k == held else judge.radius[g].max() for k, g in enumerate(judge.groups)]
        ),
        output=order[train.output],
        shaft=np.array([(order[w.first], order[w.second]) for w in shafts], np.uintp).reshape(
            -1, 2
        ),
        is_elastic=np.array([np.isfinite(w.stiffness) for w in shafts], dtype=np.bool_),
        beyond=judge.beyond,
        drum=np.array(
            [[order[g] for g in (r.gear, *r.neighbours)] for r in train.drums], np.uintp
        ).reshape(-1, 3),
        across=np.array([r.across for r in train.drums]).reshape(-1, 3),
        nominal=nominal,
        distance=np.sqrt((nominal**2).sum(axis=2)),
        is_squeezed=np.array([judge.squeezed(r) for r in train.drums], dtype=np.bool_),
        pull_gear=np.array(pulled, dtype=np.uintp),
        pull_centre=centre,
        rounds=len(train.rounds),
        band=BAND,
        rounding=ROUNDING,
    )


def judged(
    of: Mechanics, situations: Situations, answers: Equilibria
) -> tuple[Array, Array, Array]:
    """Judge S claimed equilibria with compiled code.

    Parameters
    ----------
    of : Mechanics
    situations : Situations
    answers : Equilibria

    Returns
    -------
    residuals : ndarray, shape (S, 7)
    load, deflection : ndarray, shape (S,)
        As in `Verdicts`.
    """
    from loadshare.certify.compiled import judge_all

    here = Here(*(_plain(getattr(situations, name)) for name in VARYING))
    claim = Claim(*(_plain(array) for array in answers.arrays))
    count = len(answers.rotation)
    found = np.empty((count, 7)), np.empty(count), np.empty(count)
    judge_all(of, here, claim, _sheet(of), *found)
    return found


def _plain(array: Array) -> Array:
    """Return an array of the one kind that code is compiled for."""
    return np.require(array, np.float64, ["C", "W"])


def _sheet(of: Mechanics) -> Sheet:
    flanks, gears, pulls = len(of.driver), len(of.radius), len(of.pull_gear)
    return Sheet(
        at_rest=np.empty(flanks),
        compression=np.empty(flanks),
        overlap=np.empty(flanks),
        ring_overlap=np.empty(4 * len(of.drum)),
        pull_offset=np.empty((pulls, 3)),
        pull_law=np.empty((pulls, 5)),
        moved=np.empty((gears, 2)),
        push=np.empty((gears, 3)),
        moment=np.empty(gears),
        group_moment=np.empty(len(of.group_radius)),
    )
