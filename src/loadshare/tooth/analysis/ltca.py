"""Loaded tooth contact analysis: from a pair's geometry to its loaded transmission error.

Source: formulation, section 9.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from math import ceil
from operator import attrgetter
from typing import Literal

import numpy as np

from loadshare.errors import Refused
from loadshare.progress import Progress
from loadshare.tooth.analysis.fit import FIT_LOADS
from loadshare.tooth.analysis.result import LineLoad, Ltca, Sampled
from loadshare.tooth.analysis.sampling import at_each, cells
from loadshare.tooth.compliance.interface import Compliance, Flank
from loadshare.tooth.contact.problem import ContactBatch, ToothContact
from loadshare.tooth.contact.programme import Contact, solve_contacts
from loadshare.tooth.contact.strips import StripLine, width_factor
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.unloaded.positions import ContactLine, GearPair, MeshPosition

LOADS = (0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 1.0)
"""Parts of the rated torque: those of the fit, others to show its misfit, and the seed's three."""
POINTS: dict[str, int] = {"finite elements": 32, "slices": 16}
"""Points on a contact line by model; slices do not resolve what more points would show."""
BATCH = 2**16
"""Entries of the compliance matrices that are solved at once: a few megabytes."""
Model = Literal["finite elements", "slices"]
DRIVER, DRIVEN = attrgetter("driver_uw"), attrgetter("driven_uw")
"""Getters of the flank coordinates of a contact line's points, on either flank."""


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
    pair: GearPair,
    model: Model = "finite elements",
    *,
    teeth: int | None = None,
    layers: int | None = None,
) -> PairCompliance:
    """Compute a pair's compliances from finite elements or, hundreds of times faster, from slices.

    Parameters
    ----------
    pair : GearPair
    model : {"finite elements", "slices"}
    teeth : int, optional
        Teeth in the finite-element model, odd; by default as many as interact, or as the gear
        allows.
    layers : int, optional
        Finite elements over the face width; by default this follows from the shape of the tooth.

    Raises
    ------
    ValueError
        If there is no such model.
    """
    driver, driven = (pair.driver, 1), (pair.driven, pair.driven_side)
    if model == "finite elements":
        from loadshare.tooth.compliance.finite import (
            FiniteElements,
            default_divisions,
            most_teeth,
        )

        # Pairs in contact at once are no more than the contact ratio rounded up.
        count = 2 * max(1, ceil(pair.contact_ratio + pair.overlap_ratio) - 1) + 1
        first, second = (
            FiniteElements(
                body,
                side,
                # A pinion of few teeth may have less than that.
                teeth=teeth or min(count, most_teeth(body.gear.teeth)),
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
    pair: GearPair,
    torque: float,
    phases: int | Sequence[float] = 5,
    loads: Sequence[float] = LOADS,
    compliance: PairCompliance | Model = "finite elements",
    points: int | None = None,
    progress: Progress | None = None,
    *,
    means: bool = False,
) -> Ltca:
    """Analyse the loaded contact of a pair over its mesh cycle.

    Parameters
    ----------
    pair : GearPair
    torque : float
        Rated torque T on the driver [N·m].
    phases : int or sequence of float
        Number of equal parts of the mesh cycle, or the phases themselves, 0 ≤ phase < 1.
    loads : sequence of float
        Parts of T; 0.1, 0.5 and 0.9 are added where they are missing.
    compliance : PairCompliance or {"finite elements", "slices"}
        Compliances that exist already, or the model to compute them with.
    points : int, optional
        Points on each contact line; by default 32 with finite elements, 16 with slices.
    progress : callable, optional
        Called after each position with the number done and the total.
    means : bool
        Whether the law of a position is the mean over its part of the cycle; needs equal parts.

    Raises
    ------
    ValueError
        If torque, loads or the number of points are out of range.
    Refused
        If a position has no contact, or one that fails its certificate or is wider than its teeth
        are thick.
    """
    parts = sorted({float(p) for p in (*loads, *FIT_LOADS)})
    if not (torque > 0.0 and parts[0] > 0.0):
        raise ValueError(
            f"torque {torque} N·m, parts {parts}: allowed: both above 0; reverse the driver to "
            "load the other flanks"
        )
    if points is not None and points < 3:
        raise ValueError(f"points = {points} on a contact line; allowed: 3 or more")
    if means and not isinstance(phases, int):
        raise ValueError("means need the number of positions, not phases")
    places = [k / phases for k in range(phases)] if isinstance(phases, int) else list(phases)
    count, parts_of = len(places), cells(len(places), pair.changes) if means else at_each(places)
    if means:
        places += parts_of.phase.tolist()
    if isinstance(compliance, str):
        compliance = pair_compliance(pair, compliance)
    torques = torque * np.array(parts)
    points = POINTS.get(compliance.model, 32) if points is None else points
    positions = pair.positions(places, points)
    problems = contact_problems(pair, positions, compliance)
    found: dict[int, tuple[Contact, ...]] = {}
    for group in _groups(problems, len(parts)):
        solved = _under_all([problems[k] for k in group], torques / (pair.arm * pair.helices))
        for k, own in zip(group, solved, strict=True):
            found[k] = own
            if progress is not None:
                progress(len(found) * count // len(places), count)
    contacts = tuple(found[k] for k in range(len(positions)))
    _refuse_falling(problems, contacts)
    sampled = slice(count if means else 0, None)
    return Ltca(
        rated=torque,
        torque=torques,
        positions=positions[:count],
        arm=pair.arm,
        helices=pair.helices,
        contacts=contacts[:count],
        lines=tuple(map(_line_loads, positions[:count], problems[:count], contacts[:count])),
        compliance=compliance.model,
        sampled=Sampled(parts_of, positions[sampled], contacts[sampled]),
    )


def contact_problems(
    pair: GearPair, positions: Sequence[MeshPosition], compliance: PairCompliance
) -> tuple[ToothContact, ...]:
    """Return the contact problems of positions, with every point of every line that may close.

    Raises
    ------
    Refused
        If a position has no contact line.
    """
    for position in positions:
        if not position.lines:
            raise Refused(
                f"no pair of teeth meets at phase {position.phase:.4g} of the mesh cycle "
                f"(transverse contact ratio {pair.contact_ratio:.4g}); longer teeth, or a smaller "
                "centre distance, bring them into contact"
            )
    driver, driven = (
        tuple(tuple(Flank(line.pair * step, at(line)) for line in p.lines) for p in positions)
        for step, at in ((1, DRIVER), (pair.driven_step, DRIVEN))
    )
    bulks = zip(compliance.driver.bulks(driver), compliance.driven.bulks(driven), strict=True)
    strips = _strips(pair, [line for position in positions for line in position.lines], compliance)
    return tuple(
        ToothContact(
            bulk=one + other,
            gap=np.concatenate([line.gap for line in position.lines]),
            lines=tuple(islice(strips, len(position.lines))),
            name=f"phase {position.phase:.4g}",
        )
        for position, (one, other) in zip(positions, bulks, strict=True)
    )


def _strips(
    pair: GearPair, lines: Sequence[ContactLine], compliance: PairCompliance
) -> Iterator[StripLine]:
    """Yield the local contact of lines, computed for all of them at once as far as possible."""
    ends = np.cumsum([len(line.length) for line in lines])[:-1]
    along, across = (
        np.concatenate([getattr(line, name) for line in lines])
        for name in ("curvature_along", "curvature")
    )
    depths = (
        np.split(gear.depth(np.concatenate([at(line) for line in lines])), ends)
        for gear, at in ((compliance.driver, DRIVER), (compliance.driven, DRIVEN))
    )
    factors = np.split(width_factor(along, across), ends)
    for line, factor, *depth in zip(lines, factors, *depths, strict=True):
        yield StripLine(
            length=line.length,
            curvature=line.curvature,
            curvature_along=line.curvature_along,
            modulus=(pair.driver.gear.youngs_modulus, pair.driven.gear.youngs_modulus),
            poisson=(pair.driver.gear.poisson, pair.driven.gear.poisson),
            depth=(depth[0], depth[1]),
            factor=factor,
            face_width=min(pair.driver.gear.face_width, pair.driven.gear.face_width),
        )


def _groups(problems: Sequence[ToothContact], loads: int) -> Iterator[list[int]]:
    """Yield the numbers of problems solved at once: of equally many points, and not too many."""
    sizes = [len(problem.gap) for problem in problems]
    for size in sorted(set(sizes)):
        alike = [k for k, own in enumerate(sizes) if own == size]
        most = max(1, BATCH // (loads * size**2))
        for start in range(0, len(alike), most):
            yield alike[start : start + most]


def _under_all(problems: Sequence[ToothContact], loads: Array) -> Iterator[tuple[Contact, ...]]:
    """Yield the contacts of every problem under all loads, solved together.

    Starting from uniform forces takes no more passes than starting from those under another load.
    """
    every = np.repeat(np.arange(len(problems)), len(loads))
    batch = ContactBatch(problems).rows(every)
    found = iter(solve_contacts(batch, np.tile(loads, len(problems))))
    for _ in problems:
        yield tuple(islice(found, len(loads)))


def _refuse_falling(
    problems: Sequence[ToothContact], contacts: Sequence[tuple[Contact, ...]]
) -> None:
    """Refuse teeth that would yield less under more load.

    Where a contact is much wider than the depth to the middle surface, as at a thin tip, the
    displacement subtracted for the half-space below that depth exceeds that of the surface.
    """
    for problem, row in zip(problems, contacts, strict=True):
        steps = np.diff([contact.approach for contact in row])
        if steps.min() <= 0.0 or min(contact.tangent for contact in row) <= 0.0:
            raise Refused(
                f"{problem.name}: the teeth would yield less under more load, because the contact "
                "is wider than the tooth is thick there; use a thicker tip or less torque"
            )


def _line_loads(
    position: MeshPosition, problem: ToothContact, contacts: Sequence[Contact]
) -> tuple[tuple[LineLoad, ...], ...]:
    """Return the contacts under every load, line by line."""
    force = np.stack([contact.force for contact in contacts])
    distance = np.stack([contact.distance for contact in contacts])
    by_line = []
    for line, strips, part in zip(position.lines, problem.lines, problem.parts, strict=True):
        own = force[:, part]
        by_line.append(
            [
                LineLoad(line, *values)
                for values in zip(
                    own, strips.widths(own), strips.pressure(own), distance[:, part], strict=True
                )
            ]
        )
    return tuple(zip(*by_line, strict=True))
