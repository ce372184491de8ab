"""Claims on the verge: elements that may act in either of two ways, to within the bound itself.

Such elements are a contact that neither carries nor gapes, or a spline at the end of a piece. In
the exact equilibrium they act one way or the other, and so they do in every equilibrium on the path
to it from the claim, along which residuals vary in proportion. On that path the error grows at the
rate that belongs to how they act, so it is at most the largest of the errors over all the ways in
which they can act. Source: formulation, section 16.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.certify.bound.acts import Act, Acts
from loadshare.certify.bound.bound import Box, boxes
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.laws import elements
from loadshare.certify.bound.quick import quick_boxes
from loadshare.settings import BOUND


def on_the_verge(claim: Claim, act: Acts, scale: Array, box: Box) -> Box:
    """Bound the error of one claim some of whose elements may act otherwise.

    Parameters
    ----------
    claim : Claim
        A single one.
    act : ndarray of int8, shape (1, elements)
        How the elements seem to act.
    scale : ndarray, shape (1,)
        Load of the claim [N].
    box : Box
        The box found for this way of acting.
    """
    free = ~_held_by_twins(claim, box)
    ways = {
        int(e): _ways(claim, int(e), int(act[0, e]), bool(box.above[0, e]))
        for e in np.flatnonzero(box.doubtful[0] & free)
    }
    for _ in range(BOUND.verge_passes):
        idle = _idle(claim, act, list(ways), scale)
        tried = {e: way for e, way in ways.items() if e not in idle}
        if len(tried) > BOUND.on_the_verge:
            break
        acts = np.array(
            [
                _with(act[0], dict.fromkeys(idle, Act.OPEN) | dict(zip(tried, choice, strict=True)))
                for choice in product(*tried.values())
            ]
        )
        touching = _touching(acts, idle)
        # A contact that closes alone can change no force, and counts as open.
        opened, of = np.unique(
            [_without_idle(claim, a, list(tried), scale) for a in acts],
            axis=0,
            return_inverse=True,
        )
        verge = np.zeros(act.shape[1], dtype=bool)
        verge[list(ways)] = True
        many = _each(claim, opened, scale, verge)
        if many.unbalanced.any():
            # Unless it balances residuals that nothing else can balance.
            lost = acts[many.unbalanced[of.reshape(-1)]]
            lost[:, list(idle)] = Act.STOP
            acts = np.unique(np.concatenate([opened[~many.unbalanced], lost]), axis=0)
            many = _each(claim, acts, scale, verge)
        # A way of acting in which the load is not in balance belongs to no equilibrium.
        held = ~many.unbalanced
        if not held.any():
            break
        doubtful, above = many.doubtful[held], many.above[held]
        if not (doubtful & ~verge & free).any() and not np.array_equal(touching, opened):
            # But such a contact may push a loose part until that touches elsewhere.
            pushed = _each(claim, touching, scale, verge)
            doubtful, above = pushed.doubtful, pushed.above
        new = np.flatnonzero((doubtful & ~verge & free).any(axis=0))
        if not len(new):
            found = _largest(many, held)
            flanks = found.force[:, claim.columns.flanks]
            return found if np.isfinite(flanks).all() else quick_boxes(claim, act, scale)
        for e in new.tolist():
            row = int(np.flatnonzero(doubtful[:, e])[0])
            ways[e] = _ways(claim, e, int(act[0, e]), bool(above[row, e]))
    return quick_boxes(claim, act, scale)


def _each(claim: Claim, acts: Acts, scale: Array, verge: Flags) -> Box:
    """Return the boxes of one claim with its elements acting in several ways."""
    rows = np.zeros(len(acts), dtype=np.intp)
    return boxes(claim.take(rows), acts, scale[rows], np.broadcast_to(verge, acts.shape))


def _touching(acts: Acts, idle: Iterable[int]) -> Acts:
    """Return ways of acting with all contacts closed that cannot change a force."""
    touching = acts.copy()
    touching[:, list(idle)] = Act.STOP
    return np.asarray(np.unique(touching, axis=0))


def _held_by_twins(claim: Claim, box: Box) -> Flags:
    """Return stops of drums without clearance that carry nothing as the opposite one is pressed."""
    stops, first = claim.columns.stops, claim.columns.flanks.stop
    held = np.zeros(box.doubtful.shape[1], dtype=bool)
    limits = claim.situations.stop[0].reshape(-1)
    pressed = claim.forces[0, stops] > box.force[0, stops]
    for k, twin in enumerate(np.arange(len(limits)) ^ 1):
        apart = limits[k] + limits[twin] >= -EPS * abs(limits[k])
        held[first + k] = pressed[twin] and not pressed[k] and apart
    return held


def _with(act: Acts, changes: dict[int, int]) -> Acts:
    changed = act.copy()
    for e, way in changes.items():
        changed[e] = way
    return changed


def _idle(claim: Claim, act: Acts, doubtful: list[int], scale: Array) -> set[int]:
    """Return doubtful contacts that cannot change a force, whether they touch or not."""
    contacts = [e for e in doubtful if e < len(claim.columns.contacts)]
    verge = np.zeros(act.shape, dtype=bool)
    verge[0, contacts] = True
    return _alone(claim, np.where(verge, np.int8(Act.STOP), act), contacts, verge, scale)


def _without_idle(claim: Claim, act: Acts, doubtful: list[int], scale: Array) -> Acts:
    """Return a way of acting with those doubtful elements open that cannot change a force in it."""
    limits = [e for e in doubtful if act[e] == Act.STOP and _is_limit(claim, e)]
    verge = np.zeros((1, len(act)), dtype=bool)
    verge[0, doubtful] = True
    return _with(act, dict.fromkeys(_alone(claim, act[None], limits, verge, scale), Act.OPEN))


def _is_limit(claim: Claim, e: int) -> bool:
    """Return whether an element can only be open or pressed.

    This holds for a contact, a ring, and a spline whose friction is put aside where it is open.
    """
    columns = claim.columns
    radial = e - len(columns.contacts) - (columns.arcs.stop - columns.arcs.start) // 2
    largest = np.abs(claim.forces[0, columns.flanks]).max(initial=0.0)
    return radial < 0 or bool(claim.graphs[0, radial, 2] <= BOUND.noise * largest)


def _alone(claim: Claim, act: Acts, some: list[int], verge: Flags, scale: Array) -> set[int]:
    """Return those of some closed elements that take no part in any self-stress."""
    columns = claim.columns
    if not some:
        return set()
    acting = np.flatnonzero(elements(claim, act, scale, verge).active[0])
    redundant = columns.statics(acting).redundant
    part = np.zeros(len(columns.names))
    part[acting] = np.abs(redundant).max(axis=1, initial=0.0)
    count = len(columns.contacts)

    def share(e: int) -> float:
        if e < count:
            return float(part[columns.contacts[e]])
        first = columns.first_pair + 2 * (e - count)
        return float(part[first : first + 2].max())

    return {e for e in some if share(e) < BOUND.idle}


def _ways(claim: Claim, e: int, act: int, above: bool) -> tuple[int, ...]:
    """Return how an element may act."""
    columns = claim.columns
    contacts = len(columns.contacts)
    arcs = (columns.arcs.stop - columns.arcs.start) // 2
    if act == Act.OPEN or (act == Act.STOP and _is_limit(claim, e)):
        return Act.OPEN, Act.STOP
    first, stick, level, reach, _ = claim.graphs[0, e - contacts - arcs].tolist()
    steps = level > 0.0 and (stick == 0.0 or first * stick < level * (1.0 - BOUND.step))
    slips = reach > stick
    bottom = Act.OPEN if level == 0.0 else Act.PINNED if stick == 0.0 else Act.STICK
    chain = [bottom]
    if steps and bottom != Act.PINNED:
        chain.append(Act.STEP)
    if slips and level > 0.0:
        chain.append(Act.SLIP)
    chain.append(Act.STOP)
    if act not in chain:
        return (act,)
    at = chain.index(act)
    other = at + 1 if above else at - 1
    return (act, chain[other]) if 0 <= other < len(chain) else (act,)


def _largest(many: Box, held: Flags) -> Box:
    """Return the largest errors over all ways of acting."""
    force = many.force[held].max(axis=0)[None]
    coordinate = many.coordinate[held].max(axis=0)[None]
    none = np.zeros((1, many.doubtful.shape[1]), dtype=bool)
    return Box(force, coordinate, none, none, np.zeros(1, dtype=bool))
