"""Trains whose planets are placed anew at every position, since their surroundings are uneven.

If whatever holds a planetary set is the same in all directions, the set is described in the frame
of its carrier, where only errors and loads differ between positions. Otherwise the planets are
placed where the carrier has taken them, in the frame of the housing. Components along a gear's
`plane` are in the frame of the carrier either way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar
from weakref import WeakKeyDictionary

from loadshare.train.gear import Gear
from loadshare.train.mesh import Mesh
from loadshare.train.offset import turned_about
from loadshare.train.ring import DrumRing, RoundRing
from loadshare.train.seen import seen_from
from loadshare.train.train import Train

Limit = TypeVar("Limit", bound=DrumRing | RoundRing)


def train_at(train: Train, index: int) -> Train:
    """Return the train whose mechanics hold at position `index` (1-based).

    This is the train itself or, if its surroundings are uneven, the train with its planets placed.
    """
    if not train.is_placed_anew:
        return train
    # Kept no longer than the train itself: one of many samples holds large arrays.
    known = _known.setdefault(train, {})
    if index not in known:
        known[index] = _placed(train, index)
    return known[index]


_known: WeakKeyDictionary[Train, dict[int, Train]] = WeakKeyDictionary()


def _placed(train: Train, index: int) -> Train:
    rotation = train.rotations(index)
    angle = {name: train.frame_angle(name, rotation) for name in train.gears}
    gears = {name: _gear(gear, train.gears, angle[name]) for name, gear in train.gears.items()}

    def shifted(limit: Limit) -> Limit:
        if not isinstance(limit, RoundRing):
            return limit
        gear = train.gears[limit.gear]
        turned = 0.0 if gear.carrier is None else angle[limit.gear]
        return replace(limit, offset=turned_about(gear, limit.offset, turned))

    return replace(
        train,
        gears=gears,
        meshes={name: _mesh(mesh, train.gears, angle) for name, mesh in train.meshes.items()},
        rings={name: shifted(ring) for name, ring in train.rings.items()},
        bearings={name: shifted(bearing) for name, bearing in train.bearings.items()},
        placed=index,
    )


def _gear(gear: Gear, gears: Mapping[str, Gear], angle: float) -> Gear:
    if gear.carrier is None:
        # A harmonic of a rim turns n times as far as its rim.
        return replace(gear, seen_at=angle * (gear.harmonic or 1))
    hub = gears[gear.carrier].centre
    placed = replace(
        gear,
        seen_at=angle,
        centre=hub + turned_about(gear, gear.centre - hub, angle),
        pin_motion=turned_about(gear, gear.pin_motion, angle),
    )
    same = not gear.is_tilted
    frame = placed.plane if same else turned_about(gear, gear.frame, angle)
    return replace(placed, frame=frame)


def _mesh(mesh: Mesh, gears: Mapping[str, Gear], angle: Mapping[str, float]) -> Mesh:
    carrier = seen_from(gears, mesh.driver, mesh.driven)
    if carrier is None:
        return mesh
    hub, turned = gears[carrier], angle[carrier]
    return replace(
        mesh,
        drive_normal=turned_about(hub, mesh.drive_normal, turned),
        coast_normal=turned_about(hub, mesh.coast_normal, turned),
    )
