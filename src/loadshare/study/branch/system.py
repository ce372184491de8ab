r"""The equations of a scene on a fixed active set: residual, Jacobian, Newton's method.

Contacts that yield are eliminated by their closed form F(δ), continued oddly beyond δ = 0 so that a
branch can be followed across the point where it ends. Rigid contacts and vertical steps keep their
forces as unknowns. The unknowns z and all residuals are dimensionless.

.. math:: Hx - f + \sum_e a_e(x) F_e + \sum_j P_j^\mathsf{T} \Phi_j = 0

Source: formulation, sections 3 to 6.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from loadshare.contact.problem import ArcRow, Row
from loadshare.scene.scene import Array, GearRadial, Scene
from loadshare.study.branch.active import ActiveSet, Place, index_of, is_rigid, read_set
from loadshare.study.branch.elements import Hold, Touch, pressed, pulled
from loadshare.study.branch.gauges import LOOSE, Gauge, contact_gauges, radial_gauges
from loadshare.study.branch.units import Units
from loadshare.train.equilibrium import Equilibrium

__all__ = ["RANK", "Branch", "BranchLost", "Gauge", "Units", "identified"]

RANK = 1e-14
"""Singular values of the Jacobian below this, relative to the largest, count as zero."""
ROUNDINGS = 4.0
"""Roundings that a term of the residual has behind it: radii, directions, sums."""
SOLVED = 1e-10
"""Residual up to which a branch that no longer improves is an answer, in loads and deflections."""


class BranchLost(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """A branch has no point where it was looked for; the message says why."""


class Branch:
    """A scene on an active set.

    Parameters
    ----------
    scene : Scene
    active : ActiveSet
    units : Units
        Kept fixed along a path, so that z means the same everywhere on it.
    tied : frozenset of str
        Closed contacts that are held as if they were rigid: those that begin to carry under a law
        which is infinitely soft at first (c > 0), where nothing else can.
    """

    def __init__(
        self, scene: Scene, active: ActiveSet, units: Units, tied: frozenset[str] = frozenset()
    ) -> None:
        self.scene, self.active, self.units, self.tied = scene, active, units, tied
        self._contacts: tuple[Row | ArcRow, ...] = (*scene.rows, *scene.arcs)
        self._places = dict(active.places)
        at = scene.size
        self._rigid: dict[str, int] = {}
        for row in self._contacts:
            if row.name in active.closed and (is_rigid(row.law) or row.name in tied):
                self._rigid[row.name] = at
                at += 1
        self._steps: dict[str, slice] = {}
        for radial in scene.radials:
            place = self._places[radial.name]
            if place.corner:
                width = 2 if self._at_centre(radial, place) else 1
                self._steps[radial.name] = slice(at, at + width)
                at += width
        self.size = at

    def _at_centre(self, radial: GearRadial, place: Place) -> bool:
        """Whether a step stands at radius zero; that does not depend on the size of the torque."""
        train = self.scene.train
        ratio = train.gears[radial.gear].ratio or 1.0
        torque = self.scene.situation.torque[train.input] / ratio
        law = radial.law(0.0 if self._idles(radial.gear) else torque)
        k = index_of(law, place)
        return k is not None and law.start(k) == 0.0

    def _transmitted(self, gear: str, flanks: Mapping[str, float]) -> float:
        """Torque [N·m] that reaches a gear over its spline."""
        return 0.0 if self._idles(gear) else self.scene.train.transmitted(gear, flanks)

    def _idles(self, gear: str) -> bool:
        """Whether no shaft and no load turns a gear: its meshes balance, and its spline has none.

        The sum of their torques is round-off then, whose sign says nothing.
        """
        train, loads = self.scene.train, self.scene.situation.torque
        turned = any(gear in (s.first, s.second) for s in train.shafts.values())
        return not turned and gear != train.output and not loads.get(gear, 0.0)

    # --- At a point -----------------------------------------------------------------------------

    def start(self, x: Array, forces: Mapping[str, float], pulls: Mapping[str, Array]) -> Array:
        """Return the unknowns of coordinates [m] and forces [N]."""
        z = np.zeros(self.size)
        z[: self.scene.size] = x / self.units.length
        for name, k in self._rigid.items():
            z[k] = forces.get(name, 0.0) / self.units.force
        for name, where in self._steps.items():
            pull = pulls[name] / self.units.force
            z[where] = pull if where.stop - where.start == 2 else np.linalg.norm(pull)
        return z

    def x(self, z: Array) -> Array:
        """Coordinates [m]."""
        return np.asarray(z[: self.scene.size] * self.units.length)

    def _touches(self, z: Array) -> list[Touch]:
        x = self.x(z)
        touches = []
        for row in self._contacts:
            if isinstance(row, ArcRow):
                relative = row.relative @ x
                vector = -(row.arc.normal(relative) @ row.relative)
                approach = -row.arc.margin(relative)
            else:
                vector, approach = row.vector, float(row.vector @ x) - row.gap
            unknown = self._rigid.get(row.name)
            force = slope = 0.0
            if unknown is not None:
                force = float(z[unknown]) * self.units.force
            elif row.name in self.active.closed:
                force, slope = pressed(row.law, approach)
            touches.append(Touch(row, vector, approach, force, slope, unknown))
        return touches

    def _holds(self, z: Array, touches: list[Touch]) -> list[Hold]:
        x, holds = self.x(z), []
        flanks = _forces(touches)
        for radial in self.scene.radials:
            try:
                law = radial.law(self._transmitted(radial.gear, flanks))
            except ValueError as error:
                raise BranchLost(str(error)) from error
            place = self._places[radial.name]
            k = index_of(law, place)
            if k is None:
                raise BranchLost(f"{radial.name} can no longer {place.label}")
            offset = radial.matrix @ x - radial.centre
            unknown = self._steps.get(radial.name)
            if unknown is None:
                force = pulled(law, k, offset)
            else:
                force = z[unknown] * self.units.force
                if len(force) == 1:
                    force = force[0] * offset / (float(np.linalg.norm(offset)) or 1.0)
            holds.append(Hold(radial, law, k, offset, force, unknown))
        return holds

    def residual(self, z: Array) -> Array:
        """Imbalance of forces [loads], then misfit of rigid contacts and steps [deflections].

        Raises
        ------
        BranchLost
            If a spline's law has lost the piece on which the branch stands.
        """
        n, scene = self.scene.size, self.scene
        touches = self._touches(z)
        found = np.zeros(self.size)
        balance = scene.stiffness @ self.x(z) - scene.load
        for touch in touches:
            balance += touch.vector * touch.force
            if touch.unknown is not None:
                found[touch.unknown] = touch.approach / self.units.length
        for hold in self._holds(z, touches):
            balance += hold.radial.matrix.T @ hold.force
            if hold.unknown is not None:
                off = hold.offset if hold.limit == 0.0 else hold.radius - hold.limit
                found[hold.unknown] = off / self.units.length
        found[:n] = balance / self.units.force
        return found

    def rounding(self, z: Array) -> Array:
        """Bound on the round-off of the residual: of its terms' sizes, in the same units."""
        n, scene, (force, length) = self.scene.size, self.scene, self.units
        x = np.abs(self.x(z))
        touches = self._touches(z)
        found = np.zeros(self.size)
        balance = np.abs(scene.stiffness) @ x + np.abs(scene.load)
        for touch in touches:
            # What an approach is the difference of: along an arc, of the clearance and the way.
            fixed = touch.row.arc.clearance if isinstance(touch.row, ArcRow) else touch.row.gap
            terms = float(np.abs(touch.vector) @ x) + abs(fixed)
            balance += np.abs(touch.vector) * (abs(touch.force) + abs(touch.slope) * terms)
            if touch.unknown is not None:
                found[touch.unknown] = terms / length
        for hold in self._holds(z, touches):
            matrix, sizes = np.abs(hold.radial.matrix), np.abs(hold.force)
            terms = float(np.hypot(*(matrix @ x + np.abs(hold.radial.centre))))
            if hold.unknown is None:
                sizes = sizes + np.abs(hold.stiffness()).sum(axis=1) * terms
            else:
                found[hold.unknown] = (terms + hold.limit) / length
            balance += matrix.T @ sizes
        found[:n] = balance / force
        return np.asarray(ROUNDINGS * np.finfo(float).eps * found)

    def jacobian(self, z: Array) -> Array:
        """Derivative of the residual, shape (size, size)."""
        n, (force, length) = self.scene.size, self.units
        touches = self._touches(z)
        holds = self._holds(z, touches)
        found = np.zeros((self.size, self.size))
        stiffness = self.scene.stiffness.copy()
        for touch in touches:
            stiffness += touch.slope * np.outer(touch.vector, touch.vector)
            if isinstance(touch.row, ArcRow) and touch.force:
                stiffness -= touch.force * touch.turning(self.x(z))
            if touch.unknown is not None:
                found[:n, touch.unknown] = touch.vector
                found[touch.unknown, :n] = touch.vector
        for hold in holds:
            matrix = hold.radial.matrix
            if hold.unknown is None:
                stiffness += matrix.T @ hold.stiffness() @ matrix
                self._friction(hold, touches, found, stiffness)
            elif hold.limit == 0.0:
                found[:n, hold.unknown] = matrix.T
                found[hold.unknown, :n] = matrix
            else:
                along = hold.along
                found[:n, hold.unknown] = (along @ matrix)[:, None]
                found[hold.unknown, :n] = along @ matrix
                size = float(along @ hold.force)
                stiffness += size / hold.radius * (matrix.T @ hold.across @ matrix)
        found[:n, :n] = stiffness * length / force
        return found

    def _friction(self, hold: Hold, touches: list[Touch], found: Array, stiffness: Array) -> None:
        """Add what a friction bound that follows the torque makes of the flank forces, in place."""
        if not hold.radial.follows_torque or hold.springs or self._idles(hold.radial.gear):
            return
        train, n = self.scene.train, self.scene.size
        spline = train.splines[hold.radial.gear]
        sense = np.sign(train.transmitted(hold.radial.gear, _forces(touches)))
        pull = hold.radial.matrix.T @ hold.along * spline.friction_per_torque * sense
        for touch in touches:
            arm = train.transmitted(hold.radial.gear, {touch.row.name: 1.0})
            if arm and touch.unknown is not None:
                found[:n, touch.unknown] += pull * arm
            elif arm:
                stiffness += np.outer(pull, arm * touch.slope * touch.vector)

    # --- Answers --------------------------------------------------------------------------------

    def solve(self, z: Array, steps: int = 40) -> Array:
        """Solve by Newton's method, least-norm where the branch leaves displacements undetermined.

        Raises
        ------
        BranchLost
            If there is no solution near z.
        """
        previous = np.inf
        for _ in range(steps):
            step, *_ = np.linalg.lstsq(self.jacobian(z), -self.residual(z), rcond=RANK)
            z = z + step
            size = float(np.abs(step).max(initial=0.0))
            scale = max(float(np.abs(z).max(initial=0.0)), 1.0)
            if not np.isfinite(size):
                break
            if size <= 1e-15 * scale or (size <= 1e-10 * scale and size >= 0.5 * previous):
                if float(np.abs(self.residual(z)).max(initial=0.0)) <= SOLVED:
                    return z
                break
            previous = size
        raise BranchLost("the equations of the active set have no solution near by")

    def gauges(self, z: Array, loose: Array | None = None) -> list[Gauge]:
        """How far every element is from leaving its state; what is undetermined is left out.

        Parameters
        ----------
        z : ndarray, shape (size,)
        loose : ndarray, shape (n, d), optional
            Directions of the coordinates that count as undetermined; by default those that are.
        """
        touches = self._touches(z)
        loose = self.undetermined(z) if loose is None else loose
        found: list[Gauge] = []
        for touch in touches:
            is_closed = touch.row.name in self.active.closed
            found += contact_gauges(touch, is_closed, loose, self.units)
        for hold in self._holds(z, touches):
            found += radial_gauges(hold, self.units)
        return found

    def equilibrium(self, z: Array) -> Equilibrium:
        """Return a point in physical terms, to be judged by the certificate."""
        scene, x = self.scene, self.x(z)
        touches = self._touches(z)
        forces = {t.row.name: max(t.force, 0.0) for t in touches}
        flanks = {t.row.name for t in touches if getattr(t.row, "kind", "arc").endswith("flank")}
        gears = scene.train.gears
        return Equilibrium(
            index=scene.situation.index,
            rotation={g: scene.angle(g, x) for g in gears},
            displacement={g: scene.moved(g, x) for g in gears},
            flank_force={n: f for n, f in forces.items() if n in flanks},
            ring_force={n: f for n, f in forces.items() if n not in flanks},
            radial_reaction={
                h.radial.name: -h.force @ gears[h.radial.gear].frame
                for h in self._holds(z, touches)
            },
        )

    def undetermined(self, z: Array) -> Array:
        """Directions (n, d) of the coordinates that change no residual."""
        _, sizes, right = np.linalg.svd(self.jacobian(z))
        rank = int((sizes > RANK * sizes.max(initial=0.0)).sum())
        return np.asarray(right[rank:, : self.scene.size].T)

    def loose(self, z: Array) -> NDArray[np.bool_]:
        """Which coordinates (n,) are undetermined."""
        return np.asarray(np.abs(self.undetermined(z)).max(axis=1, initial=0.0) > LOOSE)

    def pulls(self, z: Array) -> dict[str, Array]:
        """Force of every radial element along its offset [N], shape (2,)."""
        return {h.radial.name: h.force for h in self._holds(z, self._touches(z))}

    def contacts(self, z: Array) -> dict[str, tuple[float, Array]]:
        """Force [N] of every contact, and its derivative with respect to z."""
        found = {}
        for touch in self._touches(z):
            gradient = np.zeros(self.size)
            if touch.unknown is not None:
                gradient[touch.unknown] = self.units.force
            else:
                gradient[: self.scene.size] = touch.slope * touch.vector * self.units.length
            found[touch.row.name] = (touch.force, gradient)
        return found


def identified(
    scene: Scene, found: Equilibrium, units: Units | None = None
) -> tuple[Branch, Array]:
    """Return the branch of a certified equilibrium, and its unknowns solved to round-off.

    Raises
    ------
    BranchLost
        If the equations of the active set do not reproduce the equilibrium.
    """
    units = units or Units.of(scene)
    active, x, forces, pulls = read_set(scene, found, units)
    branch = Branch(scene, active, units)
    return branch, branch.solve(branch.start(x, forces, pulls))


def _forces(touches: list[Touch]) -> dict[str, float]:
    """Forces [N] of all contacts but arcs."""
    return {t.row.name: t.force for t in touches if not isinstance(t.row, ArcRow)}
