"""Turn a structure and its loading into a scene in SI: the same rows, gaps and laws, one by one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from loadshare.contact.law import Law, PowerLaw, TableLaw
from loadshare.contact.problem import ArcRow, FollowingLaw, Row
from loadshare.contact.radial import RadialLaw, RollingLaw, round_ring_law
from loadshare.scene.loading import Loading, loading_of
from loadshare.scene.scene import GearRadial, Scene
from loadshare.scene.structure import ArcElement, RadialElement, Structure, structure_of
from loadshare.train.elements import Spline
from loadshare.train.memory import SlipFriction, SlipStop
from loadshare.train.placed import train_at
from loadshare.train.situations import Situations, situation_of
from loadshare.train.train import Train


def assemble(train: Train, index: int) -> Scene:
    """Assemble the scene of position `index` (1-based) of a train."""
    train = train_at(train, index)
    return scene_of(structure_of(train), situation_of(train, index))


def scene_of(structure: Structure, situation: Situations, loading: Loading | None = None) -> Scene:
    """Assemble the scene of a single sample.

    Parameters
    ----------
    structure : Structure
    situation : Situations
        The situation of one sample.
    loading : Loading, optional
        Its loading, if it has been computed already.
    """
    loading = loading or loading_of(structure, situation)
    columns, vectors = structure.columns, structure.vectors
    force, length = structure.force, structure.length
    gap, springs = loading.gap[0] * length, vectors[columns.springs]
    stiffness = force / length / loading.bending[0, columns.springs]
    laws = [_law(structure, loading, column) for column in range(len(structure.names))]
    rows = range(columns.flat.start, columns.flat.stop)
    levers, turned = structure.train.levers, structure.turned(situation)[0].tolist()
    centres = structure.centres(situation)[0]
    return Scene(
        train=structure.train,
        situation=situation,
        coordinates=structure.coordinates.names,
        springs=springs,
        stiffness=springs.T * stiffness @ springs,
        load=loading.load[0] * force + springs.T @ (stiffness * gap[columns.springs]),
        rows=tuple(
            Row(structure.names[k], structure.kinds[k], vectors[k], float(gap[k]), laws[k])
            for k in rows
        ),
        arcs=tuple(
            _arc(situation, arc, law)
            for arc, law in zip(structure.arcs, laws[columns.arcs], strict=True)
        ),
        radials=tuple(
            GearRadial(
                r.name,
                r.matrix,
                centre,
                source := _source(structure, situation, r, float(faint) * force),
                {} if isinstance(source, RadialLaw | RollingLaw) else levers(r.gear),
                gear=r.gear,
            )
            for r, centre, faint in zip(
                structure.radials, centres, loading.radial[0, :, 7], strict=True
            )
        ),
        rotation=structure.coordinates.rotation,
        turned=dict(zip(structure.train.gears, turned, strict=True)),
        displacement=structure.coordinates.displacement,
        removed=structure.removed,
    )


def _law(structure: Structure, loading: Loading, column: int) -> Law:
    """Return the law of a spring or contact, in SI."""
    force, length = structure.force, structure.length
    m = loading.tabulated[column]
    if m >= 0:
        points = loading.tables[0, m] * np.array([[force], [length]])
        forces, compressions = points[:, np.isfinite(points[0])].tolist()
        return TableLaw(tuple(forces), tuple(compressions))
    b, c = float(loading.bending[0, column]), float(loading.hertz[0, column])
    return PowerLaw(b * length / force, c * length / math.cbrt(force) ** 2)


def _arc(situation: Situations, element: ArcElement, law: Law) -> ArcRow:
    arc = situation.arc(element.ring, element.side)
    sagitta = float(situation.stop[0, element.drum].max()) ** 2 / (2.0 * arc.distance)
    return ArcRow(element.name, arc, element.relative, law, sagitta)


def _source(
    structure: Structure, here: Situations, radial: RadialElement, faint: float
) -> RadialLaw | RollingLaw | FollowingLaw:
    """Return the law of a radial element, or the object from which it follows.

    A wall with a power is taken to begin at the force `faint` [N].
    """
    k, train = radial.number, structure.train
    if radial.kind == "ring":
        arrays = here.round_radius, here.round_stiffness, here.round_power
        reach, stiffness, power = (float(v[0, k]) for v in arrays)
        if power != 1.0:
            return RollingLaw(reach, stiffness, power, faint)
        return round_ring_law(reach, stiffness)
    spline = _spline(train.splines[radial.gear], *here.spline[0, k].tolist())
    parts: dict[str, FollowingLaw] = {
        "spline": spline,
        "friction": SlipFriction(spline),
        "clearance": SlipStop(spline),
    }
    return parts[radial.kind]


def _spline(
    spline: Spline, stiffness: float, stick: float, reach: float, bound: float, rate: float
) -> Spline:
    """Return a spline with its numbers in a sample."""
    return replace(
        spline,
        bending_stiffness=stiffness,
        stick_limit=None if math.isnan(stick) else stick,
        clearance=reach,
        friction_force=None if math.isnan(bound) else bound,
        friction_per_torque=rate,
    )
