"""Claims on the verge: elements that may act in either of two ways, to within the bound itself.

Such elements are a contact that neither carries nor gapes, or a spline at the end of a piece. In
the exact equilibrium they act one way or the other, and so they do in every equilibrium on the path
to it from the claim, along which residuals vary in proportion. On that path the error grows at the
rate that belongs to how they act, so it is at most the largest of the errors over all the ways in
which they can act. Source: formulation, section 16.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from itertools import product

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Act, Acts, alike
from loadshare.certify.bound.bound import Box, boxes
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.laws import acting
from loadshare.settings import BOUND


def on_the_verge(claim: Claim, act: Acts, scale: Array, box: Box) -> Box:
    """Bound the errors of S claims some of whose elements may act otherwise.

    Claims whose elements may act in the same ways are bounded together; those that are not bounded
    so, once more alone.

    Parameters
    ----------
    claim : Claim
    act : ndarray of int8, shape (S, elements)
        How the elements seem to act.
    scale : ndarray, shape (S,)
        Load of the claims [N].
    box : Box
        The boxes found for this way of acting.
    """
    found, flanks = Box.unproved(claim, act), claim.columns.flanks
    free = ~_held_by_twins(claim, box)
    doubtful, graphs = box.doubtful & free, _graphs(claim)
    above = doubtful & box.above
    support = claim.situations.support.reshape(len(claim.situations.support), -1) > 0.0
    support = np.broadcast_to(support, (claim.count, support.shape[1]))
    kinds = act, doubtful, above, graphs.reshape(claim.count, -1), support
    for group in alike(np.concatenate(kinds, axis=1).astype(np.int8)):
        for rows in (group, *(group[:, None] if len(group) > 1 else ())):
            rest = rows[~np.isfinite(found.force[rows, flanks]).all(axis=1)]
            if len(rest):
                one = rest[0]
                some = _Group(claim.take(rest), act[one], scale[rest], free[rest], graphs[one])
                found.put(rest, some.bound(doubtful[one], above[one]))
    return found


def _held_by_twins(claim: Claim, box: Box) -> Flags:
    """Return stops of drums without clearance that carry nothing as the opposite one is pressed."""
    stops, first = claim.columns.stops, claim.columns.flanks.stop
    held = np.zeros(box.doubtful.shape, dtype=bool)
    limits = claim.situations.stop.reshape(len(claim.situations.stop), -1)
    pressed = claim.forces[:, stops] > box.force[:, stops]
    for k in range(limits.shape[1]):
        one, twin = limits[:, k], limits[:, k ^ 1]
        apart = one + twin >= -EPS * np.abs(one)
        held[:, first + k] = pressed[:, k ^ 1] & ~pressed[:, k] & apart
    return held


def _graphs(claim: Claim) -> Flags:
    """Return what decides how radial elements may act, shape (S, radials, 5).

    Whether an element can only be open or pressed (a ring, and a spline whose friction is put aside
    where it is open), whether it has no friction, no first piece, a step, a level piece.
    """
    largest = np.abs(claim.forces[:, claim.columns.flanks]).max(axis=1, initial=0.0)
    first, stick, level, reach, _ = claim.graphs.transpose(2, 0, 1)
    with np.errstate(invalid="ignore"):
        steps = (stick == 0.0) | (first * stick < level * (1.0 - BOUND.step))
    is_limit = level <= BOUND.noise * largest[:, None]
    kinds = is_limit, level == 0.0, stick == 0.0, (level > 0.0) & steps, reach > stick
    return np.stack(kinds, axis=2)


class _Group:
    """Claims whose elements may act in the same ways.

    Parameters
    ----------
    claim : Claim
    act : ndarray of int8, shape (elements,)
        How the elements seem to act in all of them.
    scale : ndarray, shape (S,)
        Load of the claims [N].
    free : ndarray of bool, shape (S, elements)
        Elements that may turn out to be on the verge.
    graphs : ndarray of bool, shape (radials, 5)
        See `_graphs`.
    """

    def __init__(self, claim: Claim, act: Acts, scale: Array, free: Flags, graphs: Flags) -> None:
        self.claim, self.act, self.scale, self.free, self.graphs = claim, act, scale, free, graphs
        self.first = claim.take(np.array([0]))
        self.contacts = len(claim.columns.contacts)
        self.radials = len(act) - len(graphs)
        self.box = Box.unproved(claim, np.broadcast_to(act, (claim.count, len(act))))

    def bound(self, doubtful: Flags, above: Flags) -> Box:
        """Bound the errors, given which elements are in doubt, and which of them may act above."""
        ways = {e: self._ways(e, bool(above[e])) for e in np.flatnonzero(doubtful).tolist()}
        self._try(np.arange(self.claim.count), ways, BOUND.verge_passes)
        return self.box

    def _try(self, rows: Numbers, ways: Mapping[int, tuple[int, ...]], passes: int) -> None:
        """Bound some of the claims with some elements on the verge, and those found on the way."""
        idle = self._idle(list(ways))
        tried = {e: way for e, way in ways.items() if e not in idle}
        if len(tried) > BOUND.on_the_verge or not passes:
            return
        acts = np.array(
            [
                _with(
                    self.act, dict.fromkeys(idle, Act.OPEN) | dict(zip(tried, choice, strict=True))
                )
                for choice in product(*tried.values())
            ]
        )
        # A contact that closes alone can change no force, and counts as open. But it may push a
        # loose part until that touches elsewhere.
        opened, of = np.unique(
            [self._without_idle(act, list(tried)) for act in acts], axis=0, return_inverse=True
        )
        touching = _closed(acts, idle)
        pushed = None if np.array_equal(touching, opened) else touching
        every = self._each(rows, opened, ways)
        for some in alike(every.unbalanced):
            many, lost = every.take(some), every.unbalanced[some[0]]
            if lost.any():
                # Unless it balances residuals that nothing else can balance.
                closed = _closed(acts[lost[of.reshape(-1)]], idle)
                these = np.unique(np.concatenate([opened[~lost], closed]), axis=0)
                many = self._each(rows[some], these, ways)
            for same in alike(many.unbalanced):
                self._take(rows[some[same]], many.take(same), ways, pushed, passes)

    def _take(
        self,
        rows: Numbers,
        many: Box,
        ways: Mapping[int, tuple[int, ...]],
        pushed: Acts | None,
        passes: int,
    ) -> None:
        """Take the largest errors of claims; where further elements are on the verge, go on."""
        # A way of acting in which the load is not in balance belongs to no equilibrium.
        held = ~many.unbalanced[0]
        if not held.any():
            return
        new, above = self._new(rows, many.doubtful[:, held], many.above[:, held], ways)
        quiet = np.flatnonzero(~new.any(axis=1))
        if len(quiet) and pushed is not None:
            more = self._each(rows[quiet], pushed, ways)
            new[quiet], above[quiet] = self._new(rows[quiet], more.doubtful, more.above, ways)
        for same in alike(new.astype(np.int8) + (new & above)):
            one = same[0]
            if new[one].any():
                found = np.flatnonzero(new[one]).tolist()
                others = {e: self._ways(e, bool(above[one, e])) for e in found}
                self._try(rows[same], {**ways, **others}, passes - 1)
                continue
            force, coordinate = (
                v[same][:, held].max(axis=1) for v in (many.force, many.coordinate)
            )
            self.box.force[rows[same]], self.box.coordinate[rows[same]] = force, coordinate

    def _new(
        self, rows: Numbers, doubtful: Flags, above: Flags, known: Iterable[int]
    ) -> tuple[Flags, Flags]:
        """Return further elements in doubt, and whether they may act above, (rows, elements)."""
        doubtful = doubtful & self.free[rows][:, None]
        doubtful[:, :, list(known)] = False
        first = doubtful.argmax(axis=1)[:, None]
        return np.asarray(doubtful.any(axis=1)), np.take_along_axis(above, first, axis=1)[:, 0]

    def _each(self, rows: Numbers, acts: Acts, verge: Iterable[int]) -> Box:
        """Return the boxes of claims for each of W ways of acting, arrays (rows, W, …)."""
        on_verge = np.zeros(len(self.act), dtype=bool)
        on_verge[list(verge)] = True
        parts, together = [], max(BOUND.together // len(acts), 1)
        for at in range(0, len(rows), together):
            some = np.repeat(rows[at : at + together], len(acts))
            many = np.tile(acts, (len(some) // len(acts), 1))
            there = np.broadcast_to(on_verge, many.shape)
            parts.append(boxes(self.claim.take(some), many, self.scale[some], there))
        every = (np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(Box))
        return Box(*(v.reshape(len(rows), len(acts), *v.shape[1:]) for v in every))

    def _idle(self, doubtful: list[int]) -> set[int]:
        """Return doubtful contacts that cannot change a force, whether they touch or not."""
        contacts = [e for e in doubtful if e < self.contacts]
        return self._alone(_with(self.act, dict.fromkeys(contacts, Act.STOP)), contacts)

    def _without_idle(self, act: Acts, doubtful: list[int]) -> Acts:
        """Return a way of acting with those elements open that cannot change a force in it."""
        limits = [e for e in doubtful if act[e] == Act.STOP and self._is_limit(e)]
        return _with(act, dict.fromkeys(self._alone(act, limits), Act.OPEN))

    def _is_limit(self, e: int) -> bool:
        """Return whether an element can only be open or pressed."""
        return e < self.radials or bool(self.graphs[e - self.radials, 0])

    def _alone(self, act: Acts, some: list[int]) -> set[int]:
        """Return those of some closed elements that take no part in any self-stress."""
        columns = self.claim.columns
        if not some:
            return set()
        active = np.flatnonzero(acting(self.first, act[None])[0])
        part = np.zeros(len(columns.names))
        redundant = columns.statics(active).redundant
        part[active] = np.abs(redundant).max(axis=1, initial=0.0)

        def share(e: int) -> float:
            if e < self.contacts:
                return float(part[columns.contacts[e]])
            first = columns.first_pair + 2 * (e - self.contacts)
            return float(part[first : first + 2].max())

        return {e for e in some if share(e) < BOUND.idle}

    def _ways(self, e: int, above: bool) -> tuple[int, ...]:
        """Return how an element may act."""
        act = int(self.act[e])
        if act == Act.OPEN or (act == Act.STOP and self._is_limit(e)):
            return Act.OPEN, Act.STOP
        if e < self.radials:
            return (act,)
        _, frictionless, blunt, steps, slips = self.graphs[e - self.radials].tolist()
        bottom = Act.OPEN if frictionless else Act.PINNED if blunt else Act.STICK
        chain = [bottom]
        if steps and bottom != Act.PINNED:
            chain.append(Act.STEP)
        if slips and not frictionless:
            chain.append(Act.SLIP)
        chain.append(Act.STOP)
        if act not in chain:
            return (act,)
        at = chain.index(act)
        other = at + 1 if above else at - 1
        return (act, chain[other]) if 0 <= other < len(chain) else (act,)


def _with(act: Acts, changes: Mapping[int, int]) -> Acts:
    changed = act.copy()
    for e, way in changes.items():
        changed[e] = way
    return changed


def _closed(acts: Acts, contacts: Iterable[int]) -> Acts:
    """Return ways of acting with some contacts closed, each once."""
    closed = acts.copy()
    closed[:, list(contacts)] = Act.STOP
    return np.asarray(np.unique(closed, axis=0))
