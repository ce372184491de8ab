"""Where each float rests: inside its region or on which boundary, and its spline's stage."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.state import ClaimedState, size

STAGES = ("stick", "slip", "stop")
"""Stages of a spline, in the order of the pieces of its graph."""


@dataclass(frozen=True, slots=True)
class Touch:
    """A boundary of a float's region.

    Attributes
    ----------
    name : str
    margin : float
        Distance left [m]; negative inside an elastic ring's wall.
    force : float
        Size of its reaction [N].
    normal : tuple of float
        Outward normal of the region, (2,) in the gear's transverse frame.
    touching : bool
        Whether the centre lies on it: it pushes, or its margin is within the band and the place is
        determined.
    """

    name: str
    margin: float
    force: float
    normal: tuple[float, float]
    touching: bool


@dataclass(frozen=True, slots=True)
class FloatState:
    """Rest of one float.

    Attributes
    ----------
    gear : str
    state : str
        "inside", "on boundary", or "undetermined" where forces leave the place open and no boundary
        pushes; margins are then those of the place of least norm.
    boundary : str or None
        The boundaries it touches, the hardest pressed first.
    margin : float or None
        Smallest distance to a boundary [m]; None without a ring.
    normal : tuple of float or None
        Outward normal of the hardest pressed boundary.
    reaction : tuple of float
        Force of the ring on the gear [N], (2,) in the gear's transverse frame.
    boundaries : tuple of Touch
    spline : str or None
        Stage of the spline: "stick", "slip", "stop".
    spline_force : float
        Size of the spline's force [N].
    friction : float or None
        Friction bound F_m of the spline [N].
    """

    gear: str
    state: str
    boundary: str | None
    margin: float | None
    normal: tuple[float, float] | None
    reaction: tuple[float, float]
    boundaries: tuple[Touch, ...]
    spline: str | None
    spline_force: float
    friction: float | None


class Boundaries(NamedTuple):
    """Boundaries of a float's region in S claims, and their forces on it.

    Attributes
    ----------
    names : tuple of str
    margin, force : ndarray, shape (boundaries, S)
        Distance left [m], size of the reaction [N].
    normal : ndarray, shape (boundaries, 2, S)
        Outward, in the gear's transverse frame.
    touching : ndarray of bool, shape (boundaries, S)
    reaction : ndarray, shape (2, S)
        Force of all of them together [N].
    """

    names: tuple[str, ...]
    margin: Array
    force: Array
    normal: Array
    touching: Flags
    reaction: Array


Some = tuple[tuple[str, ...], Array, Array, Array, Array]
"""Of some boundaries: names, margins, forces, outward normals, forces on the gear."""


class FloatPlaces:
    """Where the floats of a train rest in S claims.

    Parameters
    ----------
    state : ClaimedState
    undetermined : sequence of collection of str
        Coordinates that the forces of each claim do not determine.
    band : float
        Relative band: a margin within band × deflection at a place that is determined, or a
        reaction above band × load, is contact.
    """

    def __init__(
        self, state: ClaimedState, undetermined: Iterable[Collection[str]], band: float
    ) -> None:
        self.state, self.gears = state, state.of.train.floating
        places = [{f"gear {gear} x", f"gear {gear} y"} for gear in self.gears]
        settled = [[place.isdisjoint(names) for place in places] for names in undetermined]
        self._settled = np.array(settled, dtype=bool).reshape(state.count, len(places)).T
        self._near, self._pressed = band * state.deflection, band * state.load
        self._boundaries: dict[str, Boundaries] = {}

    def settled(self, gear: str) -> Flags:
        """Return whether the forces determine the place of a float, (S,)."""
        return np.asarray(self._settled[self.gears.index(gear)])

    def boundaries(self, gear: str) -> Boundaries:
        """Return the boundaries of a float's region."""
        if gear not in self._boundaries:
            none, nowhere = (np.zeros((0, *inner, self.state.count)) for inner in ((), (2,)))
            parts: list[Some] = [((), none, none, nowhere, nowhere)]
            parts += [*self._of_drums(gear), *self._of_rings(gear)]
            each, *figures = zip(*parts, strict=True)
            margin, force, normal, pushed = map(np.concatenate, figures)
            touching = self.settled(gear) & (margin <= self._near) | (force > self._pressed)
            names = tuple(name for some in each for name in some)
            self._boundaries[gear] = Boundaries(
                names, margin, force, normal, touching, pushed.sum(axis=0)
            )
        return self._boundaries[gear]

    def _of_drums(self, gear: str) -> Iterable[Some]:
        """Yield the boundaries of a float's drums."""
        state, of = self.state, self.state.of
        plane = of.train.gears[gear].plane
        for d, ring in enumerate(of.train.drums):
            if ring.gear != gear:
                continue
            arcs = -state.way[d] / size(state.way[d])[:, None]
            stops = np.stack([ring.across, -ring.across])[..., None]
            stops = np.broadcast_to(stops, (2, 3, state.count))
            normal, force = plane @ np.concatenate([arcs, stops]), state.ring_force[d]
            own = slice(first := len(of.flanks) + 4 * d, first + 4)
            pushed = -force[:, None] * normal
            yield of.contacts[own], -state.approach[own], force, normal, pushed

    def _of_rings(self, gear: str) -> Iterable[Some]:
        """Yield the boundaries of a float's round rings."""
        state, of = self.state, self.state.of
        plane = of.train.gears[gear].plane
        for q, ring in enumerate(of.train.rounds):
            if ring.gear != gear:
                continue
            radius, pushed = state.radius[q], plane @ state.reaction[q]
            outward = plane @ state.offset[q] / np.where(radius > 0.0, radius, 1.0)
            margin = state.here.round_radius[q] - radius
            yield (
                (of.pulls[q],),
                margin[None],
                size(pushed, axis=0)[None],
                outward[None],
                pushed[None],
            )

    @cached_property
    def margin(self) -> Array:
        """Smallest distance to a boundary [m], (floats, S); NaN without one."""
        every = [self.boundaries(gear).margin for gear in self.gears]
        least = [m.min(axis=0) if len(m) else np.full(self.state.count, np.nan) for m in every]
        return self._over_floats(least)

    @cached_property
    def on_boundary(self) -> Flags:
        """Whether a boundary is touched, (floats, S)."""
        every = [np.any(self.boundaries(gear).touching, axis=0) for gear in self.gears]
        return np.array(every, dtype=bool).reshape(len(self.gears), self.state.count)

    @cached_property
    def reaction(self) -> Array:
        """Force of all boundaries [N], (floats, 2, S)."""
        return self._over_floats([self.boundaries(gear).reaction for gear in self.gears], 2)

    def _over_floats(self, values: list[Array], *inner: int) -> Array:
        return np.array(values).reshape(len(self.gears), *inner, self.state.count)

    def rest(self, gear: str) -> NDArray[np.str_]:
        """Return in words where a float rests, (S,): the boundaries it touches, or its state."""
        found = self.boundaries(gear)
        order = np.argsort(-found.force, axis=0, kind="stable")
        touched = np.where(np.take_along_axis(found.touching, order, axis=0), order, -1)
        kinds, which = np.unique(
            np.vstack([touched, self.settled(gear)]), axis=1, return_inverse=True
        )
        words = []
        for *on, settled in kinds.T.tolist():
            label = " + ".join(found.names[b].split(": ")[-1] for b in on if b >= 0)
            words.append(label or ("inside" if settled else "undetermined"))
        return np.array(words, dtype=str)[which.reshape(-1)]

    def stage(self, gear: str) -> Numbers:
        """Return the stage of its spline, (S,), as an index of `STAGES`; −1 without a spline.

        This is the last piece of the graph that the radius has entered and the force has reached.
        With memory, the parts are friction and clearance. Where both hold the slip, how they share
        the force is undetermined; the spline counts as sticking if friction alone could hold it.
        """
        state, own, pressed = self.state, self._on_spline(gear), self._pressed
        if not own:
            return np.full(state.count, -1)
        q, near = own[0], np.where(self.settled(gear), self._near, np.inf)
        first, stick, bound, reach, _ = (figure[q] for figure in state.graph)
        radius = state.radius[q]
        if state.of.train.slip is not None:
            stop = size(state.reaction[own[1]], axis=0)
            total = size(state.reaction[own].sum(axis=0), axis=0)
            sticks = (radius <= near) & (total <= bound + pressed)
            return np.where(sticks, 0, np.where(stop > pressed, 2, 1))
        force = size(state.reaction[q], axis=0)
        pieces = (
            (stick > 0.0, 0.0, 0.0, first),
            (reach > stick, stick, bound, np.zeros(())),
            (np.isfinite(stick), reach, bound, first),
        )
        found = np.select([there for there, *_ in pieces], range(3))
        for number, (there, start, held, stiffness) in enumerate(pieces):
            more = np.where(np.isinf(near) & (stiffness > 0.0), pressed, -pressed)
            found[there & (radius >= start - near) & (force >= held + more)] = number
        return found

    def stage_name(self, gear: str) -> NDArray[np.str_]:
        """Return the stage of its spline in words, (S,); empty without a spline."""
        return np.array([*STAGES, ""])[self.stage(gear)]

    def _on_spline(self, gear: str) -> list[int]:
        """Return the numbers of the radial elements of a gear's spline."""
        of = self.state.of
        splines = tuple(of.train.splines)
        return [q for q, k in of.claims.on_splines if splines[k] == gear]

    def each(self, gear: str) -> list[FloatState]:
        """Return the state of a float, claim by claim."""
        found, state = self.boundaries(gear), self.state
        own = self._on_spline(gear)
        # As plain numbers, claim by claim: reading single entries of arrays takes ten times longer.
        of_boundaries = (found.margin, found.force, found.normal, found.touching)
        every = [np.moveaxis(figures, -1, 0).tolist() for figures in of_boundaries]
        reaction, settled = found.reaction.T.tolist(), self.settled(gear).tolist()
        stages, none = self.stage(gear).tolist(), [None] * state.count
        held = (
            size(state.reaction[own].sum(axis=0), axis=0).tolist() if own else [0.0] * state.count
        )
        friction = state.graph.bound[own[0]].tolist() if own else none
        states = []
        for row, figures in enumerate(zip(*every, strict=True)):
            touches = [
                Touch(name, margin, force, tuple(normal), touching)
                for name, margin, force, normal, touching in zip(found.names, *figures, strict=True)
            ]
            boundaries = sorted(touches, key=lambda t: -t.force)
            on = [t for t in boundaries if t.touching]
            states.append(
                FloatState(
                    gear=gear,
                    state="on boundary" if on else "inside" if settled[row] else "undetermined",
                    boundary=" + ".join(t.name.split(": ")[-1] for t in on) or None,
                    margin=min((t.margin for t in boundaries), default=None),
                    normal=on[0].normal if on else None,
                    reaction=tuple(reaction[row]),
                    boundaries=tuple(boundaries),
                    spline=STAGES[stages[row]] if own else None,
                    spline_force=held[row],
                    friction=friction[row],
                )
            )
        return states
