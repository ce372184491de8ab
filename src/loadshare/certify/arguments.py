"""What the compiled certificate is called with, as tuples of arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.mechanics import Mechanics
from loadshare.certify.plain import plain
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations

Array = NDArray[np.float64]
Numbers = NDArray[np.uintp]
Flags = NDArray[np.bool_]


class Arguments(NamedTuple):
    """What is the same for all answers: `Mechanics` as plain arrays.

    e flanks, g gears, w shafts, d drums, r round rings, n splines; radial elements are the round
    rings, then the splines.
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


class Scratch(NamedTuple):
    """Figures of the answer at hand, overwritten by the next."""

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


def arguments_of(of: Mechanics) -> Arguments:
    """Return the mechanics of a train as compiled code reads them."""
    train, order = of.train, of.order
    gears = list(train.gears.values())
    driver = np.array([order[m.driver] for m, _ in of.flanks], dtype=np.uintp)
    driven = np.array([order[m.driven] for m, _ in of.flanks], dtype=np.uintp)
    each = np.arange(len(driver))
    pushing = of.pushing.reshape(len(driver), -1, 3)
    group = np.zeros(len(gears), dtype=np.uintp)
    for number, members in enumerate(of.groups):
        group[members] = number
    held = group[order[train.output]]
    rounds, pulls = len(train.rounds), np.argsort(of.claimed)
    return Arguments(
        driver=driver,
        driven=driven,
        mesh=of.mesh_of.astype(np.uintp),
        is_drive=of.is_drive,
        is_tabled=_flags(of.tabled, len(driver)),
        turning=np.stack([of.turning[each, driver], of.turning[each, driven]], axis=1),
        pushing=np.ascontiguousarray(pushing[each, driver]).reshape(-1, 3),
        moment=np.stack([of.moment[driver, each], of.moment[driven, each]], axis=1),
        radius=of.radius,
        frame=np.array([g.frame for g in gears]).reshape(-1, 2, 3),
        axis=np.array([g.axis for g in gears]).reshape(-1, 3),
        is_moving=_flags(of.moving, len(gears)),
        group=group,
        group_radius=np.array(
            [np.inf if k == held else of.radius[g].max() for k, g in enumerate(of.groups)]
        ),
        output=order[train.output],
        shaft=of.shaft.astype(np.uintp),
        is_elastic=_flags(of.elastic, len(of.shaft)),
        beyond=of.beyond,
        drum=np.concatenate([of.drum[:, None], of.neighbours], axis=1).astype(np.uintp),
        across=of.across,
        nominal=of.nominal,
        distance=of.distance,
        is_squeezed=_flags(of.squeezed, len(of.drum)),
        pull_gear=of.pulled[pulls].astype(np.uintp),
        pull_centre=of.centres[pulls],
        rounds=rounds,
    )


def _flags(numbers: NDArray[np.intp] | list[int], count: int) -> Flags:
    """Whether each of so many is among some numbers."""
    flags = np.zeros(count, dtype=np.bool_)
    flags[numbers] = True
    return flags


def judged(
    of: Arguments, situations: Situations, answers: Equilibria
) -> tuple[Array, Array, Array]:
    """Judge S claimed equilibria with compiled code.

    Parameters
    ----------
    of : Arguments
    situations : Situations
    answers : Equilibria

    Returns
    -------
    residuals : ndarray, shape (S, 7)
    load, deflection : ndarray, shape (S,)
        As in `Verdicts`.
    """
    from loadshare.certify.compiled import judge_all

    here, claim = plain(situations, answers)
    count = len(answers.rotation)
    found = np.empty((count, 7)), np.empty(count), np.empty(count)
    judge_all(of, here, claim, _scratch(of), *found)
    return found


def _scratch(of: Arguments) -> Scratch:
    flanks, gears, pulls = len(of.driver), len(of.radius), len(of.pull_gear)
    return Scratch(
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
