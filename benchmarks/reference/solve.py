"""The reference equilibrium of a train: found in double precision, settled in 50 digits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.reference.equations import Guess
from benchmarks.reference.machine import Machine, machine
from benchmarks.reference.settle import NoReference, Settled, loose_directions, settle
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.placed import train_at
from loadshare.train.situations import Situations, situation_of
from loadshare.train.train import Train

__all__ = ["NoReference", "Reference", "reference"]

DIGITS = 70
"""Digits of the arithmetic; twenty more than the reference claims."""
TOLERANCE = "1e-45"
"""Largest residual, in the force and length units of the case."""
SOFTENINGS = (0.0, 1e-1, 1e-3, 1e-5, 1e-7)
"""Softenings at which the search for an active set starts; each is reduced to zero."""
FREE = 1e-9
"""Fraction of a null vector above which a coordinate counts as undetermined."""


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """An equilibrium in 50 digits, and the nearest doubles.

    Attributes
    ----------
    torque : mapping of mesh to float
        Drive less coast torque at the driver [N·m].
    displacement : mapping of gear to ndarray, shape (2,)
        p [m] of every gear that moves, in its transverse frame.
    force : mapping of contact to float
        [N], of flanks, arcs and stops; zero if open.
    pull : mapping of element to ndarray, shape (2,)
        Force [N] of every spline and round ring on its gear.
    undetermined : frozenset of str
        Gears whose displacement the equilibrium does not determine.
    loose : frozenset of str
        These gears, and those whose displacement depends on forces below 1e-9 of the load: their
        place is decided by digits that no case file has.
    residual : float
        Largest residual of all equations, in the force and length units of the case.
    imbalance : float
        Imbalance along free directions from the rounding of the train's figures, over the load;
        zero without such directions.
    slack : float
        Distance to the nearest change of a sign: smallest force of a closed contact or smallest gap
        of an open one; near zero on the verge.
    exact : mapping of mesh to str
        The torques in 50 digits.
    """

    torque: Mapping[str, float]
    displacement: Mapping[str, Vector]
    force: Mapping[str, float]
    pull: Mapping[str, Vector]
    undetermined: frozenset[str]
    loose: frozenset[str]
    residual: float
    imbalance: float
    slack: float
    exact: Mapping[str, str]


def reference(train: Train, index: int = 1, hint: Equilibrium | None = None) -> Reference:
    """Find the equilibrium of a position in 50-digit arithmetic.

    Parameters
    ----------
    train : Train
    index : int
        1-based position.
    hint : Equilibrium, optional
        Start of the search. It saves time and cannot change the answer, whose equations and signs
        are checked in 50 digits.

    Returns
    -------
    Reference

    Raises
    ------
    NoReference
        If no active set was found, or the train is not determined to 50 digits.
    """
    return report(train, *settled_in_digits(train, index, hint))


def settled_in_digits(
    train: Train, index: int = 1, hint: Equilibrium | None = None
) -> tuple[Machine, Settled]:
    """Return the equations of a position in 70 digits, and their solution.

    Parameters, errors: as for `reference`.
    """
    import mpmath

    train = train_at(train, index)
    situation = situation_of(train, index)
    exact = mpmath.MPContext()
    exact.dps = DIGITS
    fine = machine(train, situation, exact)
    start = _hinted(fine, train, hint) if hint else _raised(fine, _found(train, situation))
    return fine, settle(fine, start, exact.mpf(TOLERANCE), exact.mpf(10) ** -50)


def _found(train: Train, situation: Situations) -> Guess:
    """Find the active set in double precision, over softened trains if that fails directly."""
    import mpmath

    last: NoReference | None = None
    for first in SOFTENINGS:
        soft = machine(train, situation, mpmath.fp, first)
        start = _at_rest(soft)
        try:
            for softening in (first, *(s for s in SOFTENINGS[1:] if s < first), 0.0):
                coarse = machine(train, situation, mpmath.fp, softening)
                start = settle(coarse, start, 1e-9, 1e-12).at
        except NoReference as failure:
            last = failure
            continue
        return start
    raise last or NoReference("nothing was tried")


def _at_rest(coarse: Machine) -> Guess:
    """Return a start: drive flanks under the whole load, everything else open and unmoved."""
    unit, zero = coarse.arithmetic.mpf(1), coarse.arithmetic.mpf(0)
    bounds = {
        n: g.per_torque * sum(abs(a) for a in g.torque_of.values()) if g.torque_of else g.bound
        for n, g in coarse.graphs.items()
    }
    drive = [n for n in coarse.contacts if not n.startswith("ring ") and not n.endswith(" coast")]
    return Guess(
        [zero] * coarse.size,
        dict.fromkeys(drive, unit),
        [zero] * len(coarse.ties),
        {n: g.place(zero, zero, bounds[n]) for n, g in coarse.graphs.items()},
        {n: [zero, zero] for n in coarse.graphs},
        bounds,
    )


def _raised(fine: Machine, found: Guess) -> Guess:
    of = fine.arithmetic.mpf
    return Guess(
        [of(v) for v in found.x],
        {n: of(v) for n, v in found.forces.items()},
        [of(v) for v in found.ties],
        dict(found.places),
        {n: [of(v) for v in p] for n, p in found.pulls.items()},
        {
            n: fine.graphs[n].bound if not fine.graphs[n].torque_of else of(b)
            for n, b in found.bounds.items()
        },
    )


def _hinted(fine: Machine, train: Train, hint: Equilibrium) -> Guess:
    """Return the active set and unknowns of an answer in doubles."""
    of, zero = fine.arithmetic.mpf, fine.arithmetic.mpf(0)
    x = [zero] * fine.size
    for gear, i in fine.turns.items():
        turned = of(hint.rotation[gear]) * of(train.gears[gear].base_radius)
        x[i] = turned / of(fine.length)
    for gear, i in fine.moves.items():
        for k, value in enumerate(train.gears[gear].frame @ hint.displacement[gear]):
            x[i + k] = of(float(value)) / of(fine.length)
    claimed = {**hint.flank_force, **hint.ring_force}
    band = 1e-11 * max([fine.force, *claimed.values()])
    forces = {n: of(f) / of(fine.force) for n, f in claimed.items() if f > band}
    places, pulls, bounds = {}, {}, {}
    for name, graph in fine.graphs.items():
        frame = train.gears[graph.gear].frame
        pulls[name] = [-of(float(v)) / of(fine.force) for v in frame @ hint.radial_reaction[name]]
        bounds[name] = graph.bound
        if graph.torque_of:
            total = sum((a * forces.get(f, zero) for f, a in graph.torque_of.items()), zero)
            bounds[name] = graph.per_torque * abs(total)
        q = [x[i] - c for i, c in zip(graph.indices, graph.centre, strict=True)]
        size = fine.arithmetic.hypot(*pulls[name])
        places[name] = graph.place(fine.arithmetic.hypot(*q), size, bounds[name])
    return Guess(x, forces, [zero] * len(fine.ties), places, pulls, bounds)


def _moving(fine: Machine, spans: Sequence[Sequence[Any]]) -> frozenset[str]:
    """Return the gears that null vectors displace."""
    return frozenset(
        gear
        for gear, i in fine.moves.items()
        for span in spans
        if max(abs(span[i]), abs(span[i + 1])) > FREE * max(abs(v) for v in span)
    )


def report(train: Train, fine: Machine, settled: Settled) -> Reference:
    """Return an equilibrium in 70 digits as doubles."""
    at, unit, length = settled.at, fine.arithmetic.mpf(fine.force), fine.arithmetic.mpf(fine.length)
    force = {n: float(at.forces.get(n, 0) * unit) for n in fine.contacts}
    torque: dict[str, Any] = {}
    for name, mesh in train.meshes.items():
        torque[name] = sum(
            fine.arithmetic.mpf(mesh.lever(d)) * at.forces.get(mesh.flank_name(d), 0) * unit
            for d in mesh.flanks
        )
    gaps = [-c.approach(at.x)[0] for n, c in fine.contacts.items() if n not in at.forces]
    undetermined = _moving(fine, settled.free)
    return Reference(
        torque={n: float(t) for n, t in torque.items()},
        displacement={
            g: np.array([float(at.x[i + k] * length) for k in (0, 1)])
            for g, i in fine.moves.items()
        },
        force=force,
        pull={n: np.array([-float(v * unit) for v in p]) for n, p in at.pulls.items()},
        undetermined=undetermined,
        loose=undetermined | _moving(fine, loose_directions(fine, at)),
        residual=float(settled.residual),
        imbalance=float(settled.imbalance),
        slack=float(min([*at.forces.values(), *gaps], default=0)),
        exact={n: fine.arithmetic.nstr(t, 50) for n, t in torque.items()},
    )
