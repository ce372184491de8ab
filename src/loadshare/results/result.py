"""A result: the answer at every position, and the case and settings from which it was found."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

from loadshare.case.table import Table
from loadshare.certify import Certificate, FloatState
from loadshare.certify.uniqueness import MEANINGS, Uniqueness
from loadshare.certify.validity import Measure, Validity
from loadshare.equality import Comparable
from loadshare.json_text import json_text
from loadshare.libraries import pd, xr
from loadshare.output import write_whole
from loadshare.pictures import picture
from loadshare.results.claim import Claim, Pair, claim_of
from loadshare.results.dataset import dataset, frame, with_units
from loadshare.results.document import netcdf_content, to_document
from loadshare.results.figures import Figures
from loadshare.results.judged import Judged
from loadshare.results.laws import LawUse, laws_of
from loadshare.results.loads import Elastic, Loads
from loadshare.results.view import position_view, result_view
from loadshare.settings import CERTIFY
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train
from loadshare.view import View, Viewed, by_name

if TYPE_CHECKING:
    from loadshare.case import Case
    from loadshare.report.plots import Plots


@dataclass(frozen=True, slots=True)
class Stamp:
    """The origin of a result.

    Attributes
    ----------
    version : str
        Of loadshare.
    case : str
        Name of the case.
    title : str
    case_hash : str
        SHA-256 of the case's physical content.
    solver, method : str
    reduce : bool
    tolerance : float
        Of the certificate.
    stop : float
        Of the outer loop.
    positions : tuple of int
        1-based positions that were requested.
    """

    version: str
    case: str
    title: str
    case_hash: str
    solver: str
    method: str
    reduce: bool
    tolerance: float
    stop: float
    positions: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Effort:
    """How a position was solved.

    Attributes
    ----------
    rung : str
        Rung of the ladder that found the answer.
    method : str
    kind : str
        Class of the programme: "linear", "QP", "SOCP" or "power cone".
    iterations, rounds : int
        Passes of the outer loop, and plans tried.
    """

    rung: str
    method: str
    kind: str
    iterations: int
    rounds: int


class Answered(Protocol):
    """An equilibrium, its certificate, and how it was found."""

    @property
    def equilibrium(self) -> Equilibrium:
        """The equilibrium, with displacements of least norm."""

    @property
    def certificate(self) -> Certificate:
        """The certificate of the equilibrium."""

    @property
    def effort(self) -> Effort:
        """How it was found."""


@dataclass(frozen=True, eq=False, repr=False)
class Position(Viewed):
    """The result at one position.

    Rarely used figures are computed when they are first read, for several positions at once. Two
    positions are equal if their claims, certificates and efforts are.

    Attributes
    ----------
    position : int
        1-based.
    torque : mapping of mesh to float
        Torque on the driver, drive flank less coast flank [N·m].
    coast_torque : mapping of mesh to float
        Part on the coast flank [N·m], ≥ 0.
    share, pair_share : mapping of mesh to float or None
        Ω over the mean of the stage, and of the branch's group.
    train : Train
        The train at this position.
    answer : Answered
        The answer, from which all the rest is computed.
    """

    position: int
    torque: Mapping[str, float]
    coast_torque: Mapping[str, float]
    share: Mapping[str, float | None]
    pair_share: Mapping[str, float | None]
    train: Train
    answer: Answered

    def _said(self) -> object:
        return [getattr(self, name) for name in _COMPARED]

    @property
    def equilibrium(self) -> Equilibrium:
        """The claim as `loadshare.certify.certify` takes it."""
        return self.answer.equilibrium

    @property
    def certificate(self) -> Certificate:
        """The verdict on the claim."""
        return self.answer.certificate

    @property
    def effort(self) -> Effort:
        """How the position was solved."""
        return self.answer.effort

    @cached_property
    def claim(self) -> Claim:
        """The displacements and forces from which, with the case, all the rest is computed."""
        return claim_of(self.train, self.equilibrium)

    @property
    def rotation(self) -> Mapping[str, float]:
        """Rotation φ of every gear [rad], positive in the running sense."""
        return self.claim.rotation

    @cached_property
    def displacement(self) -> Mapping[str, Pair]:
        """Displacement [m] of every gear, in its transverse frame.

        The global x, y for a gear whose axis is z.
        """
        gears, moved = self.train.gears, self.claim.displacement
        plane = {name: gears[name].plane @ p for name, p in moved.items()}
        return Table({name: (float(p[0]), float(p[1])) for name, p in plane.items()})

    @cached_property
    def mesh_position(self) -> Mapping[str, int]:
        """Position of every mesh in its own cycle, from 1."""
        index = self.equilibrium.index
        return Table({mesh: k + 1 for mesh, k in self.train.mesh_positions(index).items()})

    @property
    def figures(self) -> Figures:
        """All figures, as arrays, of the answers that are evaluated together with this one."""
        return self.certificate.claims.derived(Judged)

    @property
    def row(self) -> int:
        """Number of this answer in `figures`."""
        return self.certificate.row

    @property
    def loads(self) -> Loads:
        """Forces of meshes and on bearings, torques of shafts and external torques."""
        return Loads(self.figures, self.row)

    @property
    def elastic(self) -> Elastic:
        """Transmission errors and stiffnesses of the train and of its meshes."""
        return Elastic(self.figures, self.row)

    @property
    def undetermined(self) -> Mapping[str, Pair]:
        """Coordinates that the forces leave open, as "gear 4 x" [m] or "gear 4 rotation" [rad].

        The least and the largest value that each may take, infinite without a limit. Rotation and
        displacement are those of least norm: Σ r_b²φ² + |p|² over all gears.
        """
        return self.equilibrium.undetermined

    @property
    def floats(self) -> Mapping[str, FloatState]:
        """Where every float rests, by gear."""
        return self.certificate.floats

    @property
    def validity(self) -> Validity:
        """Whether displacements are small enough for the geometry in which they were found."""
        return self.certificate.claims.validities[self.row]

    @property
    def uniqueness(self) -> Uniqueness:
        """Whether the answer is proved to be the only one."""
        return self.certificate.claims.uniquenesses[self.row]

    def _view(self) -> View:
        return position_view(self)


_COMPARED = (
    "position",
    "torque",
    "coast_torque",
    "share",
    "pair_share",
    "claim",
    "undetermined",
    "certificate",
    "effort",
)


@dataclass(frozen=True, eq=False)
class Result(Comparable):
    """Certified equilibria of a case.

    Two results are equal if their stamps and positions are.

    Attributes
    ----------
    frames : mapping of gear to ((float, float, float), (float, float, float))
        Directions of the two displacement components.
    stages : mapping of stage to tuple of mesh names
    positions : tuple of Position
    omega, pair_omega : mapping of stage to float or None
        Largest Ω of each stage and of the system, over the stage mean and over the group mean.
    case : Case
        As it was given to `solve`; if the result was read from a file, as in the file.
    solved : Case
        The same with its mesh laws as numbers.
    stamped : callable
        Returns the stamp, which holds the hash of the case.
    """

    frames: Mapping[str, tuple[tuple[float, float, float], tuple[float, float, float]]]
    stages: Mapping[str, tuple[str, ...]]
    positions: tuple[Position, ...]
    omega: Mapping[str, float | None]
    pair_omega: Mapping[str, float | None]
    case: Case
    solved: Case
    stamped: Callable[[], Stamp] = field(repr=False)

    def _said(self) -> object:
        return self.stamp, self.positions

    @cached_property
    def stamp(self) -> Stamp:
        """The origin of the result."""
        return self.stamped()

    def __repr__(self) -> str:
        """Show what was solved, how good the answer is, and how load is shared."""
        done, requested = len(self.positions), len(self.stamp.positions)
        return (
            f"Result of {self.stamp.case}: {done} of {requested} positions certified, "
            f"worst residual {self.certificate.worst:.1e}\nlargest Ω: {by_name(self.omega)}"
        )

    @property
    def passed(self) -> bool:
        """Whether every requested position is present and certified, as in a result of `solve`."""
        there = [p.position for p in self.positions]
        whole = bool(there) and sorted(there) == sorted(self.stamp.positions)
        return whole and all(p.certificate.passed for p in self.positions)

    @property
    def certificate(self) -> Certificate:
        """The worst certificate over the positions."""
        return max((p.certificate for p in self.positions), key=lambda c: c.worst)

    @property
    def validity(self) -> tuple[tuple[str, Measure, int], ...]:
        """Largest measures of displacements over the positions: name, measure and position."""
        found: dict[str, list[tuple[Measure, int]]] = {}
        for p in self.positions:
            for name, measure in p.validity.measures.items():
                found.setdefault(name, []).append((measure, p.position))
        largest = {
            n: max(m.value for m, _ in every) * (1.0 - CERTIFY.alike) for n, every in found.items()
        }
        return tuple(
            (n, *next(f for f in every if f[0].value >= largest[n])) for n, every in found.items()
        )

    @property
    def uniqueness(self) -> Uniqueness:
        """The weakest of the positions' verdicts on whether the answer is the only one."""
        order = list(MEANINGS)
        return max(
            (p.uniqueness for p in self.positions),
            key=lambda u: (order.index(u.kind), math.inf if u.curvature is None else u.curvature),
        )

    @cached_property
    def laws(self) -> Mapping[str, LawUse]:
        """The origin of every mesh's law, and the loads under which the law was used."""
        return Table(laws_of(self.solved, [p.torque for p in self.positions]))

    @property
    def floats(self) -> tuple[Mapping[str, FloatState], ...]:
        """Where every float rests, one mapping per position."""
        return tuple(p.floats for p in self.positions)

    @property
    def dataset(self) -> xr.Dataset:
        """All figures as labelled arrays with units in their attributes; a copy, to be extended."""
        return self._arrays.copy()

    @cached_property
    def _arrays(self) -> xr.Dataset:
        return dataset(self)

    @property
    def torque(self) -> xr.DataArray:
        """Torque on the driver [N·m], position × mesh."""
        return self.dataset["torque"]

    @property
    def share(self) -> xr.DataArray:
        """Ω over the stage's mean, position × mesh."""
        return self.dataset["share"]

    @property
    def pair_share(self) -> xr.DataArray:
        """Ω over the group's mean, position × mesh."""
        return self.dataset["pair_share"]

    @property
    def displacement(self) -> xr.DataArray:
        """Displacement of the centres [m], position × gear × component."""
        return self.dataset["displacement"]

    @property
    def plot(self) -> Plots:
        """Pictures: ``torque()``, ``share()``, ``floats()``, ``law()`` and ``train()``.

        Each returns a `Figure`; ``.save("floats.svg")`` writes it.
        """
        return cast("Plots", picture(self))

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data, as in the JSON file."""
        return to_document(self)

    def to_json(self, path: str | Path | None = None) -> str:
        """Return the JSON text of the result; it is also written to `path`, if given."""
        text = json_text(self.to_dict())
        if path is not None:
            write_whole(Path(path), text)
        return text

    def to_netcdf(self, path: str | Path) -> None:
        """Write the labelled arrays, and the whole result with them, to a netCDF file."""
        write_whole(Path(path), netcdf_content(self))

    def to_frame(self) -> pd.DataFrame:
        """Return torques and coefficients as a table, one row per position and mesh."""
        return frame(self)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the table of `to_frame`, with the unit of every column in ``attrs["units"]``."""
        return with_units(self.to_frame(), self.dataset)

    def to_xarray(self) -> xr.Dataset:
        """Return the labelled arrays, `dataset`: every figure with its unit."""
        return self.dataset

    def _repr_html_(self) -> str:
        return result_view(self).html
