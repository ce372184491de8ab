"""Answers to a page's settings: figures as texts, as in report and console, and shapes to draw."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import astuple
from typing import Any

from loadshare.case import Case
from loadshare.case.keys import dotted
from loadshare.errors import CaseError, Refused
from loadshare.explore.inputs import PageInputs
from loadshare.explore.pictures import float_shapes, force_shapes, train_shapes
from loadshare.job import solve
from loadshare.job.positions import prepared
from loadshare.numbers import NONE, decimals, fixed, omega, small
from loadshare.report.flanks import carrying
from loadshare.report.palette import palette_of
from loadshare.report.verdict import measure_of, trust, verdict_tables
from loadshare.report.words import boundary_name
from loadshare.results import Position, Result
from loadshare.results.share import largest
from loadshare.settings import ALLOWED, EXPLORE
from loadshare.study.parameter import read_value
from loadshare.study.sweep import CERTIFIED, INVALID, PARTLY, REFUSED
from loadshare.table import Cell, Record, Table, table

Plain = dict[str, Any]
Setting = Mapping[str, object]
MOVING = ("gears.", "meshes.", "errors.", "operating.")
"""Beginnings of keys that may change the drawing of the train: its places, roles and colours."""


def setting_of(inputs: PageInputs, given: Setting) -> Case:
    """Return the case as a page has set it.

    Raises
    ------
    CaseError
        If it is not a valid case.
    """
    changes = inputs.changes(given)
    return inputs.case.replace(changes) if changes else inputs.case


def invalid(error: CaseError) -> Plain:
    """Return the messages on a setting that is not a valid case."""
    return {"status": INVALID, "messages": [str(problem) for problem in error.problems]}


def answer_of(inputs: PageInputs, given: Setting, position: int) -> Plain:
    """Solve a setting, at all positions if they are few, else at the one that is shown.

    Parameters
    ----------
    inputs : PageInputs
    given : mapping of str to object
        Inputs that differ from the case.
    position : int
        Position that is drawn, from 1; the last one if there are fewer.

    Raises
    ------
    CaseError
        If the setting is not a valid case.
    """
    return _answer(inputs, given, position, EXPLORE.together)[0]


def whole_of(inputs: PageInputs, given: Setting, position: int) -> Plain:
    """Return the same answer at all positions, and how far it can be trusted.

    This takes too long to follow a slider. It holds all that `answer_of` returns, so that a page
    can show it instead.
    """
    found, result = _answer(inputs, given, position, ALLOWED.positions)
    if result is None:
        return found
    found["trust"] = trust(result)
    if len(result.positions) > 1:
        stages = result.positions[0].train.stages
        every = [largest([p.share], stages) for p in result.positions]
        found["cycle"] = {
            "positions": [p.position for p in result.positions],
            "omega": {stage: [each[stage] for each in every] for stage in result.stages},
        }
    return found


def _answer(
    inputs: PageInputs, given: Setting, position: int, together: int
) -> tuple[Plain, Result | None]:
    """Return an answer and its result: at all positions if at most `together`, else at one."""
    case = setting_of(inputs, given)
    train = prepared(case)[1].train
    position = min(position, train.count)
    every = train.count <= together
    result, messages = _solved(case, None if every else [position])
    found: Plain = {
        "position": position,
        "count": train.count,
        "solved": train.count if every else 1,
        "messages": messages,
        "numbers": dict(_numbers(inputs, given)),
    }
    if any(key.startswith(MOVING) for key in given):
        found["train"] = train_shapes(case)
    if result is None:
        return {"status": REFUSED} | found, None
    shown = next((p for p in result.positions if p.position == position), None)
    found |= {
        "status": PARTLY if messages else CERTIFIED,
        "bound": _bound_text(result, found["solved"]),
        "measure": measure_of(result),
        "tables": [plain(t) for t in verdict_tables(result)],
        "bars": list(_bars(result, shown)),
    }
    if shown is not None:
        found["floats"] = list(float_shapes(result, shown))
        found["forces"] = list(force_shapes(train, shown))
        found["states"] = plain(states(shown))
    return found, result


def _numbers(inputs: PageInputs, given: Setting) -> Iterator[tuple[str, float]]:
    """Yield the numbers of a setting in the units of the case, which sliders use."""
    for key, value in given.items():
        read = read_value(value)
        if read is None:
            continue
        # A slider cannot show a value that its unit does not measure, such as a plain number.
        with suppress(ValueError):
            yield key, float(f"{read.in_unit(inputs.every[key].unit).number:.12g}")


def _solved(case: Case, positions: list[int] | None) -> tuple[Result | None, list[str]]:
    """Return the certified result, and why the rest was refused."""
    try:
        return solve(case, positions=positions), []
    except Refused as refusal:
        return refusal.partial, str(refusal).splitlines()


def _bound_text(result: Result, solved: int) -> str:
    """Return a sentence on how good an answer is: the bound proved when it was judged."""
    done, count = len(result.positions), result.positions[0].train.count
    where = f"{done} of {count} positions" if count > 1 else "the answer"
    later = "" if solved == count else " so far (all once no input moves)"
    proved = max(p.certificate.proved for p in result.positions)
    return (
        f"{where} certified{later}: every torque within {small(proved)} of that at the exact "
        "equilibrium, relative to the largest torque"
    )


def plain(found: Table) -> Plain:
    """Return a table as plain data, every cell as its text."""
    return {
        "title": found.title,
        "columns": [[column.title, column.figures] for column in found.columns],
        "rows": found.texts,
        "values": [[cell.value for cell in row] for row in found.rows],
        "notes": list(found.notes),
    }


def _bars(result: Result, shown: Position | None) -> Iterator[Plain]:
    """Yield Ω of every branch: the largest over the positions, and at the one that is shown."""
    palette = palette_of(result)
    for stage, meshes in result.stages.items():
        for mesh in meshes:
            known = [p.share[mesh] for p in result.positions]
            most = max((s for s in known if s is not None), default=None)
            here = shown.share[mesh] if shown else None
            yield {
                "stage": stage,
                "mesh": mesh,
                "colour": palette.mesh(mesh).colour,
                "most": most,
                "here": here,
                "text": omega(most),
            }


def states(shown: Position) -> Table:
    """Return the contact states at a position: flanks, boundaries of floats, splines."""
    rows = list(_states(shown))
    title = f"Contact states at position {shown.position}"
    words = ("element", "state")
    return table(title, rows, (*words, "force"), words, {"force": "force [N]"})


def _states(shown: Position) -> Iterator[Record]:
    floats, flanks = shown.floats.values(), list(carrying(shown))
    sizes = [*(f.force for f in flanks), *(t.force for f in floats for t in f.boundaries)]
    places = decimals(sizes)

    def row(element: str, state: str, size: float) -> Record:
        text = fixed(size, places) if size > 0.0 else NONE
        return {"element": Cell(element), "state": Cell(state), "force": Cell(text, size)}

    for name in shown.train.meshes:
        closed = [flank for flank in flanks if flank.mesh == name]
        for flank in closed:
            yield row(f"mesh {name}", f"{flank.side} closed", flank.force)
        if not closed:
            yield row(f"mesh {name}", "open", 0.0)
    for found in floats:
        touching = [touch for touch in found.boundaries if touch.touching]
        for touch in touching:
            yield row(f"gear {found.gear}", f"on {boundary_name(touch.name)}", touch.force)
        if not touching and found.boundaries:
            yield row(f"gear {found.gear}", found.state, 0.0)
        if found.spline:
            yield row(f"spline {found.gear}", found.spline, found.spline_force)


def case_of(inputs: PageInputs) -> Plain:
    """Return what a page must know about its case before anything is changed."""
    case = inputs.case
    train = prepared(case)[1].train
    return {
        "title": case.title or case.name,
        "name": case.name,
        "inputs": [list(astuple(one)) for one in inputs.every.values()],
        "tied": tied(inputs),
        "positions": train.count,
        "angles": angles(case),
        "stages": [stage.name for stage in train.stages],
        "floats": list(train.floating),
        "train": train_shapes(case),
        "studies": spreads(case),
    }


def tied(inputs: PageInputs) -> list[tuple[str, tuple[str, ...]]]:
    """Return names with a star, each with the inputs that take the same value under it."""
    found: dict[str, int] = {}
    for key in inputs.every:
        section, _, rest = key.partition(".")
        if not rest or section in ("operating", "march"):
            continue
        names = [n for n in getattr(inputs.case, section) if key.startswith(dotted((section, n)))]
        if names:
            name = f"{section}.*{key[len(dotted((section, max(names, key=len)))) :]}"
            found[name] = found.get(name, 0) + 1
    usable = []
    for name, times in found.items():
        if times > 1:
            try:
                usable.append((name, inputs.keys(name)))
            except CaseError:
                continue
    return usable


def angles(case: Case) -> list[float] | None:
    """Return how far the input gear has turned at each position [deg]; None if it does not turn."""
    train = prepared(case)[1].train
    if train.count > EXPLORE.most_points:
        return None
    turned = [train.rotations(k + 1)[train.input] for k in range(train.count)]
    return [round(math.degrees(angle), 6) for angle in turned] if any(turned) else None


def spreads(case: Case) -> dict[str, Plain]:
    """Return the tolerance studies of a case: their inputs and settings, as given in the file."""
    data = case.to_dict().get("study", {})
    return {name: one for name, one in data.items() if one.get("kind") == "tolerance"}
