"""From a train and a position to its scene."""

from __future__ import annotations

import math

import numpy as np

from loadshare.scene.scene import ArcRow, Array, Radial, Rotation, Row, Scene
from loadshare.train.law import RIGID, Law, PowerLaw
from loadshare.train.memory import SlipFriction, SlipStop
from loadshare.train.radial import round_ring_law
from loadshare.train.ring import DrumRing, RoundRing
from loadshare.train.train import Situation, Train


def assemble(train: Train, index: int) -> Scene:
    """Assemble the scene of position `index` (1-based) of a train."""
    situation = train.situation(index)
    coordinates: list[str] = []
    removed: list[tuple[str, str]] = []
    rotation = _rotations(train, coordinates, removed)
    displacement: dict[str, slice] = {}
    for name, gear in train.gears.items():
        if gear.moves:
            start = len(coordinates)
            displacement[name] = slice(start, start + 2)
            coordinates += [f"gear {name} x", f"gear {name} y"]
        else:
            removed.append((f"gear {name} x, y", "its bearing is rigid"))
    slip = _slips(train, coordinates)
    size = len(coordinates)
    stiffness, load = _linear_part(train, situation, rotation, displacement, size)
    moved = {n: train.gears[n].frame.T @ np.eye(size)[w] for n, w in displacement.items()}
    none = np.zeros((3, size))
    arcs, rows, radials = _rings(train, situation, moved, displacement, size)
    removed += [
        (mesh.flank_name(False), "no backlash given: the flank cannot touch")
        for mesh in train.meshes.values()
        if math.isinf(mesh.backlash)
    ]
    removed += [
        (f"{spline.name} friction", "its bound is zero")
        for spline in train.splines.values()
        if spline.friction_force == 0.0
    ]
    scene_rows = (*_flanks(train, situation, rotation, moved, none, size), *rows)
    radials += _splines(train, displacement, slip, stiffness, size)
    return Scene(
        train=train,
        situation=situation,
        coordinates=tuple(coordinates),
        stiffness=stiffness,
        load=load,
        rows=scene_rows,
        arcs=tuple(arcs),
        radials=tuple(radials),
        rotation=rotation,
        displacement=displacement,
        removed=tuple(removed),
    )


def _slips(train: Train, coordinates: list[str]) -> dict[str, slice]:
    """Two coordinates for the slip of every spline that remembers it."""
    found = {}
    for gear in train.splines if train.slip is not None else ():
        found[gear] = slice(len(coordinates), len(coordinates) + 2)
        coordinates += [f"spline {gear} slip x", f"spline {gear} slip y"]
    return found


def _splines(
    train: Train,
    displacement: dict[str, slice],
    slip: dict[str, slice],
    stiffness: Array,
    size: int,
) -> list[Radial]:
    """Radial elements of the splines; with memory the shaft's bending goes into H, in place."""
    found = []
    for gear, spline in train.splines.items():
        moved = np.eye(size)[displacement[gear]]
        if train.slip is None:
            found.append(Radial(spline.name, gear, moved, np.zeros(2), spline))
            continue
        slipped = np.eye(size)[slip[gear]]
        bent = moved - slipped
        stiffness += spline.bending_stiffness * bent.T @ bent
        before = train.gears[gear].frame @ train.slip[gear]
        found.append(Radial(spline.name, gear, slipped, before, SlipFriction(spline)))
        found.append(Radial(spline.stop_name, gear, slipped, np.zeros(2), SlipStop(spline)))
    return found


def _rotations(
    train: Train, coordinates: list[str], removed: list[tuple[str, str]]
) -> dict[str, Rotation]:
    """One rotation coordinate per set of gears on rigid shafts; none for the output's set."""
    offset = {train.output: 0.0}
    sets = {train.output: train.output}
    for seed in (train.output, *train.gears):
        if seed in sets and seed != train.output:
            continue
        sets[seed], offset[seed] = seed, 0.0
        queue = [seed]
        while queue:
            here = queue.pop()
            for shaft in train.shafts.values():
                ends = (shaft.first, shaft.second)
                if not math.isinf(shaft.stiffness) or here not in ends:
                    continue
                forward = here == ends[0]
                other = ends[1] if forward else ends[0]
                lag = -shaft.clocking if forward else shaft.clocking
                if other not in sets:
                    sets[other], offset[other] = seed, offset[here] + lag
                    removed.append((f"gear {other} rotation", f"rigid shaft {shaft.name}"))
                    queue.append(other)
    removed.append((f"gear {train.output} rotation", "the output gear is held"))
    where: dict[str, int] = {}
    for name in train.gears:
        root = sets[name]
        if root not in where and root != train.output:
            where[root] = len(coordinates)
            coordinates.append(f"gear {root} rotation")
    return {
        name: Rotation(where.get(root), 1.0 / train.gears[root].base_radius, offset[name])
        for name, root in sets.items()
    }


