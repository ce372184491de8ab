"""What was measured must be something that is computed."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.measured import COEFFICIENTS
from loadshare.case.words import choices, did_you_mean
from loadshare.errors import Problem

SYSTEM = "system"


def check_measured_names(draft: Draft) -> Iterator[Problem]:
    """Yield measured figures of meshes or stages that do not exist or are in no stage."""
    shared = [m for stage in draft.stages.values() for m in stage.meshes]
    for name, measurement in draft.measured.items():
        for quantity in ("torque", *COEFFICIENTS):
            known = draft.names("meshes") if quantity == "torque" else shared
            what = "a mesh" if quantity == "torque" else "a mesh of a stage"
            if quantity.endswith("omega"):
                known, what = [*draft.names("stages"), SYSTEM], "a stage"
            for key in getattr(measurement, quantity) or ():
                if known and key not in known:
                    path = ("measured", name, quantity, key)
                    hint = did_you_mean(key, known)
                    yield draft.problem(path, f'"{key}" is not {what}', choices(known), hint)


def check_measured_positions(draft: Draft) -> Iterator[Problem]:
    """Yield measurements at positions that the case does not have."""
    if draft.operating is None:
        return
    count = draft.operating.positions if draft.march is None else draft.march.steps
    for name, measurement in draft.measured.items():
        if measurement.position is not None and measurement.position > count:
            path = ("measured", name, "position")
            yield draft.problem(path, f"the case has {count}", f"1 to {count}, or left out")
