"""The mechanics of a train, written down once for all answers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property, lru_cache

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.certify.rigid import rigid_shafts
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Names
from loadshare.train.gear import cross
from loadshare.train.ring import transverse
from loadshare.train.train import Train


class Mechanics:
    """Which elements of a train act on which gears, and along which directions.

    Contacts are all flanks, then for every drum its two arcs, its upper and its lower stop. Radial
    elements are in the order of claims.

    Parameters
    ----------
    train : Train

    Attributes
    ----------
    order : dict of gear to int
    radius : ndarray, shape (gears,)
        Base radii [m].
    flanks : list of (Mesh, bool)
        Mesh, drive or coast flank.
    mesh_of, is_drive : ndarray, shape (flanks,)
        Number of the mesh; whether it is its drive flank.
    turning : ndarray, shape (flanks, gears)
        Approach per rotation [m].
    pushing : ndarray, shape (flanks, 3 gears)
        Approach per displacement; a flank's force on a gear is the negative of it.
    moment : ndarray, shape (gears, flanks)
        Moment per force [m].
    tabled : list of int
        Flanks with a tabulated law.
    groups : list of list of int
        Gears that turn as one.
    beyond : ndarray, shape (shafts, gears)
        Torque of every rigid shaft per moment on the gears beyond it (see `RigidShafts`).
    shaft : ndarray, shape (shafts, 2)
        Its first and its second gear.
    elastic : ndarray of int
        Shafts that yield.
    moving : ndarray of int
        Gears that can be displaced.
    frames : ndarray, shape (moving, 2, 3)
        Their transverse frames.
    drum : ndarray, shape (drums,)
        Gear of every drum.
    neighbours : ndarray, shape (drums, 2)
    across : ndarray, shape (drums, 3)
    nominal : ndarray, shape (drums, 2, 3)
        Vector to the gear's nominal centre from each neighbour's, across the gear's axis [m].
    distance : ndarray, shape (drums, 2)
        Length of it [m].
    squeezed : ndarray of int
        Drums with rigid arcs on neighbours that cannot move.
    pulled : ndarray, shape (radials,)
        Gear of every radial element.
    pulls : tuple of str
        Names of the radial elements.
    claims : Names
        Order of what is claimed.
    gears, gear_names, bearings, bearing_names, turning_gears, squeezed_names : tuple of str
        Names of all gears, plain and as elements; of those that can be displaced, and of their
        bearings; of the first gear of every group that turns; of the arcs of drums in `squeezed`.
    """

    def __init__(self, train: Train) -> None:
        self.train = train
        gears = list(train.gears.values())
        self.order = {g.name: k for k, g in enumerate(gears)}
        self.radius = np.array([g.base_radius for g in gears])
        self.moving: Numbers = np.flatnonzero([g.moves for g in gears])
        self.frames = np.array([g.frame for g in gears if g.moves]).reshape(-1, 2, 3)
        self._put_flanks()
        self._put_shafts()
        self._put_drums()
        self._put_radials()
        self._put_names()

    def _put_flanks(self) -> None:
        train, order, count = self.train, self.order, len(self.order)
        meshes = list(train.meshes.values())
        self.flanks = [(m, d) for m in meshes for d in m.flanks]
        self.mesh_of = np.array([k for k, m in enumerate(meshes) for _ in m.flanks], dtype=np.intp)
        self.is_drive = np.array([d for _, d in self.flanks], dtype=bool)
        self.tabled = [e for e, (m, _) in enumerate(self.flanks) if hasattr(m.laws[0], "forces")]
        width = len(self.flanks)
        self.turning, pushing = np.zeros((width, count)), np.zeros((width, count, 3))
        self.moment = np.zeros((count, width))
        for e, (mesh, drive) in enumerate(self.flanks):
            driver, driven = order[mesh.driver], order[mesh.driven]
            on_driver, on_driven, normal = mesh.direction(drive)
            self.turning[e, driver] += on_driver
            self.turning[e, driven] += on_driven
            pushing[e, driver] += normal
            pushing[e, driven] -= normal
            along = 1.0 if drive else -1.0
            self.moment[driver, e] -= along * mesh.senses[0] * mesh.radii[0]
            self.moment[driven, e] += along * mesh.senses[1] * mesh.radii[1]
            for end, push in ((mesh.driver, -normal), (mesh.driven, normal)):
                # A pin passes the flank's force on to the carrier, with its arm about the axis.
                if (carrier := train.gears[end].carrier) is not None:
                    held, arm = train.gears[carrier], train.gears[end].centre
                    arm = transverse(arm - held.centre, held.axis)
                    moment = held.sense * float(held.axis @ cross(arm, push))
                    self.moment[order[carrier], e] += moment
                    self.turning[e, order[carrier]] -= moment
                    pushing[e, order[carrier]] -= push
            for end, other, push in (
                (mesh.driver, mesh.driven, normal),
                (mesh.driven, mesh.driver, -normal),
            ):
                way = train.gears[other].centre - train.gears[end].centre
                for name, bends in _bending(train, end, way, push):
                    pushing[e, order[name]] += bends
        self.pushing = pushing.reshape(width, 3 * count)

    def _put_shafts(self) -> None:
        train, order = self.train, self.order
        rigid, shafts = rigid_shafts(train), list(train.shafts.values())
        self.groups = [[order[g] for g in group] for group in rigid.paths]
        self.shaft = pairs([(order[s.first], order[s.second]) for s in shafts])
        self.elastic: Numbers = np.flatnonzero([not math.isinf(s.stiffness) for s in shafts])
        self.beyond = np.zeros((len(shafts), len(order)))
        for w, shaft in enumerate(shafts):
            for gear, sign in rigid.beyond.get(shaft.name, {}).items():
                self.beyond[w, order[gear]] = sign

    def _put_drums(self) -> None:
        train, order, drums = self.train, self.order, self.train.drums
        self.drum = np.array([order[r.gear] for r in drums], dtype=np.intp)
        self.neighbours = pairs([[order[n] for n in r.neighbours] for r in drums])
        self.across = np.array([r.across for r in drums]).reshape(-1, 3)
        self.nominal = arms_of_drums(train)
        self.distance = np.sqrt((self.nominal**2).sum(axis=2))
        self.squeezed = np.flatnonzero(
            [
                math.isinf(r.stiffness) and not any(train.gears[n].moves for n in r.neighbours)
                for r in drums
            ]
        )

    def _put_radials(self) -> None:
        self.claims = Names(self.train)
        self.pulls = tuple(name for name, _ in self.claims.radials)
        self.pulled = np.array([self.order[gear] for _, gear in self.claims.radials], dtype=np.intp)

    def _put_names(self) -> None:
        self.gears = tuple(self.order)
        self.gear_names = tuple(f"gear {g}" for g in self.gears)
        self.bearings = tuple(self.gears[g] for g in self.moving)
        self.bearing_names = tuple(f"bearing {g}" for g in self.bearings)
        self.turning_gears = tuple(self.gears[group[0]] for group in self.turning_groups)
        squeezed = (self.train.drums[d].gear for d in self.squeezed)
        self.squeezed_names = tuple(f"ring {gear}: arcs" for gear in squeezed)

    def loaded(self, push: Array) -> tuple[Array, Array]:
        """Return moments [N·m] and forces [N] of external forces, (gears, S) and (gears, 3, S).

        A pin passes the force on its planet on to the carrier, with its arm about the axis.
        """
        moment, force = np.zeros((len(push), push.shape[2])), push.copy()
        for name, gear in self.train.gears.items():
            if gear.carrier is None:
                continue
            held, k, c = self.train.gears[gear.carrier], self.order[name], self.order[gear.carrier]
            arm = transverse(gear.centre - held.centre, held.axis)
            moment[c] += held.sense * (cross(held.axis, arm) @ push[k])
            force[c] += push[k]
        return moment, force

    @cached_property
    def bearing_pushing(self) -> Array:
        """Approach of flanks per displacement in the frames, shape (2 moving, flanks)."""
        pushing = self.pushing.reshape(-1, len(self.order), 3)[:, self.moving]
        along = np.einsum("mak,emk->mae", self.frames, pushing)
        return np.ascontiguousarray(along.reshape(2 * len(self.moving), -1))

    @cached_property
    def shaft_moment(self) -> Array:
        """Moment on gears per torque of the shafts that yield, shape (gears, shafts)."""
        moment = np.zeros((len(self.order), len(self.shaft)))
        for w in self.elastic:
            moment[self.shaft[w, 0], w] -= 1.0
            moment[self.shaft[w, 1], w] += 1.0
        return moment

    @cached_property
    def group_moment(self) -> Array:
        """Force at a group's largest base radius per moment [1/m], (turning groups, gears)."""
        found = np.zeros((len(self.turning_groups), len(self.order)))
        for k, group in enumerate(self.turning_groups):
            found[k, group] = 1.0 / self.radius[group].max()
        return found

    @cached_property
    def turning_groups(self) -> list[list[int]]:
        """Groups without a held gear."""
        held = set(self.held)
        return [group for group in self.groups if not held & set(group)]

    @cached_property
    def held(self) -> list[int]:
        """Gears that do not turn."""
        return [self.order[gear] for gear in self.train.held]

    @cached_property
    def lift(self) -> Array:
        """Projectors on the displacements that bearings forbid, shape (gears, 3, 3)."""
        found = np.broadcast_to(np.eye(3), (len(self.order), 3, 3)).copy()
        found[self.moving] -= np.einsum("mak,mal->mkl", self.frames, self.frames)
        return found

    @cached_property
    def spline_moment(self) -> Array:
        """Torque that each spline transmits to its gear per flank force [m], (splines, flanks)."""
        return -self.moment[[self.order[g] for g in self.train.splines]]

    @cached_property
    def contacts(self) -> tuple[str, ...]:
        """Names of all contacts."""
        flanks = (m.flank_name(d) for m, d in self.flanks)
        drums = self.train.drums
        return (
            *flanks,
            *(n for r in drums for n in (*map(r.arc_name, r.neighbours), *r.stop_names)),
        )


