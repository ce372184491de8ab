"""Loaded tooth contact analysis: from a pair's geometry to its loaded transmission error.

Source: formulation, section 9.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Literal

import numpy as np

from loadshare.errors import Refused
from loadshare.tooth.body import Array
from loadshare.tooth.compliance.interface import Compliance, Flank
from loadshare.tooth.contact import MeshPosition, PairGeometry
from loadshare.tooth.contact_problem import ContactProblem
from loadshare.tooth.contact_programme import Contact, solve_contact
from loadshare.tooth.law_fit import FIT_LOADS
from loadshare.tooth.ltca_result import LineLoad, Ltca
from loadshare.tooth.strips import StripLine

LOADS = (0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 1.0)
"""Parts of the rated torque: those of the fit, others to see its misfit, and the seed's three."""
POINTS = 32
"""Points on a contact line."""
Model = Literal["finite elements", "slices"]


@dataclass(frozen=True, eq=False)
class PairCompliance:
    """Compliances of both gears.

    Attributes
    ----------
    driver, driven : Compliance
    model : str
    """

    driver: Compliance
    driven: Compliance
    model: str


def pair_compliance(
    pair: PairGeometry,
    model: Model = "finite elements",
    *,
    teeth: int | None = None,
    layers: int | None = None,
) -> PairCompliance:
    """Compliances of a pair from finite elements or, hundreds of times faster, from slices.

    Parameters
    ----------
    pair : PairGeometry
    model : {"finite elements", "slices"}
    teeth : int, optional
        Teeth in the finite-element model, odd; by default as many as feel one another.
    layers : int, optional
        Finite elements over the face width; by default the shape of the tooth decides.

    Raises
    ------
    ValueError
        If there is no such model.
    """
    driver, driven = (pair.driver, 1), (pair.driven, pair.driven_side)
    if model == "finite elements":
        from loadshare.tooth.compliance.finite import FiniteElements, default_divisions

        # Pairs in contact at once are no more than the contact ratio rounded up.
        count = teeth or 2 * max(1, ceil(pair.contact_ratio + pair.overlap_ratio) - 1) + 1
        first, second = (
            FiniteElements(
                body,
                side,
                teeth=count,
                divisions=replace(default_divisions(body), width=layers) if layers else None,
            )
            for body, side in (driver, driven)
        )
        return PairCompliance(first, second, model)
    if model == "slices":
        from loadshare.tooth.compliance.slices import Slices

        return PairCompliance(Slices(*driver), Slices(*driven), model)
    raise ValueError(f"compliance model {model!r}; allowed: 'finite elements', 'slices'")


def ltca(
    pair: PairGeometry,
    torque: float,
    phases: int | Sequence[float] = 5,
    loads: Sequence[float] = LOADS,
    compliance: PairCompliance | Model = "finite elements",
    points: int = POINTS,
    progress: Callable[[int, int], None] | None = None,
) -> Ltca:
    """Analyse the loaded contact of a pair over its mesh cycle.

    Parameters
    ----------
    pair : PairGeometry
    torque : float
        Rated torque T on the driver [N·m].
    phases : int or sequence of float
        Number of equal parts of the mesh cycle, or the phases themselves, 0 ≤ phase < 1.
    loads : sequence of float
        Parts of T; 0.1, 0.5 and 0.9 are added where they are missing.
    compliance : PairCompliance or {"finite elements", "slices"}
        Compliances that are already there, or the model to make them with.
    points : int
        Points on each contact line.
    progress : callable, optional
        Told after each position how many are done, and how many there are.

    Raises
    ------
    ValueError
        If torque, loads or the number of points are out of range.
    Refused
        If a position has no contact, or one that its certificate does not pass.
    """
    parts = sorted({float(p) for p in (*loads, *FIT_LOADS)})
    if not (torque > 0.0 and parts[0] > 0.0):
        raise ValueError(
            f"torque {torque} N·m, parts {parts}: allowed: both above 0; turn the driver round to "
            "load the other flanks"
        )
    if points < 3:
        raise ValueError(f"points = {points} on a contact line; allowed: 3 or more")
    places = [k / phases for k in range(phases)] if isinstance(phases, int) else list(phases)
    if isinstance(compliance, str):
        compliance = pair_compliance(pair, compliance)
    torques = torque * np.array(parts)
    positions = pair.positions(places, points)
    contacts, lines = [], []
    for k, position in enumerate(positions):
        problem = contact_problem(pair, position, compliance)
        solved = _ladder(problem, torques / (pair.arm * pair.helices), position.phase)
        contacts.append(solved)
        lines.append(tuple(_line_loads(position, problem, contact) for contact in solved))
        if progress is not None:
            progress(k + 1, len(places))
    return Ltca(
        rated=torque,
        torque=torques,
        positions=positions,
        arm=pair.arm,
        helices=pair.helices,
        contacts=tuple(contacts),
        lines=tuple(lines),
        compliance=compliance.model,
    )


def contact_problem(
    pair: PairGeometry, position: MeshPosition, compliance: PairCompliance
) -> ContactProblem:
    """Contact problem of a position: every point of every line that may close.

    Raises
    ------
    Refused
        If the position has no contact line.
    """
    lines = position.lines
    if not lines:
        raise Refused(
            f"no pair of teeth meets at phase {position.phase:.4g} of the mesh cycle (transverse "
            f"contact ratio {pair.contact_ratio:.4g}); longer teeth, or a smaller centre distance, "
            "bring them into contact"
        )
    driver = tuple(Flank(line.pair, line.driver_uw) for line in lines)
    driven = tuple(Flank(line.pair * pair.driven_step, line.driven_uw) for line in lines)
    ends = np.cumsum([len(line.length) for line in lines])[:-1]
    depths = [
        np.split(gear.depth(np.concatenate([flank.uw for flank in flanks])), ends)
        for gear, flanks in ((compliance.driver, driver), (compliance.driven, driven))
    ]
    strips = tuple(
        StripLine(
            length=line.length,
            curvature=line.curvature,
            curvature_along=line.curvature_along,
            modulus=(pair.driver.youngs_modulus, pair.driven.youngs_modulus),
            poisson=(pair.driver.poisson, pair.driven.poisson),
            depth=depth,
        )
        for line, depth in zip(lines, zip(*depths, strict=True), strict=True)
    )
    return ContactProblem(
        bulk=compliance.driver.bulk(driver) + compliance.driven.bulk(driven),
        gap=np.concatenate([line.gap for line in lines]),
        lines=strips,
    )


def _ladder(problem: ContactProblem, loads: Array, phase: float) -> tuple[Contact, ...]:
    """Contacts under rising loads, each begun from the one before."""
    found: list[Contact] = []
    for load in loads:
        try:
            found.append(solve_contact(problem, load, found[-1].force if found else None))
        except Refused as refusal:
            raise Refused(f"phase {phase:.4g}: {refusal}", refusal.figures) from refusal
    return tuple(found)


def _line_loads(
    position: MeshPosition, problem: ContactProblem, contact: Contact
) -> tuple[LineLoad, ...]:
    """The contact told line by line."""
    return tuple(
        LineLoad(
            line=line,
            force=contact.force[part],
            half_width=strips.widths(contact.force[part]),
            pressure=strips.pressure(contact.force[part]),
            distance=contact.distance[part],
        )
        for line, strips, part in zip(position.lines, problem.lines, problem.parts, strict=True)
    )
