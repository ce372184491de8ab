"""The report on speed: what was measured, with what, and what the ratios are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.chart.measure import OURS, OURS_BATCH, OURS_NEW, OURS_SOLVE, Measure
from benchmarks.peers import PEERS

GOOD_WORST, GOOD_MEDIAN = 1e-9, 1e-12
"""Errors that a ratio asks of ours."""


@dataclass(frozen=True, slots=True)
class Ratio:
    """How many times faster ours is, and what was asked for; None for the record only.

    Attributes
    ----------
    workload, ours : str
    peers : tuple of str
        Of these the one that is fastest counts.
    wanted : float or None
    calls : bool
        Whether the peer's time is that inside its compiled calls, not all of it.
    """

    workload: str
    ours: str
    peers: tuple[str, ...]
    wanted: float | None
    calls: bool = True


DAQP = ("DAQP", "DAQP, reduced")
CLARABEL = ("Clarabel, update",)
WANTED = (
    *(Ratio(w, OURS_BATCH, DAQP, f) for w, f in (("rings", 5.0), ("law", 15.0))),
    *(Ratio(w, OURS_BATCH, DAQP, 2.0) for w in ("linear-8", "branches-8")),
    *(Ratio(w, OURS_BATCH, CLARABEL, f) for w, f in (("rings", 150.0), ("law", 500.0))),
    *(Ratio(w, OURS_BATCH, CLARABEL, 50.0) for w in ("linear-8", "branches-8")),
    *(
        Ratio(w, OURS_BATCH, CLARABEL, f)
        for w, f in (("splines", 40.0), ("splines-law", 150.0), ("all", 400.0))
    ),
    *(
        Ratio(w, OURS_NEW, ("CVXPY, rebuilt",), 20.0, calls=False)
        for w in ("rings", "splines", "law", "splines-law", "all")
    ),
    *(Ratio("study", OURS_BATCH, peers, None) for peers in (DAQP, CLARABEL)),
    *(
        Ratio(w, OURS_BATCH, ("Clarabel, update", "Clarabel, update, reduced"), None)
        for w in ("rings", "law", "linear-8", "splines", "splines-law", "all")
    ),
    *(Ratio(w, OURS_BATCH, ("CVXPY, parameters",), None, calls=False) for w in ("rings", "law")),
)
"""What was asked for, and what is on record beside it."""


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
        f"| {OURS_NEW} | `solve` of a case never seen, all its positions (five), from the case in "
        "memory to the certified result |",
        f"| {OURS_SOLVE} | the same of a case solved just before |",
        *(f"| {e.name} | {e.note} |" for e in PEERS.values()),
        "",
        "## What was asked for",
        "",
        *_ratios([*measures, *scaling], {m.workload: m.workload for m in scaling} | dict(titles)),
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
    "- Every peer has three times. *All* is what it takes from Python, its outer loop included. "
    "*In calls* is what of it is spent inside the functions of its extension module that take new "
    "data and solve, each call timed by itself, less the cost of looking at the clock; what that "
    "module does to read its arguments is in it. *Reported* is the solver's own figure: DAQP's "
    "leaves out what new data cost before the solve, Clarabel's has its first set-up in it every "
    "time. CVXPY, SciPy and NumPy have no such calls of their own.",
    "- Ratios are of processor time, which other processes on the machine disturb least, ours with "
    "all that belongs to it, the peers' in calls unless said otherwise.",
    "- The reduced problem has only those contacts that act in the answer of some sample of the "
    "workload: a better reduction than can be had before all answers are known. DAQP gets it in "
    "the redundants of the force method as well, so that no equation is left.",
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
    head = ["method", "tolerance", "all µs", "processor µs", "in calls µs", "reported µs"]
    head += ["median error", "worst error", "answered", "certified", "set-up ms", "says"]
    if by:
        head.insert(0, "train")
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for m in measures:
        cells = [
            m.method,
            "–" if m.tolerance is None else f"{m.tolerance:.0e}",
            *map(_figure, (m.microseconds, m.cpu, m.inside, m.reported)),
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


def _fastest(measures: Sequence[Measure], wanted: Ratio) -> tuple[Measure, float] | None:
    """The fastest of the peers of a ratio, and its time [µs]; None where none has an answer."""
    found = [m for p in wanted.peers if (m := best(measures, wanted.workload, p)) is not None]
    timed = [(m, m.inside_cpu if wanted.calls else m.cpu) for m in found]
    return min(timed, key=lambda pair: pair[1], default=None)


def _ratios(measures: Sequence[Measure], titles: Mapping[str, str]) -> list[str]:
    lines = [
        "Processor time of the peer at its tightest tolerance over ours, per equilibrium, side by "
        "side in this run; of several peers the fastest counts. Ours counts only if its worst "
        "error is at most 1e-9 and its median at most 1e-12; the peer counts whatever its error. "
        "The last but one column is the ratio to what the peer's solver reports of itself.",
        "",
        "| workload | ours | peer | its time | ours µs | peer µs | ratio | asked | reported | "
        "ours' errors | peer's |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for wanted in WANTED:
        title = titles.get(wanted.workload, wanted.workload)
        one = best(measures, wanted.workload, wanted.ours)
        found = _fastest(measures, wanted)
        kind = "in calls" if wanted.calls else "all"
        if one is None or found is None:
            told = "no answer of the peer" if one is not None else "no answer of ours"
            lines.append(
                f"| {title} | {wanted.ours} | {wanted.peers[0]} | {kind} | – | – | {told} | "
                f"{_asked(wanted)} | – | – | – |"
            )
            continue
        other, time = found
        ratio = time / one.cpu
        good = one.worst <= GOOD_WORST and one.median <= GOOD_MEDIAN
        good = good and one.certified == one.samples
        met = _asked(wanted)
        if wanted.wanted is not None:
            met += ": met" if ratio >= wanted.wanted and good else ": **not met**"
        lines.append(
            f"| {title} | {wanted.ours} | {other.method} | {kind} | {_figure(one.cpu)} | "
            f"{_figure(time)} | {ratio:,.3g} | {met} | {_figure(other.reported / one.cpu)} | "
            f"{_power(one.median)}, {_power(one.worst)} | "
            f"{_power(other.median)}, {_power(other.worst)} |"
        )
    return lines


def _asked(wanted: Ratio) -> str:
    return "for the record" if wanted.wanted is None else f"≥ {wanted.wanted:g}"


def _growth(scaling: Sequence[Measure]) -> list[str]:
    points = [
        (int(m.workload.removeprefix("branches-")), m.cpu)
        for m in scaling
        if m.method == OURS_BATCH and math.isfinite(m.cpu)
    ]
    if len(points) < 2:
        return ["Growth with the number of branches was not measured."]
    (n0, t0), (n1, t1) = points[0], points[-1]
    power, last = math.log(t1 / t0) / math.log(n1 / n0), t1 / points[-2][1]
    met = "met" if last <= n1 / points[-2][0] else "**not met**"
    return [
        f"From {n0} to {n1} branches ours, batch, goes from {_figure(t0)} to {_figure(t1)} µs: "
        f"growth with the power {power:.2f} of the number of branches. The last doubling costs "
        f"×{last:.2f} (asked: at most linear, {met})."
    ]


def _memory(memory: Mapping[str, float]) -> list[str]:
    if not memory:
        return ["The long run that shows bounded memory was left out."]
    met = "met" if memory["MiB"] < 1024.0 else "**not met**"
    return [
        f"{memory['equilibria']:,.0f} equilibria in {memory['seconds']:.0f} s with at most "
        f"{memory['MiB']:.0f} MiB of memory (asked: less than 1024 for 10^6, {met})."
    ]
