"""The certificate of a contact: recomputed from compliance, gap and contact law alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.contact_problem import ContactProblem

TOLERANCE = 1e-9
"""Largest scaled residual of a certified contact."""


@dataclass(frozen=True, slots=True)
class ContactCertificate:
    """Verdict on a claimed contact.

    Attributes
    ----------
    residuals : mapping of str to float
        Scaled by the load P and the largest yielding: "pull" (p < 0), "penetration" (d < 0),
        "complementarity" (p·d) and "balance" (Σp − P).
    tolerance : float
    """

    residuals: Mapping[str, float]
    tolerance: float

    @property
    def worst(self) -> float:
        """Largest residual."""
        return max(self.residuals.values())

    @property
    def passed(self) -> bool:
        """Whether every residual is within the tolerance."""
        return self.worst <= self.tolerance

    @property
    def failing(self) -> dict[str, float]:
        """Residuals beyond the tolerance."""
        return {n: r for n, r in self.residuals.items() if not r <= self.tolerance}


def certify_contact(
    problem: ContactProblem,
    load: float,
    force: Array,
    approach: float,
    tolerance: float = TOLERANCE,
) -> ContactCertificate:
    """Judge the forces (N,) [N] and the approach [m] claimed for a load [N].

    Nothing is raised for a wrong answer; figures that are not numbers fail.
    """
    if not (np.isfinite(force).all() and np.isfinite(approach)):
        names = ("pull", "penetration", "complementarity", "balance")
        return ContactCertificate(dict.fromkeys(names, np.inf), tolerance)
    yielded = problem.yielded(force)
    distance = yielded + problem.gap - approach
    deflection = float(np.abs(yielded).max()) or 1e-6
    found = {
        "pull": float(np.max(-force)) / load,
        "penetration": float(np.max(-distance)) / deflection,
        "complementarity": float(np.sum(np.abs(force * distance))) / (load * deflection),
        "balance": abs(float(np.sum(force)) - load) / load,
    }
    return ContactCertificate({n: max(v, 0.0) for n, v in found.items()}, tolerance)
