"""Answers of many samples in physical terms; an `Equilibrium` is one of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import compress

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train


@dataclass(frozen=True)
class Names:
    """Order of a train's gears, contacts and radial elements in arrays.

    Attributes
    ----------
    train : Train
    """

    train: Train

    @cached_property
    def gears(self) -> tuple[str, ...]:
        """Gears."""
        return tuple(self.train.gears)

    @cached_property
    def flanks(self) -> tuple[str, ...]:
        """Flanks that can touch, mesh by mesh."""
        return tuple(m.flank_name(d) for m in self.train.meshes.values() for d in m.flanks)

    @cached_property
    def contacts(self) -> tuple[str, ...]:
        """Contacts of drums: all stops, then all arcs."""
        drums = self.train.drums
        return (
            *(name for r in drums for name in r.stop_names),
            *(r.arc_name(n) for r in drums for n in r.neighbours),
        )

    @cached_property
    def stops(self) -> slice:
        """Slice of the contacts: the stops of drums."""
        return slice(0, 2 * len(self.train.drums))

    @cached_property
    def arcs(self) -> slice:
        """Slice of the contacts: the arcs of drums."""
        return slice(self.stops.stop, len(self.contacts))

    @cached_property
    def rounds(self) -> slice:
        """Slice of the radial elements: the round rings and bearings."""
        return slice(0, len(self.train.rounds))

    @cached_property
    def splines(self) -> slice:
        """Slice of the radial elements: the splines."""
        return slice(self.rounds.stop, self.rounds.stop + len(self.train.splines))

    @cached_property
    def spline_stops(self) -> slice:
        """Slice of the radial elements: the stops of splines with memory."""
        return slice(self.splines.stop, len(self.radials))

    @cached_property
    def on_splines(self) -> tuple[tuple[int, int], ...]:
        """Numbers of the radial elements of splines, each with the number of its spline."""
        parts = self.splines, self.spline_stops
        return tuple((q, k) for part in parts for k, q in enumerate(range(part.start, part.stop)))

    @cached_property
    def radials(self) -> tuple[tuple[str, str], ...]:
        """Name and gear of round rings, bearings, splines and, with memory, splines' stops."""
        splines = self.train.splines
        return (
            *((r.name, r.gear) for r in self.train.rounds),
            *((s.name, g) for g, s in splines.items()),
            *((s.stop_name, g) for g, s in splines.items() if self.train.slip is not None),
        )


