"""What workers do for a page: sweeps, critical values, slopes, pieces of tolerance studies."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

from loadshare.case import Case
from loadshare.errors import CaseError, LoadshareError
from loadshare.report.numbers import omega, significant
from loadshare.report.units import MICROMETRE
from loadshare.report.words import boundary_name
from loadshare.settings import CERTIFY, JOB
from loadshare.study.event import Event

Plain = dict[str, Any]
STUDY = "explorer"
"""Name of a tolerance study that a page asks for."""


class Asked(NamedTuple):
    """A question about a setting.

    Attributes
    ----------
    case : Case
    keys : tuple of str
        Inputs that take one value; or by which is differentiated.
    low, high : float
        Ends of the range, in `unit`.
    unit : str
    points : int
        Of a sweep.
    position : int
        1-based.
    reaches : tuple of float
        By which inputs move in a comparison of sensitivities, in their own units.
    """

    case: Case
    keys: tuple[str, ...]
    low: float = 0.0
    high: float = 0.0
    unit: str = ""
    points: int = 2
    position: int = 1
    reaches: tuple[float, ...] = ()

    def text(self, number: float) -> str | float:
        """Return a value as a case file has it."""
        return f"{number!r} {self.unit}" if self.unit else number


def safely(work: Callable[[Asked], Plain], asked: Asked) -> Plain:
    """Return what was found, or why nothing was."""
    try:
        return work(asked)
    except CaseError as error:
        return {"messages": [str(problem) for problem in error.problems]}
    except LoadshareError as error:
        return {"messages": str(error).splitlines()}
    except ValueError as error:
        return {"messages": [str(error)]}


def criticals(asked: Asked) -> Plain:
    """Every change of the active set along an input, with its exact value."""
    from loadshare.study.critical import critical

    found = critical(
        asked.case,
        asked.keys,
        asked.text(asked.low),
        asked.text(asked.high),
        positions=[asked.position],
    )
    told: dict[float, dict[str, None]] = {}
    for event in found.events:
        told.setdefault(event.value, {})[event_told(event)] = None
    events = [
        {
            "value": value,
            "text": asked.text(value),
            "told": f"{'; '.join(words)} at {significant(value, 4)} {asked.unit}".strip(),
        }
        for value, words in told.items()
    ]
    gaps = [[gap.start, gap.stop, gap.why] for gap in found.unproved]
    return {"events": events, "gaps": gaps, "confirmed": all(e.confirmed for e in found.events)}


def event_told(event: Event) -> str:
    """Return what happens, as an engineer says it: ``gear 5 leaves its ring (upper stop)``."""
    if event.gear and event.kind.startswith("float "):
        verb = event.kind.split()[1]
        where = boundary_name(event.element) if ": " in event.element else ""
        return f"gear {event.gear} {verb} its ring" + (f" ({where})" if where else "")
    return f"{f'gear {event.gear}' if event.gear else event.element}: {event.kind}"


def trace(asked: Asked) -> Plain:
    """Ω of every stage and the places of all floats along an input; gaps where there is none."""
    from loadshare.study.sweep import sweep

    low, high, count = asked.low, asked.high, asked.points
    values = f"{asked.text(low)}:{asked.text(high)}:{count}"
    found = sweep(asked.case, {asked.keys: values}, positions=[asked.position])
    lines: dict[str, list[float | None]] = {}
    places: dict[str, list[list[float]]] = {}
    results = [point.result for point in found.points]
    first = next((result for result in results if result is not None), None)
    for stage in first.stages if first else ():
        lines[stage] = [result.omega[stage] if result else None for result in results]
    for gear in first.positions[0].floats if first else ():
        moved = [r.positions[0].displacement[gear] for r in results if r]
        places[gear] = [[round(MICROMETRE.of(v), 4) for v in place] for place in moved]
    messages = [p.message for p in found.points if p.message]
    return {
        "x": list(found.grids[0]),
        "lines": lines,
        "places": places,
        "messages": messages[:1],
        "refused": len(messages),
    }


def slopes(asked: Asked) -> Plain:
    """How the largest Ω of the system moves with inputs, the most telling first."""
    from loadshare.study.sensitivity import sensitivity

    found = sensitivity(asked.case, list(asked.keys), positions=[asked.position])
    reach = dict(zip(asked.keys, asked.reaches, strict=True))
    rows: list[tuple[str, str, float]] = []
    for item in found.inputs:
        cells = {}
        for side in found.sides:
            rate = found.omega[item.key, side]["system"] * item.value.factor
            error = found.omega_error[item.key, side]["system"] * item.value.factor
            cells[side] = rate if math.isfinite(rate) and abs(rate) > error else 0.0
        effect = max(cells.values(), key=abs) * reach.get(item.key, 0.0)
        texts = list(dict.fromkeys(f"{rate:+.3g}" if rate else "0" for rate in cells.values()))
        per = f"per {item.value.unit}" if item.value.unit else "per 1"
        rows.append((item.key, f"{' | '.join(texts)} {per}", effect))
    rows.sort(key=lambda row: -abs(row[2]))
    columns = [["input", False], ["Ω rises by", True], ["over a tenth of its slider", True]]
    return {
        "columns": columns,
        "rows": [[key, told, omega(effect) if effect else "0"] for key, told, effect in rows],
        "notes": [r.message for r in found.remarks][:3],
    }


class Piece(NamedTuple):
    """A piece of a tolerance study.

    Attributes
    ----------
    case : Case
    spreads : str
        Distribution of every input by its key, as JSON.
    samples, seed : int
    first, rows : int
        Samples of this piece, from 0.
    """

    case: Case
    spreads: str
    samples: int
    seed: int
    first: int
    rows: int


def samples(piece: Piece) -> Plain:
    """Largest Ω of some samples, those of `loadshare.tolerance` with the same seed."""
    import numpy as np

    try:
        solver, design = _study(piece.case.to_toml(), piece.spreads, piece.samples, piece.seed)
    except CaseError as error:
        return {"messages": [str(problem) for problem in error.problems]}
    block, at = divmod(piece.first, JOB.block)
    values = design.values(block)[at : at + piece.rows]
    found = solver.solve(values)
    largest = found.columns["omega.system"]
    known = largest[~np.isnan(found.residual)]
    return {
        "values": known.tolist(),
        "done": len(values),
        "refused": len(values) - len(known),
        "messages": list(found.message.values())[:1],
    }


@lru_cache(maxsize=2)
def _study(text: str, spreads: str, count: int, seed: int) -> Any:
    """Return what solves the samples of a study, and their design."""
    import tomllib

    from loadshare.job.positions import wanted_positions
    from loadshare.study.tolerance.design import Drawn
    from loadshare.study.tolerance.figures import Solver
    from loadshare.study.tolerance.inputs import read_inputs
    from loadshare.train import build_train

    whole = {"kind": "tolerance", "inputs": json.loads(spreads), "samples": count, "seed": seed}
    case = Case(tomllib.loads(text)).replace({f"study.{STUDY}": whole})
    inputs, train = read_inputs(case, STUDY), build_train(case)
    positions: Sequence[int] = wanted_positions(train, None)
    engine = "vectorised"
    solver = Solver(case, train, inputs, tuple(positions), CERTIFY.tolerance, engine)
    return solver, Drawn(inputs, count, seed, "random")
