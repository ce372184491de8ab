"""The report on stability: counts, and a sentence on how each peer fails."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks.stress.families import FAMILIES
from benchmarks.stress.methods import EVERY, OURS
from benchmarks.stress.run import Cell


def stability_report(
    cells: Sequence[Cell], facts: Mapping[str, str], seconds: float, quick: bool
) -> str:
    """Write the report in Markdown."""
    methods = list(dict.fromkeys(c.method for c in cells))
    mine = [c for c in cells if c.method == OURS]
    lines = [
        "# Stability where methods fail",
        "",
        "Which problems make a solver fail, and how does it fail: with a refusal, or with a wrong "
        "answer? Problems from harmless to extreme, given to every method. "
        f"Measured by `python -m benchmarks.stress{' --quick' * quick}` in {seconds:.0f} s.",
        "",
        "![Outcome of every method on every family](stability.png)",
        "",
        "[Interactive map](stability.html) · [as SVG](stability.svg) · [figures](stability.json)",
        "",
        *_ours(mine),
        "",
        "## How it was measured",
        "",
        *_HOW,
        "",
        "| | |",
        "|---|---|",
        *(f"| {name} | {value} |" for name, value in facts.items()),
        "",
        "## The families",
        "",
        "| family | what varies | from harmless to extreme | problems |",
        "|---|---|---|---|",
    ]
    for name in dict.fromkeys(c.family for c in cells):
        family = FAMILIES[name]
        levels = ", ".join(f"{v:g}" for v in family.levels)
        lines.append(f"| `{name}`: {family.title} | {family.knob} | {levels} | {family.count} |")
    lines += [
        "",
        "## Outcomes",
        "",
        "Certified / refused / wrong / crashed; in brackets, how many of the wrong answers have no "
        "residual above 1e-6. A dash: not applicable.",
        "",
        "| family | " + " | ".join(methods) + " |",
        "|---" * (len(methods) + 1) + "|",
    ]
    for name in dict.fromkeys(c.family for c in cells):
        row = {c.method: c for c in cells if c.family == name}
        counts = " | ".join(_counts(row[m]) if m in row else "–" for m in methods)
        lines.append(f"| {FAMILIES[name].title} | {counts} |")
    lines += ["", "## How they fail", ""]
    for method in methods:
        lines += [f"**{method}.** {_sentence([c for c in cells if c.method == method])}", ""]
    return "\n".join(lines)


_HOW = (
    "- Each family varies one parameter from harmless to extreme, with fixed seeds; "
    "`python -m benchmarks.stress --family NAME --problem N` shows and explains a single problem.",
    "- Whether a problem has an answer is decided before any method sees it: two linear "
    "programmes, written from the train and solved by HiGHS, ask whether forces can balance the "
    "load and whether the rigid limits leave room.",
    "- Certified: an answer that passes the certificate at 1e-9, evaluated outside the method. "
    "Refused: the method itself reports that it found none. Wrong: it claims an answer that fails "
    "the certificate, or answers a problem that has none. Crashed: anything else.",
    "- Other solvers run at their tightest tolerance, with outer loops for nonlinear laws, on the "
    "same dimensionless data. Slow ones get fewer problems: "
    + ", ".join(f"{name} every {n}th problem" for name, n in EVERY.items())
    + ".",
    "- Not applicable: OSQP, PIQP and DAQP solve no cones, so they cannot treat problems with "
    "splines or round rings; friction that follows the torque has no energy, so SLSQP cannot "
    "treat it.",
)


def _ours(cells: Sequence[Cell]) -> list[str]:
    total = sum(c.total for c in cells)
    counts = {o: sum(c.counts[o] for c in cells) for o in cells[0].counts} if cells else {}
    missed, unnamed = sum(c.missed for c in cells), sum(c.unnamed for c in cells)
    met = not (counts.get("wrong") or counts.get("crashed") or missed or unnamed)
    lines = [
        f"`loadshare` (*ours*): {total} problems, {counts.get('certified', 0)} certified, "
        f"{counts.get('refused', 0)} refused, {counts.get('wrong', 0)} wrong, "
        f"{counts.get('crashed', 0)} crashed. Of the problems that have an answer, {missed} were "
        f"not certified; of those that have none, {unnamed} were refused without naming the "
        "element for which there is none. "
        + ("The target, no wrong answer and none of these, is met." * met)
        + ("**The target, no wrong answer and none of these, is not met.**" * (not met))
    ]
    for cell in cells:
        if cell.failures:
            numbers = ", ".join(str(n) for n, _, _ in cell.failures[:12])
            more = " …" if len(cell.failures) > 12 else ""
            lines += ["", f"- `{cell.family}`: {numbers}{more}"]
    return lines


def _counts(cell: Cell) -> str:
    if cell.counts["not for it"] == cell.total:
        return "–"
    counts = " / ".join(str(cell.counts[o]) for o in ("certified", "refused", "wrong", "crashed"))
    return f"{counts} ({cell.loose})" if cell.counts["wrong"] else counts


def _sentence(cells: Sequence[Cell]) -> str:
    """Return a sentence on how a method fails: where most often, and with which message."""
    total = sum(c.total - c.counts["not for it"] for c in cells)
    missed = sum(c.missed for c in cells)
    wrong = sum(c.counts["wrong"] for c in cells)
    crashed = sum(c.counts["crashed"] for c in cells)
    if not (missed or wrong or crashed):
        return f"No failure in {total} problems."
    worst = max(cells, key=lambda c: (c.missed + c.counts["wrong"]) / c.total)
    reasons: dict[str, int] = {}
    for cell in cells:
        for k, sentence in enumerate(cell.sentences):
            weight = (cell.missed + cell.counts["wrong"]) // (k + 1)
            reasons[sentence] = reasons.get(sentence, 0) + weight
    common = sorted(reasons, key=lambda r: -reasons[r])[:3]
    return (
        f"Of {total} problems, {missed} that have an answer were not certified; {wrong} answers "
        f"were wrong, {crashed} attempts crashed. Worst on *{FAMILIES[worst.family].title}* "
        f"({worst.counts['certified']} of {worst.total - worst.counts['not for it']} certified). "
        "Most common: " + "; ".join(common) + "."
    )
