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
        "| family | knob | from harmless to extreme | problems |",
        "|---|---|---|---|",
    ]
    for name in dict.fromkeys(c.family for c in cells):
        family = FAMILIES[name]
        told = ", ".join(f"{v:g}" for v in family.levels)
        lines.append(f"| `{name}`: {family.title} | {family.knob} | {told} | {family.count} |")
    lines += [
        "",
        "## Outcomes",
        "",
        "Certified / refused / wrong / crashed; in brackets how many of the wrong ones would pass "
        "at 1e-6. A dash: not applicable.",
        "",
        "| family | " + " | ".join(methods) + " |",
        "|---" * (len(methods) + 1) + "|",
    ]
    for name in dict.fromkeys(c.family for c in cells):
        row = {c.method: c for c in cells if c.family == name}
        told = " | ".join(_counts(row[m]) if m in row else "–" for m in methods)
        lines.append(f"| {FAMILIES[name].title} | {told} |")
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
    "Refused: the method itself says that it has none. Wrong: it claims an answer that fails, or "
    "answers a problem that has none. Crashed: anything else.",
    "- Peers are at their tightest tolerance, with their own outer loops, on the same "
    "dimensionless data. Slow ones are given fewer: "
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
        f"Ours: {total} problems, {counts.get('certified', 0)} certified, "
        f"{counts.get('refused', 0)} refused, {counts.get('wrong', 0)} wrong, "
        f"{counts.get('crashed', 0)} crashed. Of those with an answer {missed} were not certified; "
        f"of those without one {unnamed} were refused without naming an element that lacks it. "
        + ("The requirement is met." if met else "**The requirement is not met.**")
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
    told = " / ".join(str(cell.counts[o]) for o in ("certified", "refused", "wrong", "crashed"))
    return f"{told} ({cell.loose})" if cell.counts["wrong"] else told


def _sentence(cells: Sequence[Cell]) -> str:
    """Say how a method fails: where most, and in its own words."""
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
        f"Of {total} problems {missed} that have an answer are not certified, {wrong} answers are "
        f"wrong, {crashed} attempts crash. Worst on *{FAMILIES[worst.family].title}* "
        f"({worst.counts['certified']} of {worst.total - worst.counts['not for it']} certified). "
        "Most common: " + "; ".join(common) + "."
    )