def _linear_part(
    train: Train,
    situation: Situation,
    rotation: dict[str, Rotation],
    displacement: dict[str, slice],
    size: int,
) -> tuple[Array, Array]:
    """H from elastic shafts and supports, f from external torques and clocking."""
    stiffness, load = np.zeros((size, size)), np.zeros(size)
    for gear, torque in situation.torque.items():
        r = rotation[gear]
        if r.index is not None:
            load[r.index] += torque * r.rate
    for shaft in train.shafts.values():
        if math.isinf(shaft.stiffness):
            continue
        a, b = rotation[shaft.first], rotation[shaft.second]
        wind = np.zeros(size)
        for end, sign in ((a, 1.0), (b, -1.0)):
            if end.index is not None:
                wind[end.index] += sign * end.rate
        preset = shaft.clocking - a.constant + b.constant
        stiffness += shaft.stiffness * np.outer(wind, wind)
        load += shaft.stiffness * preset * wind
    for name, where in displacement.items():
        support = train.gears[name].support
        if support is not None:
            stiffness[where, where] += np.diag(support)
    return stiffness, load


def _flanks(
    train: Train,
    situation: Situation,
    rotation: dict[str, Rotation],
    moved: dict[str, Array],
    none: Array,
    size: int,
) -> list[Row]:
    """Rows of all flanks that can touch."""
    rows = []
    for mesh in train.meshes.values():
        position = situation.mesh_position[mesh.name]
        relative = moved.get(mesh.driver, none) - moved.get(mesh.driven, none)
        errors = situation.offset[mesh.driver] - situation.offset[mesh.driven]
        constants = (rotation[mesh.driver].constant, rotation[mesh.driven].constant)
        for drive in mesh.flanks:
            on_driver, on_driven, normal = mesh.direction(drive)
            vector = normal @ relative
            for gear, arm in ((mesh.driver, on_driver), (mesh.driven, on_driven)):
                r = rotation[gear]
                if r.index is not None:
                    vector[r.index] += arm * r.rate
            at_rest = mesh.approach(drive, position, constants, errors)
            kind = "drive flank" if drive else "coast flank"
            name = mesh.flank_name(drive)
            rows.append(Row(name, kind, vector, -at_rest, mesh.law(position)))
    return rows


def _wall(stiffness: float) -> Law:
    return RIGID if math.isinf(stiffness) else PowerLaw(1.0 / stiffness)


def _rings(
    train: Train,
    situation: Situation,
    moved: dict[str, Array],
    displacement: dict[str, slice],
    size: int,
) -> tuple[list[ArcRow], list[Row], list[Radial]]:
    """Arcs, stops and round rings."""
    arcs: list[ArcRow] = []
    stops: list[Row] = []
    radials: list[Radial] = []
    none = np.zeros((3, size))
    for ring in train.rings.values():
        if isinstance(ring, RoundRing):
            gear = train.gears[ring.gear]
            law = round_ring_law(ring.radius, ring.stiffness)
            matrix = np.eye(size)[displacement[ring.gear]]
            radials.append(Radial(ring.name, ring.gear, matrix, gear.frame @ ring.offset, law))
            continue
        for side, neighbour in enumerate(ring.neighbours):
            relative = moved[ring.gear] - moved.get(neighbour, none)
            arc = train.arc(ring, side, situation)
            sagitta = max(ring.up, ring.down) ** 2 / (2.0 * arc.distance)
            wall = _wall(ring.stiffness)
            arcs.append(ArcRow(ring.arc_name(neighbour), arc, relative, wall, sagitta))
        stops += _stops(ring, ring.across @ moved[ring.gear])
    return arcs, stops, radials


def _stops(ring: DrumRing, across: Array) -> list[Row]:
    upper, lower = ring.stop_names
    wall = _wall(ring.stiffness)
    return [
        Row(upper, "stop", across, ring.up, wall),
        Row(lower, "stop", -across, ring.down, wall),
    ]
