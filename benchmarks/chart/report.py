"""The report on speed: what was measured, with what, and what the ratios are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.chart.measure import OURS, OURS_BATCH, OURS_SOLVE, Measure
from benchmarks.peers import PEERS

GOOD_WORST, GOOD_MEDIAN = 1e-9, 1e-12
"""Errors that a ratio asks of ours."""


@dataclass(frozen=True, slots=True)
class Ratio:
    """How many times faster ours is, and what was asked for; None for the record only."""

    workload: str
    ours: str
    peer: str
    wanted: float | None


WANTED = (
    *(
        Ratio(w, OURS_BATCH, peer, factor)
        for w in ("law", "study")
        for peer, factor in (
            ("CVXPY, parameters", 1000.0),
            ("Clarabel, update", 100.0),
            ("DAQP", 3.0),
        )
    ),
    *(Ratio(w, OURS_BATCH, "Clarabel, update", 30.0) for w in ("splines-law", "all")),
    *(
        Ratio(w, OURS_SOLVE, "CVXPY, rebuilt", 20.0)
        for w in ("rings", "splines", "law", "splines-law", "all")
    ),
    *(
        Ratio(w, OURS_BATCH, peer, None)
        for w in ("rings", "splines")
        for peer in ("CVXPY, parameters", "Clarabel, update", "DAQP")
    ),
)
"""What was asked for, with the nonlinear law; linear laws, which need fewer passes, on record."""


def speed_report(
    measures: Sequence[Measure],
    scaling: Sequence[Measure],
    titles: Mapping[str, str],
    facts: Mapping[str, str],
    memory: Mapping[str, float],
    seconds: float,
    quick: bool,
) -> str:
    """Write the report.

    Parameters
    ----------
    measures : sequence of Measure
        Of the seed's workloads.
    scaling : sequence of Measure
        Of 4 to 64 branches.
    titles : mapping of str
        Of the workloads.
    facts : mapping of str
        Versions, processor, date.
    memory : mapping of str to float
        Equilibria, seconds and largest memory [MiB] of the long run; empty where it was left out.
    seconds : float
        Of the whole measurement.
    quick : bool

    Returns
    -------
    str
        Markdown.
    """
    missing = [e.name for e in PEERS.values() if e.missing]
    lines = [
        "# Speed against accuracy",
        "",
        f"Measured by `python -m benchmarks.chart{' --quick' * quick}` in {seconds:.0f} s.",
        "",
        "![Error against time](speed.png)",
        "",
        "[Interactive chart](speed.html) · [as SVG](speed.svg) · [figures](speed.json)",
        "",
        "## How it was measured",
        "",
        *_HOW,
        "",
        "| | |",
        "|---|---|",
        *(f"| {name} | {value} |" for name, value in facts.items()),
        "",
        "Peers that were not installed: " + (", ".join(missing) or "none") + ".",
        "",
        "| method | how it is used |",
        "|---|---|",
        f"| {OURS[0]} | `solve_many`, compiled, one core, all positions; samples in, "
        "labelled arrays out; median of three runs |",
        f"| {OURS[1]} | the same algorithm in NumPy |",
        f"| {OURS[2]} | `solve` of a case known before, all its positions (five), certificates "
        "and result included |",
        *(f"| {e.name} | {e.note} |" for e in PEERS.values()),
        "",
        "## What was asked for",
        "",
        *_ratios(measures, titles),
        "",
        *_growth(scaling),
        "",
        *_memory(memory),
        "",
        "## Figures",
        "",
        "Errors are those of the answers given; what was not answered stands in its own column.",
        "",
    ]
    for workload, title in titles.items():
        lines += [f"### {title}", "", *_table([m for m in measures if m.workload == workload]), ""]
    lines += ["### 4 to 64 branches", "", "![Cost against branches](branches.png)", ""]
    lines += [*_table(scaling, by="workload"), "", "## Known limitations", "", *_LIMITS, ""]
    return "\n".join(lines)


_HOW = (
    "- Every method is given the same samples, drawn at fixed seeds. Peers get them as one "
    "dimensionless problem with rows of unit norm, already written down: their time holds no "
    "case, no assembly and no certificate. Ours holds all three.",
    "- Each peer is driven through its own outer loop where a law, a ring's arc or a friction "
    "bound needs one, and stops at its own tolerance.",
    "- The error is the larger one of the relative errors of torques and of determined floats "
    "against a 50-digit reference that is written from the physics and checked by its signs.",
    "- Ours is measured before the peers and once more after them; the mean counts, because a "
    "machine's speed changes within minutes.",
    "- Times are medians over samples, after one run that is not counted; of a batch, the time "
    "over its samples. Preparation stands apart. One core.",
    "- Certified means that the answer passes the certificate at 1e-9.",
)
_LIMITS = (
    "- A small machine with shared cores: times move by some ten per cent from run to run; "
    "the ratios are taken from one run.",
    "- Peers are called from Python; their loops are NumPy. A peer in compiled code with a "
    "compiled loop would lose less on its outer loop, not on its inner one.",
    "- CVXPY with parameters is compiled anew where a radial law changes its pieces (a clearance "
    "that closes before the spline slips); that time counts.",
    "- A float that hangs on forces below 1e-9 of the load (a pinion with play that nothing "
    "presses on) is left out of the error: digits that no case file has decide where it rests.",
    "- SLSQP and trust-constr are given fewer samples where they would take longer than the "
    "patience of 12 s.",
)


def _table(measures: Sequence[Measure], by: str = "") -> list[str]:
    head = ["method", "tolerance", "µs", "median error", "worst error", "answered", "certified"]
    head += ["set-up ms", "says"]
    if by:
        head.insert(0, "train")
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for m in measures:
        cells = [
            m.method,
            "–" if m.tolerance is None else f"{m.tolerance:.0e}",
            _figure(m.microseconds),
            _power(m.median),
            _power(m.worst),
            f"{m.answered}/{m.samples}",
            f"{m.certified}/{m.samples}",
            _figure(m.setup),
            m.failure.split("\n")[0].replace("|", "/")[:90],
        ]
        lines.append("| " + " | ".join([m.workload] * bool(by) + cells) + " |")
    return lines


def _figure(value: float) -> str:
    return f"{value:,.3g}" if math.isfinite(value) else "–"


def _power(value: float) -> str:
    return f"{value:.0e}" if math.isfinite(value) else "–"


def best(measures: Sequence[Measure], workload: str, method: str) -> Measure | None:
    """Return the measure of a method at its tightest tolerance that gave answers."""
    found = [
        m for m in measures if m.workload == workload and m.method == method and m.answered > 0
    ]
    return found[-1] if found else None


def _ratios(measures: Sequence[Measure], titles: Mapping[str, str]) -> list[str]:
    lines = [
        "Time of the peer at its tightest tolerance over ours, per equilibrium, side by side in "
        "this run. Ours counts only if its worst error is at most 1e-9 and its median at most "
        "1e-12; the peer counts whatever its error.",
        "",
        "| workload | ours | peer | ours µs | peer µs | ratio | asked | ours' errors | peer's |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for wanted in WANTED:
        one = best(measures, wanted.workload, wanted.ours)
        other = best(measures, wanted.workload, wanted.peer)
        if one is None or other is None:
            told = "no answer of the peer" if one is not None else "no answer of ours"
            lines.append(
                f"| {titles.get(wanted.workload, wanted.workload)} | {wanted.ours} | "
                f"{wanted.peer} | – | – | {told} | {_asked(wanted)} | – | – |"
            )
            continue
        ratio = other.microseconds / one.microseconds
        good = one.worst <= GOOD_WORST and one.median <= GOOD_MEDIAN
        good = good and one.certified == one.samples
        met = _asked(wanted)
        if wanted.wanted is not None:
            met += ": met" if ratio >= wanted.wanted and good else ": **not met**"
        lines.append(
            f"| {titles.get(wanted.workload, wanted.workload)} | {wanted.ours} | {wanted.peer} | "
            f"{_figure(one.microseconds)} | {_figure(other.microseconds)} | {ratio:,.3g} | "
            f"{met} | {_power(one.median)}, {_power(one.worst)} | "
            f"{_power(other.median)}, {_power(other.worst)} |"
        )
    return lines


def _asked(wanted: Ratio) -> str:
    return "for the record" if wanted.wanted is None else f"≥ {wanted.wanted:g}"


def _growth(scaling: Sequence[Measure]) -> list[str]:
    points = [
        (int(m.workload.removeprefix("branches-")), m.microseconds)
        for m in scaling
        if m.method == OURS_BATCH and math.isfinite(m.microseconds)
    ]
    if len(points) < 2:
        return ["Growth with the number of branches was not measured."]
    (n0, t0), (n1, t1) = points[0], points[-1]
    power = math.log(t1 / t0) / math.log(n1 / n0)
    met = "met" if power <= 2.0 else "**not met**"
    return [
        f"From {n0} to {n1} branches ours, batch, goes from {_figure(t0)} to {_figure(t1)} µs: "
        f"growth with the power {power:.2f} of the number of branches (asked: at most 2, {met})."
    ]


def _memory(memory: Mapping[str, float]) -> list[str]:
    if not memory:
        return ["The long run that shows bounded memory was left out."]
    met = "met" if memory["MiB"] < 1024.0 else "**not met**"
    return [
        f"{memory['equilibria']:,.0f} equilibria in {memory['seconds']:.0f} s with at most "
        f"{memory['MiB']:.0f} MiB of memory (asked: less than 1024 for 10^6, {met})."
    ]