@lru_cache(maxsize=CERTIFY.trains)
def mechanics_of(train: Train) -> Mechanics:
    """Return the mechanics of a train; built once."""
    return Mechanics(train)


@lru_cache(maxsize=CERTIFY.trains)
def arms_of_drums(train: Train) -> Array:
    """Return the vectors to drums from both neighbours, as `nominal` in `Mechanics`."""
    apart = [[_apart(train, r.gear, n) for n in r.neighbours] for r in train.drums]
    return np.array(apart).reshape(-1, 2, 3)


def pairs(values: Sequence[object]) -> Numbers:
    """Return pairs of numbers as an array (k, 2), also where there are none."""
    return np.array(values, dtype=np.intp).reshape(-1, 2)


def _bending(train: Train, gear: str, way: Array, push: Array) -> Iterator[tuple[str, Array]]:
    """Yield the harmonics of a gear's rim, and the part of a push on it that does work on each.

    The rim moves outwards by cos nψ and along the circumference by −(sin nψ)/n, and likewise a
    quarter of a wave further on.
    """
    for name, rim in train.gears.items():
        if rim.rim_of != gear:
            continue
        out = transverse(way, rim.axis) / np.linalg.norm(transverse(way, rim.axis))
        ahead = cross(rim.axis, out)
        turn = (rim.frame[0] @ out + 1j * (rim.frame[1] @ out)) ** rim.harmonic
        moved = out * turn + 1j * ahead * turn / rim.harmonic
        yield name, (push @ moved.real) * rim.frame[0] + (push @ moved.imag) * rim.frame[1]


def _apart(train: Train, gear: str, neighbour: str) -> Array:
    """Return the vector from a neighbour's nominal centre, across the gear's axis (3,) [m]."""
    here = train.gears[gear]
    return transverse(here.centre - train.gears[neighbour].centre, here.axis)
