"""One random train solved, timed, and compared with the 50-digit reference at every position."""

from __future__ import annotations

import math
import time
import traceback
import warnings
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

import loadshare as ls
from benchmarks.limit import TooLong, limited
from benchmarks.random_trains.bounded import below_error
from benchmarks.random_trains.far import is_far, is_far_before
from benchmarks.random_trains.play import play
from benchmarks.reference import NoReference, Reference
from benchmarks.reference.machine import Machine
from benchmarks.reference.settle import Settled
from benchmarks.reference.solve import report, settled_in_digits
from benchmarks.stress.truth import truth_of
from loadshare.case import Case
from loadshare.errors import CaseError, Refused
from loadshare.results.result import Position
from loadshare.train import Train, build_train
from loadshare.train.placed import train_at
from loadshare.train.situations import situation_of

AGREES = 1e-9
"""Largest error of a certified torque, over the largest torque of its position."""
PLACED = 1e-6
"""Largest error of a determined place, over the deflection of a flank under the whole load or the
largest displacement: with soft supports, correct torques may still give such errors."""
OPEN = 1e-5
"""Play, in deflections, from which on a place counts as open: ten times the tolerance of the linear
programmes that find it."""
BEYOND = "displacements are too large for the geometry"
"""Text of the refusal when displacements are not small."""
NO_FORCE = 1e-40
"""Force, over the load, that counts as zero in 70 digits."""
NO_TORQUE = 1e-26
"""Torque [N·m] that counts as zero: below it, which elements act depends on the last of the
reference's 50 digits."""
SOLVING, REFERRING = 60.0, 60.0
"""Processor time that a solve and a reference may take [s]."""


@dataclass
class Finding:
    """The result at one position.

    Attributes
    ----------
    position : int
    outcome : str
        "agrees", "wrong", "unchecked" (certified, without reference), "refused" (has an answer),
        "too far" (refused, and its displacements have no meaning, perhaps already at a part of the
        load), "no answer" (refused, and known to have none), "open" (refused, neither is known),
        "crashed".
    told : str
        Text of the refusal or exception, or the reason why there is no reference.
    rung : str
    error : float or None
        Error of the worst torque, over the largest torque.
    misplaced : dict of coordinate to float
        Error of places that are wrongly given as determined, in deflections; infinite if they are
        open.
    bound : list of [float, float]
        Claimed bound and true error of every torque, and of the worst of them [N·m].
    others : int
        Bounds on forces and places that were compared with true errors.
    below : dict of element or coordinate to [float, float]
        The bounds among them that are below the true error: bound and error, [N] and [m].
    slack : float or None
        Distance of the reference from a change of its active set.
    reference : str
        "found", or the reason why not.
    """

    position: int
    outcome: str = ""
    told: str = ""
    rung: str = ""
    error: float | None = None
    misplaced: dict[str, float] = field(default_factory=dict)
    bound: list[list[float]] = field(default_factory=list)
    others: int = 0
    below: dict[str, list[float]] = field(default_factory=dict)
    slack: float | None = None
    reference: str = ""


def judged(case: Case) -> dict[str, Any]:
    """Solve a train and compare it; return plain data, with the processor time of the solve [s]."""
    findings, seconds, train = [], math.nan, None
    solved: dict[int, Position] = {}
    message, crashed = "", ""
    start = time.process_time()
    try:
        with limited(SOLVING), warnings.catch_warnings():
            warnings.simplefilter("error")
            solved = _by_index(ls.solve(case))
    except Refused as refusal:
        message = str(refusal)
        solved = _by_index(refusal.partial) if refusal.partial is not None else {}
    except CaseError as refusal:
        message = crashed = f"invalid: {refusal}"
    except TooLong:
        message = f"took more than {SOLVING:g} s"
    except Exception:  # noqa: BLE001 -- whatever escapes is a crash, and what is looked for
        crashed = traceback.format_exc(limit=-4)
    seconds = time.process_time() - start
    train = None if crashed.startswith("invalid") else build_train(case)
    for index in range(1, case.operating.positions + 1):
        finding = Finding(index)
        if crashed:
            finding.outcome, finding.told = "crashed", crashed
        elif train is not None:
            why = _message_of(message, index)
            _compare(case, train_at(train, index), solved.get(index), why, finding)
        findings.append(asdict(finding))
    return {"name": case.name, "seconds": seconds, "positions": findings}


def _by_index(result: ls.Result) -> dict[int, Position]:
    return {p.position: p for p in result.positions}


def _message_of(message: str, index: int) -> str:
    lines = [t for t in message.splitlines() if t.startswith(f"position {index}:")]
    return "\n".join(lines) or message


