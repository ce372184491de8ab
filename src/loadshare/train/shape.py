"""The shape of a train: all that its numbers do not change. Trains of one shape share a machine.

All that is computed once per machine (directions, statics of active sets, rows of the certificate)
follows from the geometry and from which elements there are. Loads, errors, clearances, gaps and
compliances may differ from train to train as they do from sample to sample.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from loadshare.contact.law import PowerLaw
from loadshare.train.elements import Shaft, Spline
from loadshare.train.gear import Gear
from loadshare.train.mesh import Mesh
from loadshare.train.ring import Bearing, DrumRing, Ring
from loadshare.train.situations import situation_of
from loadshare.train.train import Train


def shape_of(train: Train) -> Hashable:
    """Return what trains must have in common to share all that is computed once per machine.

    Parameters
    ----------
    train : Train
        Without arrays of samples.
    """
    return (
        tuple(map(_gear, train.gears.values())),
        tuple(map(_mesh, train.meshes.values())),
        tuple(map(_shaft, train.shafts.values())),
        tuple(map(_spline, train.splines.values())),
        tuple(map(_ring, (*train.rings.values(), *train.bearings.values()))),
        tuple(_arcs(train)),
        tuple(train.offsets),
        train.stages,
        (train.input, train.output, tuple(train.external), tuple(train.forces)),
        tuple(np.sign(train.input_torque).tolist()),
        (train.positions, train.count, train.rotating, train.march),
        (train.slip is None, train.uneven, train.placed),
        tuple((train.held_at or {}).items()),
    )


# Trains that differ in a few numbers have the other elements in common.
@lru_cache(maxsize=1024)
def _gear(gear: Gear) -> tuple[Any, ...]:
    kept = (gear.name, gear.kind, gear.base_radius, gear.sense, gear.teeth, gear.ratio)
    seen = (gear.relative, gear.held, gear.carrier, gear.frame_of, gear.seen_at)
    rim = (gear.rim_of, gear.harmonic)
    places = (gear.centre, gear.axis, gear.frame, gear.pin_motion)
    return (*kept, *seen, *rim, *map(_bytes, places), _pattern(gear.support))


@lru_cache(maxsize=1024)
def _mesh(mesh: Mesh) -> tuple[Any, ...]:
    kept = (
        mesh.name,
        mesh.driver,
        mesh.driven,
        mesh.radii,
        mesh.named_backwards,
        mesh.flank_uncertain,
        mesh.senses,
    )
    places = (mesh.phase, mesh.coast_phase, mesh.averaged, len(mesh.gaps), len(mesh.coast_gaps))
    flanks = (_bytes(mesh.drive_normal), _bytes(mesh.coast_normal), math.isinf(mesh.backlash))
    laws = tuple(
        (law.b > 0.0, law.c > 0.0) if isinstance(law, PowerLaw) else law for law in mesh.laws
    )
    return (*kept, *places, *flanks, laws)


def _shaft(shaft: Shaft) -> tuple[Any, ...]:
    return shaft.name, shaft.first, shaft.second, math.isinf(shaft.stiffness)


def _spline(spline: Spline) -> tuple[Any, ...]:
    given = (spline.stick_limit is None, spline.friction_force is None)
    play = (spline.clearance > 0.0, spline.friction_force == 0.0, spline.friction_per_torque > 0.0)
    return (spline.gear, math.isinf(spline.bending_stiffness), *given, *play)


def _ring(ring: Ring) -> tuple[Any, ...]:
    rigid = math.isinf(ring.stiffness)
    if isinstance(ring, DrumRing):
        play = tuple(p > 0.0 for p in (*ring.clearances, ring.up, ring.down))
        drum = (ring.neighbours, _bytes(ring.across), rigid, ring.with_errors)
        return (ring.gear, *drum, *play)
    round_ = (rigid, ring.power, ring.radius > 0.0)
    return (ring.gear, isinstance(ring, Bearing), *round_)


def _arcs(train: Train) -> Iterator[bytes]:
    """Yield how errors shift the arcs at rest: directions in the statics follow from it."""
    if any(ring.with_errors for ring in train.drums):
        yield _bytes(situation_of(train, train.placed or 1).arc_shift)


def _pattern(support: Any) -> bytes | None:
    return None if support is None else _bytes(support > 0.0)


def _bytes(array: Any) -> bytes:
    return bytes(np.asarray(array).tobytes())
