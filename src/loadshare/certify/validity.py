"""Whether displacements are small enough for the geometry in which they were found.

Lines of action, stops and tooth flanks are taken in their undisplaced position. What that neglects
is estimated here from the answer alone, with bounds:

- **Line of action.** For involutes the approach of two flanks is exactly linear in both rotations:
  a rotation winds the string of the base circle. A relative displacement Δ of the centres turns the
  line of action, a straight line of length L = (r_bi ± r_bj) tan α_t between the base circles, by
  Δ⊥/L, where Δ⊥ is the part of Δ across it. Forces are off in direction by this angle, and so by
  this share of their size. The line vanishes where the base circles touch, which takes at least
  Δ = L tan(α_t/2). For a face gear L is the pinion's part, r_b tan α_t, which is on the safe side.
- **Approach.** The approach is then off by Δ⊥²/2L. The part of this that the gap of an open flank
  does not take up is compared with the deflection of the case; a gear that carries nothing may turn
  in its play.
- **Compression.** A tooth bent by a part ε of its height is shorter by ε²; where the compression is
  all of the height, the flanks have passed through each other. The height is 2.25 modules where a
  gear's teeth are given; otherwise a gear with 17 teeth is taken, the fewest without undercut:
  teeth may be lower than that, so the figure is then a lower bound.
- **Neither flank.** A mesh of unknown backlash has only the flank that the loads press. Where these
  may press either one (`train.pressed`), and the mesh is open in the answer, the other flank would
  carry if the play were less than the opening. There is no refusal: with more play the answer
  holds. The gap that a relief leaves at the other flank is not counted, which is on the safe side.
- **Apart.** Any other mesh of unknown backlash that is open by more than the usual play of teeth,
  because of errors or of clockings that wind up a loop, would carry on its other flank too. This is
  reported, and there is no bound on it.
- **Ring.** Arcs hold exactly at any displacement, but a drum's stops keep their direction: they are
  off by the angle by which the arm from the neighbour turns.

Common shifts of gears, rotations and round rings cause no such error; displacements over base
radii, rotations, and shifts over backlashes are reported without a bound.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.residuals import first_of_largest
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.gear import cross
from loadshare.train.mesh import Mesh
from loadshare.train.situations import Situations
from loadshare.train.train import Train

NEITHER = "neither"
"""A mesh that is open where loads may press either flank."""
APART = "apart"
"""Any other mesh of unknown backlash that is open."""

LABELS = {
    "centre": "centre displaced / base radius",
    "rotation": "rotation [rad]",
    "backlash": "shift in a mesh / backlash",
    "compression": "mesh compression / tooth height",
    "line_of_action": "line of action turned [rad]",
    "approach": "approach neglected / deflection",
    NEITHER: "open where either flank may carry / deflection",
    APART: "open without a backlash / tooth height",
    "ring": "arm of a ring turned [rad]",
}
"""What is measured, each a pure number, in the order in which it is reported."""


@dataclass(frozen=True, slots=True)
class Measure:
    """One figure of a displacement.

    Attributes
    ----------
    value : float
    where : str
        Gear, mesh or ring that shows it.
    warning, refusal : float or None
        Bounds; None where the figure is only reported.
    """

    value: float
    where: str
    warning: float | None = None
    refusal: float | None = None


@dataclass(frozen=True, slots=True)
class Validity:
    """How large the displacements of an answer are, and what that means.

    Attributes
    ----------
    measures : mapping of str to Measure
        Keys of `LABELS`; those that a train cannot have are left out.
    """

    measures: Mapping[str, Measure]

    @property
    def warned(self) -> dict[str, Measure]:
        """Figures above the bound of a warning."""
        return {
            n: m for n, m in self.measures.items() if m.warning is not None and m.value > m.warning
        }

    @property
    def refused(self) -> dict[str, Measure]:
        """Figures at which the geometry has no meaning."""
        return {
            n: m for n, m in self.measures.items() if m.refusal is not None and m.value >= m.refusal
        }

    @property
    def verdict(self) -> str:
        """Its verdict: "small", "large" (with a warning) or "meaningless" (refused)."""
        return "meaningless" if self.refused else "large" if self.warned else "small"


def refusal_text(refused: Mapping[str, Measure]) -> str:
    """Return why an answer is refused, from the figures beyond their bounds."""
    text = "; ".join(
        f"{LABELS[name]} {m.value:.3g} at {m.where} (allowed below {m.refusal:.3g})"
        for name, m in refused.items()
    )
    return (
        f"the displacements are too large for the geometry in which they were found: {text}; "
        "check the load, the stiffnesses and the clearances"
    )


class Measuring:
    """Measures of the displacements of a train, in many answers at once.

    Parameters
    ----------
    train : Train
    """

    def __init__(self, train: Train) -> None:
        self.train = train
        self.of = of = mechanics_of(train)
        order, meshes = of.order, list(train.meshes.values())
        across = np.zeros((len(of.flanks), len(order), 3))
        for e, (mesh, drive) in enumerate(of.flanks):
            way = cross(_axis(train, mesh), mesh.direction(drive)[2])
            for end, sign in ((mesh.driver, 1.0), (mesh.driven, -1.0)):
                for gear in (end, train.gears[end].carrier):
                    if gear is not None:
                        across[e, order[gear]] += sign * way
        self.across = across.reshape(len(of.flanks), -1)
        geometry = np.array([_geometry(train, m) for m in meshes]).reshape(-1, 3)[of.mesh_of]
        self.line, angle, self.height = geometry.T[:, :, None]
        self.vanishing = float(np.tan(0.5 * angle).min(initial=math.inf))
        held = {*train.held, *(g for s in train.shafts.values() for g in (s.first, s.second))}
        self.uncertain = [
            e for e, (mesh, drive) in enumerate(of.flanks) if drive and mesh.flank_uncertain
        ]
        self.alone = [
            e
            for e, (mesh, _) in enumerate(of.flanks)
            if not (mesh.flanks[1:] or mesh.flank_uncertain)
        ]
        self.turnable = [k for g, k in order.items() if g not in held]

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Warning and refusal levels of the figures that have bounds; infinite for no refusal."""
        bounds = {
            "compression": (CERTIFY.compressed, CERTIFY.meaningless),
            "line_of_action": (min(CERTIFY.turned, self.vanishing), self.vanishing),
            "approach": (CERTIFY.neglected, CERTIFY.meaningless),
        }
        if self.uncertain:
            bounds[NEITHER] = (CERTIFY.neglected, math.inf)
        if len(self.of.drum):
            bounds["ring"] = (CERTIFY.turned, self.vanishing)
        return bounds if self.of.flanks else {}

    def bounded(
        self, situations: Situations, answers: Equilibria, deflection: Array, apart: bool = False
    ) -> dict[str, Array]:
        """Return the figures that have bounds, element by element.

        Parameters
        ----------
        situations : Situations
        answers : Equilibria
            S of them.
        deflection : ndarray, shape (S,)
            Deflection of each case [m].
        apart : bool
            Whether to include meshes of unknown backlash that are open, which compiled code does
            not measure.

        Returns
        -------
        dict of str to ndarray, shape (elements, S)
            Elements are flanks, or arcs of drums.
        """
        of = self.of
        if not of.flanks:
            return {}
        # Samples lie next to one another: sums and largest values then run along them.
        shifts = np.ascontiguousarray(
            (answers.displacement + situations.offset).reshape(len(answers.rotation), -1).T
        )
        compression = of.turning @ answers.rotation.T
        compression += of.pushing @ shifts
        compression -= situations.gap.T
        turned = np.abs((self.across / self.line) @ shifts)
        neglected = 0.5 * self.line * turned * turned
        room = np.maximum(-compression, 0.0) - neglected
        near = np.flatnonzero((-room > CERTIFY.neglected * deflection).any(axis=0))
        if len(near):
            room[:, near] = self._room_of_idle(situations, answers, room, near)
        found = {
            "compression": compression / self.height,
            "line_of_action": turned,
            "approach": np.maximum(-room, 0.0) / deflection,
        }
        # A gap opens the flank that is pressed, and not the other one; growth closes both.
        openings = {NEITHER: self.uncertain, APART: self.alone if apart else []}
        for name, flanks in openings.items():
            if flanks:
                open_by = -(compression + np.maximum(situations.gap.T, 0.0))[flanks]
                opening = np.maximum(open_by, 0.0)
                found[name] = opening / (deflection if name == NEITHER else self.height[flanks])
        if len(of.drum):
            found["ring"] = self._arms(answers)
        return found

    def _room_of_idle(
        self, situations: Situations, answers: Equilibria, room: Array, rows: Numbers
    ) -> Array:
        """Return the room of flanks [m], (flanks, rows), once gears without force have turned."""
        force = np.abs(answers.flank_force[rows].T)
        idle = force <= CERTIFY.noise * force.max(axis=0)
        torque = np.broadcast_to(situations.torque, answers.rotation.shape)[rows]
        found = here = room[:, rows]
        for gear in self.turnable:
            closing, opening = self.of.turning[:, gear] > 0.0, self.of.turning[:, gear] < 0.0
            both = closing | opening
            play = here[closing].min(axis=0, initial=np.inf)
            play = play + here[opening].min(axis=0, initial=np.inf)
            free = idle[both].all(axis=0) & (torque[:, gear] == 0.0) & (play >= 0.0)
            found = np.where(both[:, None] & free, np.maximum(found, 0.0), found)
        return found

    def _arms(self, answers: Equilibria) -> Array:
        moved, of = answers.displacement, self.of
        # One component after the other: sums over three numbers each are slow.
        ways = (m[:, of.drum, None] - m[:, of.neighbours] for m in np.moveaxis(moved, 2, 0))
        turned = np.sqrt(sum(way * way for way in ways)) / of.distance
        return np.asarray(turned.reshape(len(moved), -1).T)

    def worst(
        self,
        situations: Situations,
        answers: Equilibria,
        deflection: Array,
        refusal: bool = False,
    ) -> Array:
        """Return how close S answers come to a warning, (S,): the largest figure over its bound.

        Parameters
        ----------
        situations, answers, deflection
            As for `bounded`.
        refusal : bool
            Whether to take the bounds of refusals instead.
        """
        found, bounds = self.bounded(situations, answers, deflection), self.bounds
        shares = [v.max(axis=0, initial=0.0) / bounds[name][refusal] for name, v in found.items()]
        return np.maximum.reduce(shares) if shares else np.zeros(len(answers.rotation))

    def refusals(
        self, situations: Situations, answers: Equilibria, deflection: Array
    ) -> dict[int, str]:
        """Return why answers are refused, by sample."""
        beyond: dict[int, dict[str, Measure]] = {}
        for name, values in self.bounded(situations, answers, deflection).items():
            for k in np.flatnonzero(values.max(axis=0) >= self.bounds[name][1]).tolist():
                beyond.setdefault(k, {})[name] = self._largest(name, values[:, k])
        return {k: refusal_text(found) for k, found in beyond.items()}

    def _largest(self, name: str, values: Array) -> Measure:
        at = first_of_largest(values)
        warning, refusal = self.bounds.get(name, (None, None))
        refusal = None if refusal == math.inf else refusal
        return Measure(max(float(values[at]), 0.0), self._where(name, at), warning, refusal)

    def _where(self, name: str, element: int) -> str:
        if name in ("centre", "rotation"):
            return f"gear {self.of.gears[element]}"
        if name == "ring":
            return f"ring {self.train.drums[element // 2].gear}"
        flank = {NEITHER: self.uncertain, APART: self.alone}.get(name, range(element + 1))[element]
        return f"mesh {self.of.flanks[flank][0].name}"

    def every(
        self, situations: Situations, answers: Equilibria, deflection: Array, apart: bool = False
    ) -> dict[str, Array]:
        """Return all measures of S answers, element by element, each (elements, S).

        Parameters are those of `bounded`. Shifts over backlashes are negative without a backlash.
        """
        of, shifts = self.of, answers.displacement + situations.offset
        shifts = shifts.reshape(len(answers.rotation), -1).T
        found = {
            "centre": np.sqrt((answers.displacement**2).sum(axis=2)).T / of.radius[:, None],
            "rotation": np.abs(answers.rotation).T,
        }
        backlash = situations.gap.T
        some = ~of.is_drive[:, None] & (backlash > 0.0)
        if some.any():
            size = np.hypot(of.pushing @ shifts, self.across @ shifts)
            found["backlash"] = np.where(some, size / np.where(some, backlash, 1.0), -1.0)
        found |= self.bounded(situations, answers, deflection, apart)
        return {name: found[name] for name in LABELS if name in found}

    def each(
        self, situations: Situations, answers: Equilibria, deflection: Array
    ) -> list[dict[str, Measure]]:
        """Return all figures, answer by answer; parameters are those of `bounded`."""
        found: list[dict[str, Measure]] = [{} for _ in answers.rotation]
        for name, values in self.every(situations, answers, deflection, apart=True).items():
            for row, figures in enumerate(values.T):
                # Openings of meshes that have one flank only are reported where they matter.
                if name != APART or figures.max() > CERTIFY.apart:
                    found[row][name] = self._largest(name, figures)
        return found


