"""The report on speed: what was measured, with which tools, and the ratios of the times."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.chart.measure import (
    OURS_BATCH,
    OURS_FIRST,
    OURS_NEW,
    OURS_NUMPY,
    OURS_SOLVE,
    Measure,
)
from benchmarks.peers import PEERS

GOOD_WORST, GOOD_MEDIAN = 1e-9, 1e-12
"""Largest worst and median errors of ours with which a ratio counts."""


@dataclass(frozen=True, slots=True)
class Ratio:
    """The ratio of a peer's time to ours, and its target.

    Attributes
    ----------
    workload, ours : str
    peers : tuple of str
        The fastest of them counts.
    wanted : float or None
        Target for how many times faster ours is; None if it is only recorded.
    calls : bool
        Whether only the time inside the peer's compiled calls counts.
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
"""Ratios with a target, and those that are only recorded."""


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
        Equilibria, seconds and largest memory [MiB] of the long run; empty if it was left out.
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
        "How long does one equilibrium take, how exact is it, and how do other solvers compare? "
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
        "Solvers that were not installed: " + (", ".join(missing) or "none") + ".",
        "",
        "| method | how it is used |",
        "|---|---|",
        f"| {OURS_BATCH} | `solve_many`, compiled, on one core, all positions, from samples to "
        "labelled arrays; median of three runs on a case that was solved before |",
        f"| {OURS_FIRST} | the same on a case never seen: what its sets of acting elements have in "
        "common is worked out as well |",
        f"| {OURS_NUMPY} | the algorithm of the batch in NumPy |",
        f"| {OURS_NEW} | `solve` of a new case, all its positions (five), from the case in memory "
        "to the certified result |",
        f"| {OURS_SOLVE} | the same for a case that was solved just before |",
        *(f"| {e.name} | {e.note} |" for e in PEERS.values()),
        "",
        "## Targets",
        "",
        *_ratios([*measures, *scaling], {m.workload: _branched(m) for m in scaling} | dict(titles)),
        "",
        *_growth(scaling),
        "",
        *_memory(memory),
        "",
        "## Figures",
        "",
        "Errors are those of the answers that a method gave, *answered* says for how many samples "
        "it gave one, and *certified* how many of these pass the certificate.",
        "",
    ]
    for workload, title in titles.items():
        lines += [f"### {title}", "", *_table([m for m in measures if m.workload == workload]), ""]
    lines += ["### 4 to 64 branches", "", "![Cost against branches](branches.png)", ""]
    lines += [*_table(scaling, by="workload"), "", "## Known limitations", "", *_LIMITS, ""]
    return "\n".join(lines)


_HOW = (
    "- All methods solve the same samples, drawn with fixed seeds. Other solvers (*peers*) receive "
    "each sample as a finished dimensionless problem with rows of unit norm, so their times "
    "include no case, no assembly and no certificate. Our times include all three.",
    "- A problem with a nonlinear law, a ring's arc or friction that follows the torque is solved "
    "in several passes, each with the law's tangent at the last answer (Newton) or its secant "
    "(Picard). Each peer runs through this outer loop and stops at its own tolerance.",
    "- The error is the larger of two relative errors, that of the torques and that of the floats "
    "whose place is determined, against a reference in 50 digits. The reference is written from "
    "the physics, and the signs of its forces and gaps are checked.",
    "- Our methods are timed before the peers and again after them, and the mean counts, because "
    "the speed of a machine changes within minutes.",
    "- Times are medians over the samples, after a first run that does not count. The time of a "
    "batch is divided by the number of its samples. Set-up is listed separately. Everything runs "
    "on one core.",
    "- Every peer has three times. *All* is the time of the call from Python, including the outer "
    "loop. *In calls* is the part of it that is spent in the functions of the solver's extension "
    "module that take new data and solve, less the cost of reading the clock; reading their "
    "arguments is included. *Reported* is the solver's own figure: DAQP's leaves out what it does "
    "with new data before it solves, Clarabel's always includes its first set-up. CVXPY, SciPy "
    "and NumPy have no such calls of their own.",
    "- Ratios are ratios of processor time, which other processes disturb least: all of our time, "
    "and a peer's time in calls unless stated otherwise.",
    "- The *reduced* problem contains only the contacts that act in the answer of at least one "
    "sample of the workload. This is a better reduction than anyone can make before the answers "
    "are known. DAQP also receives it in the redundants of the force method (the few forces that "
    "balance alone leaves open), without any equations.",
    "- *Certified*: the answer passes the certificate at 1e-9.",
)
_LIMITS = (
    "- The machine is small and its cores are shared. Times vary by some ten per cent from run to "
    "run, so ratios are taken within one run.",
    "- Peers are called from Python, and their outer loops use NumPy. With a compiled loop they "
    "would lose less time between their calls; *in calls* shows what would remain.",
    "- CVXPY with parameters compiles the problem again when a radial law changes its pieces (a "
    "clearance that closes before the spline slips). That time counts.",
    "- A float that is held by forces below 1e-9 of the load (a pinion with play that nothing "
    "presses on) is left out of the error, because its place depends on digits that no case file "
    "has.",
    "- SLSQP and trust-constr get fewer samples where they would need more than 12 s.",
)


