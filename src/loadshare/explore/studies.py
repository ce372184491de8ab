"""Studies that workers do for a page: sweeps, critical values, slopes."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

from loadshare.errors import CaseError, LoadshareError
from loadshare.explore.questions import Along, Slopes
from loadshare.numbers import MICROMETRE, NONE, omega, significant
from loadshare.report.words import boundary_name
from loadshare.study.events import Event

Plain = dict[str, Any]
Item = TypeVar("Item")


def reporting_errors(work: Callable[[Item], Plain]) -> Callable[[Item], Plain]:
    """Return a function that returns the answer of `work`, or its errors as messages."""

    @wraps(work)
    def answered(item: Item) -> Plain:
        try:
            return work(item)
        except CaseError as error:
            return {"messages": [str(problem) for problem in error.problems]}
        except LoadshareError as error:
            return {"messages": str(error).splitlines()}
        except ValueError as error:
            return {"messages": [str(error)]}

    return answered


@reporting_errors
def criticals(question: Along) -> Plain:
    """Return every change of the active set along an input, with its exact value."""
    from loadshare.study.critical import critical

    ends = question.text(question.low), question.text(question.high)
    found = critical(question.case, question.keys, *ends, positions=[question.position])
    happens: dict[float, dict[str, None]] = {}
    for event in found.events:
        happens.setdefault(event.value, {})[event_text(event)] = None
    events = [
        {
            "value": value,
            "text": question.text(value),
            "label": f"{'; '.join(words)} at {significant(value, 4)} {question.unit}".strip(),
        }
        for value, words in happens.items()
    ]
    gaps = [[gap.start, gap.stop, gap.why] for gap in found.unproved]
    return {"events": events, "gaps": gaps, "confirmed": all(e.confirmed for e in found.events)}


def event_text(event: Event) -> str:
    """Return an event in an engineer's words: ``gear 5 leaves its ring (upper stop)``."""
    if event.gear and event.kind.startswith("float "):
        verb = event.kind.split()[1]
        where = boundary_name(event.element) if ": " in event.element else ""
        return f"gear {event.gear} {verb} its ring" + (f" ({where})" if where else "")
    return f"{f'gear {event.gear}' if event.gear else event.element}: {event.kind}"


@reporting_errors
def trace(question: Along) -> Plain:
    """Return Ω of every stage and the places of all floats along an input; gaps where refused."""
    from loadshare.study.sweep import sweep

    values = f"{question.text(question.low)}:{question.text(question.high)}:{question.points}"
    found = sweep(question.case, {question.keys: values}, positions=[question.position])
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


@reporting_errors
def rates(question: Slopes) -> Plain:
    """Return how the system's largest Ω changes with inputs: rows, each with a ranking effect."""
    from loadshare.study.sensitivity import sensitivity

    found = sensitivity(question.case, list(question.keys), positions=[question.position])
    reach = dict(zip(question.keys, question.reaches, strict=True))
    rows = []
    for item in found.inputs:
        cells = {}
        for side in found.sides:
            rate = found.omega[item.key, side]["system"] * item.value.factor
            error = found.omega_error[item.key, side]["system"] * item.value.factor
            cells[side] = 0.0 if abs(rate) <= error else rate
        # One side may have no rate: at the end of an input's range.
        effect = max((r for r in cells.values() if math.isfinite(r)), key=abs, default=0.0)
        effect *= reach[item.key]
        texts = list(dict.fromkeys(map(_slope, cells.values())))
        per = f"per {item.value.unit}" if item.value.unit else "per 1"
        slope = f"{' | '.join(texts)} {per}"
        rows.append([[item.key, slope, omega(effect) if effect else "0"], abs(effect)])
    return {"rows": rows, "notes": [remark.message for remark in found.remarks][:3]}


def _slope(rate: float) -> str:
    if not math.isfinite(rate):
        return NONE
    return f"{rate:+.3g}" if rate else "0"