@lru_cache(maxsize=16)
def measuring(train: Train) -> Measuring:
    """Return the measures of a train, kept for its other positions."""
    return Measuring(train)


def _axis(train: Train, mesh: Mesh) -> Array:
    """Return the axis normal to the plane of the line of action: the pinion's, for a face gear."""
    driver, driven = train.gears[mesh.driver], train.gears[mesh.driven]
    return (driven if driver.kind == "face" else driver).axis


def _geometry(train: Train, mesh: Mesh) -> tuple[float, float, float]:
    """Return length of the line of action [m], pressure angle [rad], height of the teeth [m]."""
    gears = train.gears[mesh.driver], train.gears[mesh.driven]
    kinds = [g.kind for g in gears]
    # n and n' lean against each other by twice the pressure angle towards the centres.
    between = mesh.drive_normal + mesh.coast_normal
    sine = 0.5 * math.sqrt(float(between @ between))
    angle = math.asin(min(sine, 1.0))
    first, second = mesh.radii
    if "face" in kinds:
        base = first if kinds[1] == "face" else second
    else:
        base = abs(first - second) if "internal" in kinds else first + second
    teeth = [(r, g.teeth) for r, g in zip(mesh.radii, gears, strict=True) if g.teeth]
    pinions = [
        (r, CERTIFY.fewest) for r, k in zip(mesh.radii, kinds, strict=True) if k == "external"
    ]
    radius, number = min(
        teeth or pinions or [(min(mesh.radii), CERTIFY.fewest)], key=lambda t: t[0]
    )
    module = 2.0 * radius / (number * math.cos(angle))
    return base * math.tan(angle), angle, CERTIFY.height * module
