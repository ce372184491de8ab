"""A tolerance study part by part, so that a page sees it grow and can stop it.

Its samples, its answers and its statistics are those of `loadshare.tolerance` with the same seed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.case.keys import dotted
from loadshare.case.writer import toml_text
from loadshare.explore.answer import plain
from loadshare.explore.inputs import PageInput, PageInputs
from loadshare.explore.questions import finite, place, with_keys_written
from loadshare.explore.request import RequestError, number, setting, text
from loadshare.explore.studies import Plain, reporting_errors
from loadshare.job.engines import is_available
from loadshare.job.positions import prepared
from loadshare.settings import EXPLORE, JOB, TOLERANCE
from loadshare.study.parameter import Value, read_value
from loadshare.study.tolerance.figures import KINDS, SYSTEM
from loadshare.study.tolerance.job import SAMPLES, known_job
from loadshare.study.tolerance.statistics import OmegaStatistics, apart_kinds, omega_statistics
from loadshare.study.tolerance.study import requested_job
from loadshare.table import Cell, Column, Table

SHOWN = "explorer"
"""Name of a study in which the inputs shown by the page scatter."""
EVENLY = ("m", "rad", "")
"""SI units of clearances, errors and friction, which scatter evenly over their sliders."""
DEVIATION, CUT = 0.02, 3.0
"""For all others: standard deviation over the value, and deviations at which it is cut off."""
PROBLEMS = 3
"""Number of reasons for refusals that are shown."""


class Scatter(NamedTuple):
    """A tolerance study that a page asks for.

    Attributes
    ----------
    case : Case
    name : str
    table : dict
        As in ``[study.NAME]``.
    left : tuple of str
        Inputs that are shown but do not scatter.
    """

    case: Case
    name: str
    table: dict[str, Any]
    left: tuple[str, ...]


def scatter(inputs: PageInputs, body: Mapping[str, Any]) -> Scatter:
    """Return the study of the case that a page names, or one of the inputs that it shows.

    Raises
    ------
    RequestError
        If there is no such study, or the request is not valid.
    CaseError
        If a key or the setting cannot be used.
    """
    given = setting(body)
    if body.get("study") is None:
        name, (case, table, left) = SHOWN, _of_shown(inputs, body, given)
    else:
        name, case, left = text(body, "study"), with_keys_written(inputs, (), given), []
        table = case.to_dict().get("study", {}).get(name, {})
        if table.get("kind") != "tolerance":
            raise RequestError(400, "there is no such tolerance study")
    table["samples"] = number(body, "samples", TOLERANCE.samples, 1, EXPLORE.samples)
    table["seed"] = number(body, "seed", 0, 0, 2**53)
    if body.get("limit") is not None:
        table["limit"] = finite(body, "limit")
    return Scatter(case, name, table, tuple(left))


def _of_shown(
    inputs: PageInputs, body: Mapping[str, Any], given: Mapping[str, object]
) -> tuple[Case, dict[str, Any], list[str]]:
    ranges = body.get("ranges")
    if not isinstance(ranges, dict) or not ranges:
        raise RequestError(400, "ranges is not an object of [low, high] by input")
    left = [n for n in ranges if any(inputs.every[k].geometry for k in inputs.keys(n))]
    if len(left) == len(ranges):
        raise RequestError(
            400, f"only counts and geometry are shown ({', '.join(left)}); add an input that varies"
        )
    varied = {name: inputs.keys(name) for name in ranges if name not in left}
    # First, because it checks the values of the setting.
    case = with_keys_written(inputs, [key for keys in varied.values() for key in keys], given)
    spreads: dict[str, Any] = {}
    for name, keys in varied.items():
        ends = ranges[name]
        if not isinstance(ends, list) or len(ends) != 2:
            raise RequestError(400, f"the range of {name} is not [low, high]")
        low, high = (finite({name: end}, name) for end in ends)
        spreads["=".join(keys)] = _spread(inputs.every[keys[0]], given, low, high)
    table: dict[str, Any] = {"kind": "tolerance", "inputs": spreads}
    if prepared(case)[1].train.count > EXPLORE.together:
        table["positions"] = [place(body)]
    return case, table, left


def _spread(one: PageInput, given: Mapping[str, object], low: float, high: float) -> dict[str, Any]:
    """Return how an input scatters if the case does not give that."""
    now, unit = read_value(given.get(one.key, one.text)), one.unit
    if Value(1.0, unit).si_unit in EVENLY or now is None or now.number == 0.0:
        kind, numbers = "uniform", {"low": low, "high": high}
    else:
        mean = now.in_unit(unit).number
        deviation = DEVIATION * abs(mean)
        ends = {"low": mean - CUT * deviation, "high": mean + CUT * deviation}
        kind, numbers = "truncated normal", {"mean": mean, "deviation": deviation, **ends}
    given_numbers = {name: Value(number, unit).text for name, number in numbers.items()}
    return {"distribution": kind, **given_numbers}


@reporting_errors
def start_study(question: Scatter) -> Plain:
    """Check a study, and return what each of its parts needs and what the page shows of it."""
    # A page must not wait for a compiler.
    engine = "compiled" if is_available() else "vectorised"
    case = question.case.replace({dotted(("study", question.name)): question.table})
    job, block = requested_job(case, question.name, {}, engine=engine)
    settings = job.settings
    # The compiled engine solves a whole block in a moment; NumPy would keep the page waiting.
    rows = JOB.block if engine == "compiled" else EXPLORE.part // len(settings["positions"])
    return {
        "job": job.to_json(),
        "rows": max(rows, EXPLORE.least),
        "stages": [*(stage.name for stage in job.train.stages), SYSTEM],
        "levels": list(block.quantiles or TOLERANCE.levels),
        "limit": block.limit,
        "samples": settings["samples"],
        "replicated": settings["sampling"] == "sobol",
        "begun": {
            "name": question.name,
            "samples": settings["samples"],
            "seed": settings["seed"],
            "sampling": settings["sampling"],
            "positions": list(settings["positions"]),
            "limit": block.limit,
            "engine": engine,
            "left": list(question.left),
            "inputs": [[one.name, str(one.distribution)] for one in job.inputs.every],
            "toml": toml_text({"study": {question.name: question.table}}),
        },
    }


class SampleRange(NamedTuple):
    """Some samples of a study: its job as text, the first of them from 0, how many at most."""

    job: str
    first: int
    rows: int


def samples(part: SampleRange) -> Plain:
    """Draw and solve some samples, up to the end of a block at most."""
    job = known_job(part.job)
    block, at = divmod(part.first, JOB.block)
    values = job.designs[SAMPLES].values(block)[at : at + part.rows]
    found = job.solve(values)
    kept = tuple(f"{kind}." for kind in KINDS)
    return {
        "columns": {name: v for name, v in found.columns.items() if name.startswith(kept)},
        "residual": found.residual,
        "refused": [text.splitlines()[0] for text in found.message.values()],
    }


@dataclass
class Growing:
    """Figures of all samples so far.

    Attributes
    ----------
    study : mapping
        What `start_study` returned.
    """

    study: Mapping[str, Any]
    done: int = 0
    residual: float = 0.0
    refused: Counter[str] = field(default_factory=Counter)
    columns: dict[str, list[Array]] = field(default_factory=dict)

    def take(self, found: Mapping[str, Any]) -> None:
        """Add a part."""
        self.done += len(found["residual"])
        self.residual = max(self.residual, np.nanmax(found["residual"], initial=0.0))
        self.refused.update(found["refused"])
        for name, values in found["columns"].items():
            self.columns.setdefault(name, []).append(values)

    def column(self, name: str) -> Array:
        """Return a figure by sample, NaN where there is no answer."""
        return np.concatenate(self.columns[name])

    def statistics(self) -> Plain:
        """Return the statistics so far."""
        study, refused = self.study, self.refused.total()
        every = list(
            omega_statistics(
                self.column, study["stages"], study["levels"], study["limit"], study["replicated"]
            )
        )
        overs = [KINDS[kind] for kind in apart_kinds(self.column)]
        found: Plain = {"done": self.done, "refused": refused, "residual": f"{self.residual:.1e}"}
        found["reasons"] = [f"{n} × {text}" for text, n in self.refused.most_common(PROBLEMS)]
        shown = [one for one in every if one.over in overs]
        shown.sort(key=lambda one: (one.over, one.stage) != ("stage", SYSTEM))
        if shown:
            found["table"] = plain(omega_table(shown, study["limit"]))
            found["histogram"] = _histogram(next(one for one in shown if one.stage == SYSTEM))
        return found


def omega_table(every: Sequence[OmegaStatistics], limit: float | None) -> Table:
    """Return a table with a column for each Ω, as `loadshare tolerance` prints its figures."""
    form = ".5f"
    rows = [
        ["mean", *(one.summary.mean.text(form) for one in every)],
        ["standard deviation", *(f"{one.summary.spread:.2g}" for one in every)],
        *(
            [
                f"{100.0 * level:g} % quantile",
                *(one.summary.quantiles[level].text(form) for one in every),
            ]
            for level in every[0].summary.quantiles
        ),
        ["largest", *(f"{one.summary.highest:{form}}" for one in every)],
    ]
    if limit is not None:
        above = (one.exceedance.text(".4g") if one.exceedance else "" for one in every)
        rows.append([f"P(Ω > {limit:g})", *above])
    names = [f"{one.stage}, group" if one.over == "group" else one.stage for one in every]
    columns = [Column("Ω"), *(Column(name, figures=True) for name in names)]
    notes = [f"Intervals in brackets: {100.0 * TOLERANCE.confidence:g} %."]
    return Table("", columns, [[Cell(text) for text in row] for row in rows], notes)


def _histogram(one: OmegaStatistics) -> Plain:
    found = one.summary
    return {
        "edges": found.edges.tolist(),
        "counts": found.counts.tolist(),
        "marks": [[f"{100.0 * level:g} %", q.value] for level, q in found.quantiles.items()],
    }