def _compare(
    case: Case, train: Train, found: Position | None, message: str, finding: Finding
) -> None:
    """Judge one position; write the result into `finding`."""
    machine, settled = _settled(case, train, found, finding)
    if found is None:
        finding.told = message
        if machine is not None and settled is not None:
            far = is_far(train, finding.position, report(train, machine, settled))
            finding.outcome = "too far" if BEYOND in message and far else "refused"
        elif BEYOND in message:
            finding.outcome = "too far"
        elif not solvable(train, finding.position):
            finding.outcome = "no answer"
        else:
            finding.outcome = "too far" if is_far_before(train, finding.position) else "open"
        return
    finding.rung = found.effort.rung
    if machine is None or settled is None:
        finding.outcome = "unchecked"
        return
    exact = report(train, machine, settled)
    largest = max(map(abs, exact.torque.values()), default=0.0)
    errors = {n: abs(found.torque[n] - t) for n, t in exact.torque.items()}
    finding.error = max(errors.values()) / (largest if largest > NO_TORQUE else 1.0)
    finding.outcome = "agrees" if finding.error <= AGREES else "wrong"
    finding.slack = exact.slack
    finding.misplaced = misplaced(train, found, exact, machine, settled)
    claimed = found.certificate.bound.torque
    finding.bound = [[claimed[n], error] for n, error in errors.items()]
    # The bound proved first is relative to the largest torque of all flanks, including coast
    # flanks.
    radii = {m.flank_name(d): m.first_radius for m in train.meshes.values() for d in m.flanks}
    driving = np.abs(situation_of(train, finding.position).torque).max(initial=0.0)
    every = [abs(f) * radii[flank] for flank, f in found.claim.flank_force.items()]
    finding.bound.append([found.certificate.proved * max(driving, *every), max(errors.values())])
    finding.others, finding.below = below_error(train, found, machine, settled)


def _settled(
    case: Case, train: Train, found: Position | None, finding: Finding
) -> tuple[Machine, Settled] | tuple[None, None]:
    """Return the reference, started from the answer, which saves time, or without a start."""
    hints = [None] if found is None else [ls.explain(case, finding.position).equilibrium, None]
    for hint in hints:
        try:
            with limited(REFERRING):
                machine, settled = settled_in_digits(train, finding.position, hint)
        except (NoReference, ArithmeticError) as failure:
            finding.reference = str(failure)
        except TooLong:
            finding.reference = f"took more than {REFERRING:g} s"
        else:
            finding.reference = "found"
            return machine, settled
    return None, None


def solvable(train: Train, index: int) -> bool:
    """Return whether forces balance the load and the limits leave a place; True if unknown."""
    try:
        return truth_of(train, index).solvable
    except (ValueError, RuntimeError):
        return True


def _play_in_report(train: Train, spans: Mapping[str, float]) -> dict[str, float]:
    """Return the play of reported places, along `Gear.plane`, from spans along `Gear.frame`."""
    found = dict(spans)
    for name, gear in train.gears.items():
        keys = [f"gear {name} {axis}" for axis in "xy"]
        along = np.array([found.pop(key, 0.0) for key in keys]) if gear.is_tilted else None
        if along is not None and along.any():
            weights = np.abs(gear.plane @ gear.frame.T)
            weights[:, along == 0.0] = 0.0
            finite = np.where(np.isinf(along), 1e300, along)
            reach = np.where(weights > 1e-9, weights, 0.0) @ finite
            found |= {k: float(t) for k, t in zip(keys, reach, strict=True) if t > 0.0}
    return found


def misplaced(
    train: Train, found: Position, exact: Reference, machine: Machine, settled: Settled
) -> dict[str, float]:
    """Return places given as determined that are open, or elsewhere; error in deflections.

    A place is elsewhere if it is off by more than `PLACED` and by more than its own bound.
    """
    named, bounds = set(found.undetermined), found.certificate.bound.place
    free = _play_in_report(train, play(machine, settled.at, NO_FORCE))
    # A place that is held only by forces of the size of round-off may be reported either way.
    loose = _play_in_report(train, play(machine, settled.at, 1e-9))
    wrong = {
        name: math.inf
        for name, span in free.items()
        if span > OPEN and name not in named and not name.endswith("rotation")
    }
    moved = max((abs(float(v)) for d in exact.displacement.values() for v in d), default=0.0)
    scale = max(moved, machine.length)
    for gear, along in exact.displacement.items():
        place = train.gears[gear].in_plane(np.array([float(v) for v in along]))
        for axis, k in ("x", 0), ("y", 1):
            name = f"gear {gear} {axis}"
            error = abs(found.displacement[gear][k] - float(place[k]))
            off = error > max(PLACED * scale, bounds[f"{gear} {axis}"])
            if off and name not in named and loose.get(name, 0.0) <= OPEN:
                wrong[name] = error / scale
    return wrong
