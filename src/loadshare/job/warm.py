"""Compile the code for many samples ahead of time, for container images and shared machines."""

from __future__ import annotations

import tomllib

from loadshare import compilation
from loadshare.case import Case
from loadshare.case.starter import starter_case
from loadshare.job.many import solve_many


def warm() -> str | None:
    """Compile the kernels that are not kept on disk; one to three minutes of processor time.

    Returns
    -------
    str or None
        Why nothing could be compiled or kept; None if all is there.
    """
    # Nothing is checked beforehand: code that is there is read in a moment, and a batch calls all
    # that has to be there.
    case = Case(tomllib.loads(starter_case("warm", "split-path")))
    assert case.operating is not None
    torque = case.operating.input_torque[0]
    solve_many(case, {"operating.torque [N*m]": [torque, 0.5 * torque]}, engine="compiled")
    return compilation.why_not()