def _table(measures: Sequence[Measure], by: str = "") -> list[str]:
    head = ["method", "tolerance", "all µs", "processor µs", "in calls µs", "reported µs"]
    head += ["median error", "worst error", "answered", "certified", "set-up ms", "message"]
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
    """Return the fastest of the peers of a ratio and its time [µs]; None if none has an answer."""
    found = [m for p in wanted.peers if (m := best(measures, wanted.workload, p)) is not None]
    timed = [(m, m.inside_cpu if wanted.calls else m.cpu) for m in found]
    return min(timed, key=lambda pair: pair[1], default=None)


def _branched(scaling: Measure) -> str:
    return f"{scaling.workload.removeprefix('branches-')} branches, b + c law"


def _ratios(measures: Sequence[Measure], titles: Mapping[str, str]) -> list[str]:
    lines = [
        "How many times faster we are than a peer at its tightest tolerance: its processor time "
        "per equilibrium divided by ours, both from this run; of several peers the fastest counts. "
        "A target is met only if our worst error is at most 1e-9, our median error at most 1e-12 "
        "and every answer certified; the peer counts whatever its error. *Reported* is the ratio "
        "with the time that the peer's solver reports itself. Errors are median and worst.",
        "",
        "| workload | ours | peer | its time | ours µs | peer µs | ratio | target | reported | "
        "our errors | peer's errors |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for wanted in WANTED:
        title = titles.get(wanted.workload, wanted.workload)
        one = best(measures, wanted.workload, wanted.ours)
        found = _fastest(measures, wanted)
        kind = "in calls" if wanted.calls else "all"
        if one is None or found is None:
            missing = "no answer of the peer" if one is not None else "no answer of ours"
            lines.append(
                f"| {title} | {wanted.ours} | {wanted.peers[0]} | {kind} | – | – | {missing} | "
                f"{_target(wanted)} | – | – | – |"
            )
            continue
        other, time = found
        ratio = time / one.cpu
        good = one.worst <= GOOD_WORST and one.median <= GOOD_MEDIAN
        good = good and one.certified == one.samples
        met = _target(wanted)
        if wanted.wanted is not None:
            met += ": met" if ratio >= wanted.wanted and good else ": **not met**"
        lines.append(
            f"| {title} | {wanted.ours} | {other.method} | {kind} | {_figure(one.cpu)} | "
            f"{_figure(time)} | {ratio:,.3g} | {met} | {_figure(other.reported / one.cpu)} | "
            f"{_power(one.median)}, {_power(one.worst)} | "
            f"{_power(other.median)}, {_power(other.worst)} |"
        )
    return lines


def _target(wanted: Ratio) -> str:
    return "none" if wanted.wanted is None else f"≥ {wanted.wanted:g}"


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
        f"From {n0} to {n1} branches, our batch takes from {_figure(t0)} to {_figure(t1)} µs: the "
        f"time grows with the power {power:.2f} of the number of branches. The last doubling "
        f"multiplies it by {last:.2f} (target: at most linear growth, {met})."
    ]


def _memory(memory: Mapping[str, float]) -> list[str]:
    if not memory:
        return ["The long run that shows bounded memory was left out."]
    met = "met" if memory["MiB"] < 1024.0 else "**not met**"
    return [
        f"{memory['equilibria']:,.0f} equilibria in {memory['seconds']:.0f} s with at most "
        f"{memory['MiB']:.0f} MiB of memory (target: less than 1024 for 10^6, {met})."
    ]
