"""From a train and a position to its scene."""

from __future__ import annotations

import math

import numpy as np

from loadshare.contact.law import RIGID, Law, PowerLaw
from loadshare.contact.problem import ArcRow, Array, FollowingLaw, Row
from loadshare.contact.radial import round_ring_law
from loadshare.scene.coordinates import Coordinates, coordinates_of
from loadshare.scene.scene import GearRadial, Scene
from loadshare.train.memory import SlipFriction, SlipStop
from loadshare.train.ring import DrumRing
from loadshare.train.situations import Situations, situation_of
from loadshare.train.train import Train


def assemble(train: Train, index: int) -> Scene:
    """Assemble the scene of position `index` (1-based) of a train."""
    situation = situation_of(train, index)
    at = coordinates_of(train)
    stiffness, load = _linear_part(train, situation, at)
    return Scene(
        train=train,
        situation=situation,
        coordinates=at.names,
        stiffness=stiffness,
        load=load,
        rows=(*_flanks(train, situation, at), *_stops(train, at)),
        arcs=_arcs(train, situation, at),
        radials=(*_round_rings(train, at), *_splines(train, at)),
        rotation=at.rotation,
        displacement=at.displacement,
        removed=(*at.removed, *_idle(train)),
    )


def _idle(train: Train) -> list[tuple[str, str]]:
    """Contacts and forces that never become a row, and why."""
    flanks = [m.flank_name(False) for m in train.meshes.values() if math.isinf(m.backlash)]
    frictions = [f"{s.name} friction" for s in train.splines.values() if s.friction_force == 0.0]
    return [
        *((name, "no backlash given: the flank cannot touch") for name in flanks),
        *((name, "its bound is zero") for name in frictions),
    ]


def _linear_part(train: Train, situation: Situations, at: Coordinates) -> tuple[Array, Array]:
    """H from elastic shafts and supports, f from external torques and clocking."""
    stiffness, load = np.zeros((at.size, at.size)), np.zeros(at.size)
    for gear, torque in situation.torques.items():
        r = at.rotation[gear]
        if r.index is not None:
            load[r.index] += torque * r.rate
    for shaft in train.shafts.values():
        if math.isinf(shaft.stiffness):
            continue
        a, b = at.rotation[shaft.first], at.rotation[shaft.second]
        wind = np.zeros(at.size)
        for end, sign in ((a, 1.0), (b, -1.0)):
            if end.index is not None:
                wind[end.index] += sign * end.rate
        preset = shaft.clocking - a.constant + b.constant
        stiffness += shaft.stiffness * np.outer(wind, wind)
        load += shaft.stiffness * preset * wind
    for name, where in at.displacement.items():
        support = train.gears[name].support
        if support is not None:
            stiffness[where, where] += np.diag(support)
    for gear, where in at.slip.items():
        bent = at.components(at.displacement[gear]) - at.components(where)
        stiffness += train.splines[gear].bending_stiffness * bent.T @ bent
    return stiffness, load


def _flanks(train: Train, situation: Situations, at: Coordinates) -> list[Row]:
    """Rows of all flanks that can touch."""
    rows = []
    positions = train.mesh_positions(situation.position)
    for mesh in train.meshes.values():
        position = positions[mesh.name]
        relative = at.moved(mesh.driver) - at.moved(mesh.driven)
        errors = situation.offset_of(mesh.driver) - situation.offset_of(mesh.driven)
        constants = (at.rotation[mesh.driver].constant, at.rotation[mesh.driven].constant)
        for drive in mesh.flanks:
            on_driver, on_driven, normal = mesh.direction(drive)
            vector = normal @ relative
            for gear, arm in ((mesh.driver, on_driver), (mesh.driven, on_driven)):
                r = at.rotation[gear]
                if r.index is not None:
                    vector[r.index] += arm * r.rate
            at_rest = mesh.approach(drive, position, constants, errors)
            kind = "drive flank" if drive else "coast flank"
            name = mesh.flank_name(drive)
            rows.append(Row(name, kind, vector, -at_rest, mesh.law(position)))
    return rows


def _arcs(train: Train, situation: Situations, at: Coordinates) -> tuple[ArcRow, ...]:
    """Exclusion arcs of all drums."""
    arcs = []
    for ring in train.drums:
        for side, neighbour in enumerate(ring.neighbours):
            relative = at.moved(ring.gear) - at.moved(neighbour)
            arc = situation.arc(ring, side)
            sagitta = max(ring.up, ring.down) ** 2 / (2.0 * arc.distance)
            arcs.append(ArcRow(ring.arc_name(neighbour), arc, relative, _wall(ring), sagitta))
    return tuple(arcs)


def _stops(train: Train, at: Coordinates) -> list[Row]:
    """Radial stops of all drums."""
    rows = []
    for ring in train.drums:
        across = ring.across @ at.moved(ring.gear)
        upper, lower = ring.stop_names
        rows.append(Row(upper, "stop", across, ring.up, _wall(ring)))
        rows.append(Row(lower, "stop", -across, ring.down, _wall(ring)))
    return rows


def _wall(ring: DrumRing) -> Law:
    return RIGID if math.isinf(ring.stiffness) else PowerLaw(1.0 / ring.stiffness)


def _round_rings(train: Train, at: Coordinates) -> list[GearRadial]:
    """Round rings as radial elements."""
    found = []
    for ring in train.rounds:
        moved = at.components(at.displacement[ring.gear])
        centre = train.gears[ring.gear].frame @ ring.offset
        law = round_ring_law(ring.radius, ring.stiffness)
        found.append(GearRadial(ring.name, moved, centre, law, gear=ring.gear))
    return found


def _splines(train: Train, at: Coordinates) -> list[GearRadial]:
    """Splines as radial elements: whole, or with memory as friction and clearance of their slip."""
    found: list[GearRadial] = []
    origin = np.zeros(2)
    for gear, spline in train.splines.items():
        parts: list[tuple[str, Array, Array, FollowingLaw]]
        if train.slip is None:
            parts = [(spline.name, at.components(at.displacement[gear]), origin, spline)]
        else:
            slipped = at.components(at.slip[gear])
            before = train.gears[gear].frame @ train.slip[gear]
            parts = [
                (spline.name, slipped, before, SlipFriction(spline)),
                (spline.stop_name, slipped, origin, SlipStop(spline)),
            ]
        levers = train.levers(gear)
        found += [GearRadial(*part, levers, gear=gear) for part in parts]
    return found
