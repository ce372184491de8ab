"""The certificate of a contact: recomputed from compliance, gap and contact law alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from loadshare.settings import TEETH
from loadshare.tooth.contact.problem import ContactBatch
from loadshare.tooth.geometry.body import Array


@dataclass(frozen=True, slots=True)
class ContactCertificate:
    """Verdict on a claimed contact.

    Attributes
    ----------
    residuals : mapping of str to float
        Scaled by the load P and the largest deflection: "pull" (p < 0), "penetration" (d < 0),
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


def certify_contacts(
    batch: ContactBatch,
    load: Array,
    force: Array,
    approach: Array,
    tolerance: float = TEETH.tolerance,
) -> tuple[ContactCertificate, ...]:
    """Judge forces (K, N) [N] and approaches (K,) [m] claimed for loads (K,) [N].

    A wrong answer raises no error; values that are not finite fail.
    """
    with np.errstate(invalid="ignore"):
        yielded = batch.yielded(force)
        distance = yielded + batch.gap - approach[:, None]
        deflection = np.abs(yielded).max(axis=1)
        deflection = np.where(deflection > 0.0, deflection, TEETH.least_deflection)
        found = {
            "pull": np.max(-force, axis=1) / load,
            "penetration": np.max(-distance, axis=1) / deflection,
            "complementarity": np.sum(np.abs(force * distance), axis=1) / (load * deflection),
            "balance": np.abs(np.sum(force, axis=1) - load) / load,
        }
    finite = np.isfinite(force).all(axis=1) & np.isfinite(approach)
    return tuple(
        ContactCertificate(
            {n: max(float(v[k]), 0.0) if finite[k] else np.inf for n, v in found.items()},
            tolerance,
        )
        for k in range(len(approach))
    )
