r"""The certificate of many claims: residuals, and one small matrix for all claims that act alike.

The bound is that of `quick` (see `groups`). Residuals are found by compiled code. Trains whose slip
is remembered are not covered. Source: formulation, section 16.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from loadshare.array_types import Array
from loadshare.certify.arrays import arrays_of
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.figures import ClaimFigures
from loadshare.certify.bound.groups import SharedData
from loadshare.certify.bound.layout import springs_of
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations


def is_covered(columns: Columns) -> bool:
    """Return whether this bound covers claims of a train."""
    return columns.train.slip is None


def judged(
    columns: Columns, situations: Situations, answers: Equilibria
) -> tuple[ClaimFigures, Array]:
    """Judge S claims with compiled code.

    Returns
    -------
    ClaimFigures
        With NaN where a figure is left to NumPy.
    ndarray, shape (S,)
        Largest error of a torque over the largest torque; infinite if none is shown.
    """
    from loadshare.certify.bound import kernel

    (spring, arm), pushed = springs_of(columns, situations), bool(situations.push.any())
    plan = _plans.get(columns)
    if plan is None or plan.key != (spring.tobytes(), pushed):
        plan = _plans[columns] = SharedData(columns, spring, arm, pushed)
    here, claim = arrays_of(situations, answers)
    claims = len(answers.rotation)
    found, sets = plan.found(claims), plan.sets(claims)
    count = kernel.find_all(plan.layout, here, claim, plan.work(), found, sets)
    acts = found.acts[sets.first[:count]]
    errors = np.empty_like(found.largest)
    groups = plan.groups(acts, sets.least[:count], sets.most[:count])
    kernel.bound_all(plan.layout, here, claim, found, groups, errors)
    with np.errstate(invalid="ignore"):
        return found, np.where(errors < np.inf, errors / found.largest + 2.0 * EPS, np.inf)


_plans: WeakKeyDictionary[Columns, SharedData] = WeakKeyDictionary()