@dataclass(frozen=True, eq=False)
class Equilibria:
    """Displacements and forces of a train in S samples.

    Attributes
    ----------
    names : Names
    rotation : ndarray, shape (S, gears)
        φ [rad].
    displacement : ndarray, shape (S, gears, 3)
        p [m].
    flank_force : ndarray, shape (S, flanks)
        [N].
    ring_force : ndarray, shape (S, contacts)
        [N].
    radial_reaction : ndarray, shape (S, radials, 3)
        Force on the gear [N].
    shaft_torque : ndarray, shape (S, shafts)
        Torque of elastic shafts [N·m]; 0 for rigid ones.
    support_force : ndarray, shape (S, gears, 2)
        Force on elastic bearings [N], in each gear's transverse frame; 0 for rigid ones.
    """

    names: Names
    rotation: Array
    displacement: Array
    flank_force: Array
    ring_force: Array
    radial_reaction: Array
    shaft_torque: Array
    support_force: Array

    @property
    def arrays(self) -> tuple[Array, ...]:
        """All arrays, in the order above."""
        return tuple(getattr(self, name) for name in CLAIMED)

    def mapped(self, function: Callable[[Array], Array]) -> Equilibria:
        """Return the answers with a function applied to each of their arrays."""
        return Equilibria(self.names, *map(function, self.arrays))

    def take(self, samples: Numbers | slice) -> Equilibria:
        """Return some of the samples, as a copy; for a slice, as a view."""
        return self.mapped(lambda array: array[samples])

    def one(self, sample: int, index: int) -> Equilibrium:
        """Return a sample as an equilibrium at position `index`."""
        names, train = self.names, self.names.train
        torques = zip(train.shafts, self.shaft_torque[sample].tolist(), strict=True)
        forces = zip(train.gears, self.support_force[sample], strict=True)
        elastic = (not math.isinf(s.stiffness) for s in train.shafts.values())
        moving = (g.support is not None for g in train.gears.values())
        return Equilibrium(
            index=index,
            rotation=dict(zip(names.gears, self.rotation[sample].tolist(), strict=True)),
            displacement=dict(zip(names.gears, self.displacement[sample], strict=True)),
            flank_force=dict(zip(names.flanks, self.flank_force[sample].tolist(), strict=True)),
            ring_force=dict(zip(names.contacts, self.ring_force[sample].tolist(), strict=True)),
            radial_reaction=dict(
                zip((n for n, _ in names.radials), self.radial_reaction[sample], strict=True)
            ),
            shaft_torque=dict(compress(torques, elastic)),
            support_force=dict(compress(forces, moving)),
        )

    @classmethod
    def empty(cls, train: Train, count: int) -> Equilibria:
        """Return arrays for the answers of `count` samples, filled with NaN."""
        names = Names(train)
        gears = len(names.gears)

        def room(*shape: int) -> Array:
            return np.full((count, *shape), np.nan)

        return cls(
            names,
            room(gears),
            room(gears, 3),
            room(len(names.flanks)),
            room(len(names.contacts)),
            room(len(names.radials), 3),
            room(len(train.shafts)),
            room(gears, 2),
        )

    @classmethod
    def of(cls, train: Train, answer: Equilibrium) -> Equilibria:
        """Return a batch with an equilibrium as its only sample."""
        alone = cls.empty(train, 1)
        alone.put(0, answer)
        return alone

    def forget(self, sample: int) -> None:
        """Set all numbers of a sample to NaN."""
        for array in self.arrays:
            array[sample] = np.nan

    def put_all(self, samples: Numbers, answers: Equilibria) -> None:
        """Overwrite some of the samples with answers."""
        for here, others in zip(self.arrays, answers.arrays, strict=True):
            here[samples] = others

    def put(self, sample: int, answer: Equilibrium) -> None:
        """Overwrite a sample with an equilibrium."""
        names, train = self.names, self.names.train
        self.rotation[sample] = [answer.rotation[g] for g in names.gears]
        self.displacement[sample] = [answer.displacement[g] for g in names.gears]
        self.flank_force[sample] = [answer.flank_force[f] for f in names.flanks]
        self.ring_force[sample] = [answer.ring_force[c] for c in names.contacts]
        for j, (name, _) in enumerate(names.radials):
            self.radial_reaction[sample, j] = answer.radial_reaction[name]
        torque, force = carried(train, answer)
        self.shaft_torque[sample] = [torque.get(name, 0.0) for name in train.shafts]
        self.support_force[sample] = [force.get(name, (0.0, 0.0)) for name in train.gears]


def carried(train: Train, answer: Equilibrium) -> tuple[dict[str, float], dict[str, Array]]:
    """Return torques of elastic shafts [N·m] and forces of bearings that can yield [N].

    Those that the answer does not claim follow from its displacements.
    """
    phi, torque, force = answer.rotation, {}, {}
    for name, shaft in train.shafts.items():
        if not math.isinf(shaft.stiffness):
            wind = phi[shaft.first] - phi[shaft.second] - shaft.clocking
            torque[name] = float(answer.shaft_torque.get(name, shaft.stiffness * wind))
    for name, gear in train.gears.items():
        if gear.support is not None:
            moved = gear.frame @ np.asarray(answer.displacement[name])
            force[name] = answer.support_force.get(name, gear.support * moved)
    return torque, force


CLAIMED = tuple(f.name for f in fields(Equilibria) if f.name != "names")
"""Names of the arrays of an answer."""
