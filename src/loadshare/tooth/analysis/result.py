"""Results of loaded tooth contact analysis."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from loadshare.tooth.analysis.fit import FIT_LOADS, LawFit, fit_law
from loadshare.tooth.analysis.sampling import Cells
from loadshare.tooth.contact.programme import Contact
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.unloaded.positions import ContactLine, MeshPosition

LEAST_LOAD = 1e-9
"""How far below the least load of the fit a load may be by rounding, relative to it."""


@dataclass(frozen=True, slots=True, eq=False)
class LineLoad:
    """The load on one contact line.

    Attributes
    ----------
    line : ContactLine
        The line.
    force : array (n,)
        Force on each point [N]; of one half for a herringbone pair.
    half_width : array (n,)
        Half-width of the contact across the line [m]; 0 where there is none.
    pressure : array (n,)
        Largest pressure across the line [Pa].
    distance : array (n,)
        Gap left between the flanks [m]; 0 where they touch.
    """

    line: ContactLine
    force: Array
    half_width: Array
    pressure: Array
    distance: Array

    @property
    def per_length(self) -> Array:
        """Load per length of line (n,) [N/m]."""
        return np.asarray(self.force / self.line.length)

    @property
    def loaded(self) -> bool:
        """Whether the pair carries load."""
        return bool(np.any(self.force > 0.0))


@dataclass(frozen=True, slots=True)
class EdgeContact:
    """Load that reaches an edge of the flanks.

    Attributes
    ----------
    position, load : int
        Number of the meshing position and of the load.
    pair : int
    edge : str
        "tip of the driver", "tip of the driven gear" or "end of the face".
    share : float
        Load per length at the edge over the largest on the line.
    pressure : float
        Pressure at the edge [Pa], without the stress concentration of a sharp edge.
    """

    position: int
    load: int
    pair: int
    edge: str
    share: float
    pressure: float


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """Contact from which the law follows: at the positions, or between them for means.

    Attributes
    ----------
    cells : Cells
    positions : tuple of MeshPosition
        At the phases of the cells.
    contacts : tuple of tuple of Contact
        Contact at each position under every load.
    """

    cells: Cells
    positions: tuple[MeshPosition, ...]
    contacts: tuple[tuple[Contact, ...], ...]


@dataclass(frozen=True, eq=False)
class Ltca:
    """Loaded tooth contact at K positions of the mesh cycle and under L torques.

    Law, secant, tangent and increment are those of the positions or, if contact between them was
    solved as well, of the means over the parts of the cycle that they represent.

    Attributes
    ----------
    rated : float
        Rated torque on the driver [N·m].
    torque : array (L,)
        Torques on the driver [N·m], rising.
    positions : tuple of MeshPosition
        Unloaded contact at the K positions.
    arm : float
        Approach along the normal per radian of the driver [m].
    helices : int
        2 if forces and lines are those of one half.
    contacts : tuple of tuple of Contact
        Certified contact of each position and load.
    lines : tuple of tuple of tuple of LineLoad
        Load on each line of each position and load.
    compliance : str
        Model of the compliances.
    sampled : Sampled
        Contact from which the law follows.
    """

    rated: float
    torque: Array
    positions: tuple[MeshPosition, ...]
    arm: float
    helices: int
    contacts: tuple[tuple[Contact, ...], ...]
    lines: tuple[tuple[tuple[LineLoad, ...], ...], ...] = field(repr=False)
    compliance: str
    sampled: Sampled = field(repr=False)

    @cached_property
    def phase(self) -> Array:
        """Phases (K,) of the mesh cycle."""
        return np.array([p.phase for p in self.positions])

    @cached_property
    def approach(self) -> Array:
        """Approach Z (K, L) [m] along the normal."""
        return np.array([[c.approach for c in row] for row in self.contacts])

    @cached_property
    def unloaded_error(self) -> Array:
        """Transmission error without load (K,) [rad at the driver]."""
        return np.array([p.transmission_error for p in self.positions])

    @cached_property
    def angle(self) -> Array:
        """Loaded transmission error Δφ (K, L) [rad at the driver]."""
        return np.asarray(self.unloaded_error[:, None] + self.approach / self.arm)

    @cached_property
    def elastic(self) -> Array:
        """Approach (K, L) [m] to which the law is fitted: at the positions, or their means."""
        every = [[c.approach for c in row] for row in self.sampled.contacts]
        return self.sampled.cells.mean(every)

    @cached_property
    def law_angle(self) -> Array:
        """Δφ (K, L) [rad at the driver] that the law is fitted to: at positions, or their means."""
        every = [p.transmission_error for p in self.sampled.positions]
        lead = self.sampled.cells.mean(every)
        return np.asarray(lead[:, None] + self.elastic / self.arm)

    @cached_property
    def law(self) -> LawFit:
        """a, b, c of every position, from 0.1, 0.5 and 0.9 of the rated torque."""
        fit = np.isclose(self.torque[:, None], self.rated * np.array(FIT_LOADS)).any(axis=1)
        return fit_law(self.torque[fit], self.law_angle[:, fit])

    @cached_property
    def misfit(self) -> Array:
        """Law minus computed angle (K, L), over the elastic angle Δφ − a under that torque."""
        fitted = np.column_stack([self.law.angle(t) for t in self.torque])
        return np.asarray((fitted - self.law_angle) / (self.law_angle - self.law.a[:, None]))

    def secant(self, part: float = 1.0) -> Array:
        """Return K = T/(Δφ − a) (K,) [N·m/rad at the driver] under a computed part of rated torque.

        Raises
        ------
        ValueError
            If that part was not computed, or lies below the loads of the fit: a is not the unloaded
            error but a coefficient of the fit, so that Δφ − a has no meaning there.
        """
        k = self._load(part)
        if self.torque[k] < min(FIT_LOADS) * self.rated * (1.0 - LEAST_LOAD):
            raise ValueError(
                f"{part} of the rated torque is below the loads of the fit, which begin at "
                f"{min(FIT_LOADS)}, and a holds only for these; allowed: {min(FIT_LOADS)} or "
                "more; tangent and increment hold for any load"
            )
        return np.asarray(self.torque[k] / (self.law_angle[:, k] - self.law.a))

    def tangent(self, part: float = 1.0) -> Array:
        """Return dT/dΔφ (K,) [N·m/rad at the driver] under a computed part of the rated torque.

        It follows from the derivative of the contact itself, not from the fitted law.
        """
        k = self._load(part)
        slope = self.sampled.cells.mean([row[k].tangent for row in self.sampled.contacts])
        return np.asarray(self.helices * self.arm**2 / slope)

    def increment(self, low: float, high: float) -> Array:
        """Return ΔT/ΔΔφ (K,) [N·m/rad at the driver] between two computed parts of rated torque."""
        i, j = self._load(low), self._load(high)
        return np.asarray(
            (self.torque[j] - self.torque[i]) / (self.law_angle[:, j] - self.law_angle[:, i])
        )

    @cached_property
    def contact_ratio(self) -> Array:
        """Contact ratio under each load (L,): pairs that carry load, averaged over the cycle.

        It is exact to one over the number of positions.
        """
        loaded = [[sum(one.loaded for one in lines) for lines in row] for row in self.lines]
        return np.asarray(np.mean(np.array(loaded, dtype=float), axis=0))

    def shares(self, part: float = 1.0) -> list[dict[int, float]]:
        """Return, by position, the share of load on each pair of teeth in contact under a load."""
        k = self._load(part)
        forces = [{one.line.pair: float(one.force.sum()) for one in row[k]} for row in self.lines]
        return [
            {pair: force / sum(own.values()) for pair, force in own.items() if force > 0.0}
            for own in forces
        ]

    @cached_property
    def edges(self) -> tuple[EdgeContact, ...]:
        """All loads on edges of the flanks."""
        return tuple(
            edge
            for k, row in enumerate(self.lines)
            for i, lines in enumerate(row)
            for one in lines
            for edge in _edges(k, i, one)
        )

    def _load(self, part: float) -> int:
        found = np.flatnonzero(np.isclose(self.torque, part * self.rated))
        if not len(found):
            parts = ", ".join(f"{t / self.rated:.4g}" for t in self.torque)
            raise ValueError(
                f"{part} of the rated torque was not computed; computed parts: {parts}"
            )
        return int(found[0])


def _edges(position: int, load: int, one: LineLoad) -> list[EdgeContact]:
    """Return the loaded ends of a line; a line's ends are on edges of the flanks.

    The edge is the tip if the end's flank coordinate is nearer to it than one spacing of the
    points, or than a thousandth of the flank.
    """
    found = []
    density = one.per_length
    for end, inner in ((0, 1), (-1, -2)):
        if not one.force[end] > 0.0:
            continue
        edge = "end of the face"
        for name, uw in (("driver", one.line.driver_uw), ("driven gear", one.line.driven_uw)):
            spacing = abs(float(uw[end, 0] - uw[inner, 0])) if len(uw) > 1 else 0.0
            if uw[end, 0] > 1.0 - max(spacing, 1e-3):
                edge = f"tip of the {name}"
        share = float(density[end] / density.max())
        pressure = float(one.pressure[end])
        found.append(EdgeContact(position, load, one.line.pair, edge, share, pressure))
    return found
