"""The claim of a position in plain numbers: all that its certificate needs besides the case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from loadshare.case.table import Table
from loadshare.settings import ALLOWED
from loadshare.train.equilibria import Names, carried
from loadshare.train.equilibrium import Equilibrium, Range
from loadshare.train.train import Train

Pair = tuple[float, float]
Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Claim:
    """All displacements and forces of one position that its certificate needs.

    Attributes
    ----------
    rotation : mapping of gear to float
        φ [rad], positive in the running sense.
    displacement : mapping of gear to (float, float, float)
        p [m], in global coordinates.
    flank_force : mapping of flank to float
        [N].
    ring_force : mapping of contact to float
        Of every arc and stop [N].
    radial_reaction : mapping of element to (float, float, float)
        Force of every spline and round ring on its gear [N], in global coordinates.
    shaft_torque : mapping of shaft to float
        Of every elastic shaft, from its first gear to its second [N·m].
    support_force : mapping of gear to (float, float)
        On every bearing [N], in the gear's transverse frame.
    slip : mapping of gear to (float, float, float), or None
        Slip of every spline at the previous position [m]; None without splines that remember it.
    """

    rotation: Mapping[str, float]
    displacement: Mapping[str, Triple]
    flank_force: Mapping[str, float]
    ring_force: Mapping[str, float]
    radial_reaction: Mapping[str, Triple]
    shaft_torque: Mapping[str, float]
    support_force: Mapping[str, Pair]
    slip: Mapping[str, Triple] | None

    def equilibrium(self, index: int, undetermined: Mapping[str, Range]) -> Equilibrium:
        """Return the claim as the equilibrium of position `index` (1-based)."""
        vectors = {
            name: {key: np.array(v) for key, v in getattr(self, name).items()}
            for name in ("displacement", "radial_reaction", "support_force")
        }
        return Equilibrium(
            index=index,
            rotation=self.rotation,
            flank_force=self.flank_force,
            ring_force=self.ring_force,
            shaft_torque=self.shaft_torque,
            undetermined=undetermined,
            **vectors,
        )

    def train(self, train: Train) -> Train:
        """Return the train at this position, with the slip from which it starts."""
        if self.slip is None:
            return train
        return train.remembering({gear: np.array(s) for gear, s in self.slip.items()})


def claim_of(train: Train, found: Equilibrium) -> Claim:
    """Return the claim of an equilibrium; forces that it lacks follow from displacements."""
    torque, force = carried(train, found)
    return Claim(
        rotation=_plain(found.rotation),
        displacement=_tuples(found.displacement),
        flank_force=_plain(found.flank_force),
        ring_force=_plain(found.ring_force),
        radial_reaction=_tuples(found.radial_reaction),
        shaft_torque=Table(torque),
        support_force=_tuples(force),
        slip=_tuples(train.slip) if train.slip else None,
    )


def misnamed(train: Train, claim: Claim) -> Iterator[tuple[str, str, str]]:
    """Yield names that a claim lacks or must not have for a train: field, name, what is wrong."""
    known = _names(train, memory=claim.slip is not None)
    if claim.slip is not None and not train.splines:
        yield "slip", "", "is not known: no spline holds a gear"
    for name in (f.name for f in fields(Claim)):
        there: Mapping[str, object] = getattr(claim, name) or {}
        yield from ((name, key, "is missing") for key in known[name] if key not in there)
        yield from ((name, key, "is not known") for key in there if key not in known[name])


def oversized(claim: Claim) -> Iterator[tuple[str, str, float]]:
    """Yield figures whose products may overflow: field, name, value."""
    for field in fields(Claim):
        for name, given in (getattr(claim, field.name) or {}).items():
            value = max(given, key=abs) if isinstance(given, tuple) else given
            if not abs(value) <= ALLOWED.largest:
                yield field.name, name, value


def _names(train: Train, *, memory: bool) -> dict[str, tuple[str, ...]]:
    """Return the names under which each field of a claim must hold a figure, and no others."""
    names = Names(train)
    stops = tuple(s.stop_name for s in train.splines.values()) if memory else ()
    return {
        "rotation": names.gears,
        "displacement": names.gears,
        "flank_force": names.flanks,
        "ring_force": names.contacts,
        "radial_reaction": (*(name for name, _ in names.radials), *stops),
        "shaft_torque": tuple(n for n, s in train.shafts.items() if not math.isinf(s.stiffness)),
        "support_force": tuple(n for n, g in train.gears.items() if g.support is not None),
        "slip": tuple(train.splines) if memory else (),
    }


def _plain(figures: Mapping[str, float]) -> dict[str, float]:
    return Table({name: float(value) for name, value in figures.items()})


def _tuples(vectors: Mapping[str, np.ndarray]) -> dict[str, Any]:
    return Table({k: tuple(float(part) for part in vector) for k, vector in vectors.items()})
