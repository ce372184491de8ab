"""Sensitivities against one-sided differences of certified solves.

    python -m benchmarks.sensitivities --count 400

Cases are shipped ones, stress problems and drawn trains, also put exactly on their critical values;
of every case six inputs are drawn from all numbers that it has. The run may be stopped at any time;
the same command goes on where it was. Every derivative is compared to each side with
differences over steps that shrink by four, extrapolated; where doubles are too noisy to decide, the
equilibria are those of the 50-digit reference. What is compared knows nothing of active sets, and
of the sensitivities only their stated errors.
"""

from __future__ import annotations

import math
import traceback
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import loadshare as ls
from benchmarks import kept
from benchmarks.machine_facts import facts
from benchmarks.random_trains.draw import draw
from benchmarks.reference import NoReference, reference
from benchmarks.stress.families import FAMILIES
from loadshare.case.keys import look_up, parse
from loadshare.case.line_of_action import WRITTEN
from loadshare.job.machine import Machine
from loadshare.settings import CERTIFY
from loadshare.solver.hot import vectorised
from loadshare.study.positions import certified, loaded
from loadshare.study.sensitivity import SIDES, Input, Sensitivity
from loadshare.study.sensitivity.inputs import inputs_of, twin_of
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.placed import train_at

CASES = Path(__file__).parents[1] / "cases"
SHIPPED = sorted(p for p in CASES.rglob("*.toml") if p.parent.name != "pairs")
STRESS = ("verge", "free-pinion", "friction", "lost-contact", "stick-limit", "soft-supports")
FIRST = 1e-3
"""First step over the input's value."""
STEPS = {False: 8, True: 14}
"""Most steps: to confirm a derivative, and to refute one."""
LEAST = {"m": 1e-6, "rad": 1e-4, "": 1e-4, "rad/(N*m)": 1e-11, "rad/(N*m)^(2/3)": 1e-10}
"""First step of inputs that are zero, in SI units; 1 for other units."""
MOVED, STILL = 20.0, 1e-6
"""Round-off of displacements over that of torques, and the smallest displacement to which it is
referred [m]."""
NOISE = {False: 2e-13, True: 2e-14}
"""Round-off of a torque over the largest torque: of a solve in doubles, and of the train's own
data."""
TEETH = 1e-4
"""Relative error above which a difference is not accurate enough."""
KEYS = 6
"""Number of inputs that are drawn from a case."""
TRIES = 8
"""Number of shipped cases that are searched for a critical value."""
FINE = ("agrees", "undefined")
"""Outcomes that need no closer look."""
FIGURES = {
    "stated": "stated error over the derivative",
    "known": "error of the difference over it",
    "excess": "distance over both errors",
}

Array = np.ndarray


@dataclass(frozen=True)
class Verdict:
    """The comparison of one derivative on one side.

    Attributes
    ----------
    outcome : str
        "exception", "agrees", "vague" (agrees, but its stated error is too large), "outside" (of
        its stated error), "missed" (not given, although differences converge), "undefined" (not
        given, and reported as such), "unnamed" (not given, without a reason), "undecided"
        (differences do not converge).
    excess : float
        Difference over the sum of both errors.
    stated, known : float
        Errors of the derivative and of the difference, over the largest derivative.
    told : str
        An exception.
    """

    outcome: str
    excess: float = math.nan
    stated: float = math.nan
    known: float = math.nan
    told: str = ""


def differenced(
    case: ls.Case, item: Input, position: int, sign: float, fine: bool = False
) -> tuple[Array, Array] | None:
    """Return the one-sided derivatives of torques and displacements, and their errors.

    None if there is no equilibrium on that side, or differences do not converge.
    """
    solved = loaded(case)
    train = build_train(solved)
    cycle = train.flank_positions(position)
    value = item.value
    is_computed = look_up(case.to_dict(), parse(item.key)) is None
    # Faces offset by no more than this count as opposite, because heights have few digits.
    is_height = item.key.endswith((".centre[2]", ".height"))
    widths = [gear.face_width.si for gear in case.gears.values() if gear.face_width]
    written = WRITTEN * max(widths, default=0.0) if is_height else 0.0

    def laid(number: float) -> Array | None:
        text = value.at(number).text
        change = (
            {item.key: text}
            if (twin := twin_of(item.key)) is None
            else {item.key: text, twin: text}
        )
        try:
            # Laws from teeth or pair files are inputs as well, of the case as it is solved.
            changed = solved.replace(change) if is_computed else loaded(case.replace(change))
            return figures(replace(build_train(changed), held_at=cycle), position, fine)
        except (ls.CaseError, ls.Refused, NoReference, ValueError):
            return None

    here = laid(value.number)
    if here is None:
        return None
    first = FIRST * abs(value.number) or LEAST.get(value.si_unit, 1.0) / value.factor
    # The round-off of torques differs from that of displacements.
    count = len(train.meshes)
    sizes = np.full(len(here), np.abs(here[:count]).max(initial=0.0))
    sizes[count:] = MOVED * np.abs(here[count:]).max(initial=STILL)
    slopes: list[tuple[Array, Array]] = []
    limits: list[tuple[Array, Array]] = []
    for k in range(STEPS[fine]):
        number = value.number + sign * first * 0.25**k
        there, step = laid(number), (number - value.number) * value.factor
        if 0.0 < abs(step) <= written:
            break
        if there is None or not step:
            slopes.clear()
            limits.clear()
            continue
        slopes.append(((there - here) / step, NOISE[fine] * sizes / abs(step)))
        if len(slopes) > 1:
            (far, coarse), (near, noise) = slopes[-2:]
            limits.append(((4.0 * near - far) / 3.0, (4.0 * noise + coarse) / 3.0))
        if not fine and len(limits) > 1:
            found, error = _best(limits)
            if _relative_error(error[:count], found[:count]) < 1e-3 * TEETH:
                break
    return _best(limits) if len(limits) > 1 else None


def _best(limits: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Choose for each figure the limit of least error that no nearer limit contradicts.

    Further from the value another active set may act, on which differences converge as well.
    """
    values = np.array([value for value, _ in limits[1:]])
    apart = np.array([np.abs(b[0] - a[0]) for a, b in pairwise(limits)])
    errors = 2.0 * apart + np.array([noise for _, noise in limits[1:]])
    count = len(values)
    for far in range(count):
        for near in range(far + 1, count):
            off = np.abs(values[far] - values[near])
            errors[far] = np.where(off > errors[far] + errors[near], np.inf, errors[far])
    chosen = np.argmin(errors, axis=0)
    each = np.arange(values.shape[1])
    return values[chosen, each], errors[chosen, each]


def _relative_error(error: Array, value: Array) -> float:
    size = float(np.abs(value).max(initial=0.0))
    return float(error.max(initial=0.0)) / size if size else math.inf


def figures(train: Train, position: int, fine: bool) -> Array:
    """Return the torques on drivers, then the displacements in the planes of the gears."""
    train = train_at(train, position)
    found = answered(train, position)
    if fine:
        exact = reference(train, position, found)
        moved = [
            gear.in_plane(exact.displacement.get(g, np.zeros(2))) for g, gear in train.gears.items()
        ]
        return np.concatenate([list(exact.torque.values()), *moved])
    torque = [
        sum(m.lever(d) * found.flank_force[m.flank_name(d)] for d in m.flanks)
        for m in train.meshes.values()
    ]
    moved = [g.plane @ found.displacement[n] for n, g in train.gears.items()]
    return np.concatenate([torque, *moved])


def answered(train: Train, position: int) -> Equilibrium:
    """Return a certified equilibrium; its undetermined part need not be of least norm."""
    machine = Machine(train)
    found = machine.answer(machine.situations([position]), CERTIFY.tolerance, vectorised.settle)
    if found.passed[0]:
        return found.equilibria.one(0, position)
    return certified(train, position).equilibrium


def judged(case: ls.Case, found: Sensitivity, item: Input, position: int, side: str) -> Verdict:
    """Compare a derivative on one side with differences."""
    rates = found.rates[position, item.key, side]
    sign = 1.0 if side == "rising" else -1.0
    value = np.array(list(rates.torque.values()))
    if np.isnan(value).any():
        named = [
            r for r in found.remarks if (r.key, r.position, r.side) == (item.key, position, side)
        ]
        if not named:
            return Verdict("unnamed")
        known = differenced(case, item, position, sign)
        count = len(value)
        if known is not None and _relative_error(known[1][:count], known[0][:count]) < TEETH:
            return Verdict("missed")
        return Verdict("undefined")
    verdict = Verdict("undecided")
    for fine in (False, True):
        known = differenced(case, item, position, sign, fine)
        if known is None:
            continue
        verdict = _compared(rates, known, len(value))
        if verdict.outcome in ("agrees", "vague"):
            return verdict
    return verdict


def _compared(rates: object, known: tuple[Array, Array], count: int) -> Verdict:
    def laid(of: object) -> Array:
        return np.concatenate([list(of.torque.values()), *of.displacement.values()])  # type: ignore[attr-defined]

    value, stated = laid(rates), laid(rates.error)  # type: ignore[attr-defined]
    defined = ~np.isnan(value)
    off = np.abs(value - known[0])
    allowed = stated + known[1]
    excess = np.where(defined & (off > 0.0), off / np.maximum(allowed, 1e-300), 0.0)
    worst = float(excess.max(initial=0.0))
    # If differences resolve a derivative accurately, its stated error must be small as well.
    seen = _relative_error(known[1][:count], known[0][:count]) < TEETH
    vague = seen and _relative_error(stated[:count], known[0][:count]) > TEETH
    return Verdict(
        "outside" if worst > 1.0 else "vague" if vague else "agrees",
        worst,
        _relative_error(stated[:count], value[:count]),
        _relative_error(known[1][:count], value[:count]),
    )


def problem(seed: int, number: int) -> tuple[str, ls.Case, int] | None:
    """Return the problem of a number, with a position; the same one every time.

    Five kinds alternate: shipped, stress, random (twice), and a shipped case on a critical value.
    None if no case with a critical value was found.
    """
    rng = np.random.default_rng([seed, number])
    kind = number % 5
    if kind == 1:
        name = STRESS[int(rng.integers(len(STRESS)))]
        stressed = int(rng.integers(FAMILIES[name].count))
        return f"stress {name} {stressed}", FAMILIES[name].problem(stressed).case, 1
    if kind in (2, 3):
        case = draw(seed, number)
        return case.name, case, int(rng.integers(build_train(case).count)) + 1
    for _ in range(TRIES):
        path = SHIPPED[int(rng.integers(len(SHIPPED)))]
        case = ls.load_case(path)
        if kind == 0:
            return f"shipped {path.stem}", case, int(rng.integers(build_train(case).count)) + 1
        kink = critical(case, rng)
        if kink is not None:
            return (f"critical {path.stem} {kink[0]}", *kink[1:])
    return None


def critical(case: ls.Case, rng: np.random.Generator) -> tuple[str, ls.Case, int] | None:
    """Put a case on one of its critical values along a length that it contains."""
    keys = [i for i in inputs_of(case, None) if i.value.si_unit == "m" and _varies(i.key)]
    if not keys:
        return None
    item = keys[int(rng.integers(len(keys)))]
    high = max(4.0 * abs(item.value.number), 2e-5 / item.value.factor)
    unit = item.value.unit
    try:
        found = ls.critical(case, item.key, f"0 {unit}", f"{high!r} {unit}", positions=[1])
        if not found.events:
            return None
        event = found.events[int(rng.integers(len(found.events)))]
        text = f"{event.value!r} {unit}"
        return f"{item.key} = {text}", case.replace({item.key: text}), event.position
    except (ls.CaseError, ls.Refused):
        return None


def _varies(key: str) -> bool:
    return key.split(".")[0] in ("errors", "rings", "splines") or "backlash" in key


def one(seed: int, number: int) -> dict[str, Any]:
    """Compare derivatives of one problem by some of its inputs, both sides; return plain data."""
    drawn = problem(seed, number)
    if drawn is None:
        return {"name": "", "position": 0, "verdicts": []}
    name, case, position = drawn
    rng = np.random.default_rng([seed, number, 1])
    usable = inputs_of(case, None)
    verdicts: list[dict[str, Any]] = []
    for item in [usable[int(k)] for k in rng.permutation(len(usable))[:KEYS]]:
        try:
            found = ls.sensitivity(case, [item.key], positions=[position])
        except ls.Refused:
            break
        except ls.CaseError:
            continue
        except Exception:  # noqa: BLE001 -- whatever escapes is counted
            failure = Verdict("exception", told=traceback.format_exc(limit=-4))
            verdicts.append({"key": item.key, "side": "", **asdict(failure)})
            continue
        for side in SIDES:
            verdict = judged(case, found, item, position, side)
            verdicts.append({"key": item.key, "side": side, **asdict(verdict)})
    return {"name": name, "position": position, "verdicts": verdicts}


def text(rows: Sequence[dict[str, Any]]) -> str:
    """Return a Markdown table of all results, and a list of those that need a closer look."""
    lines = []
    every = [v for row in rows for v in row["verdicts"]]
    for row in rows:
        at = f"{row['number']}: {row['name']}, position {row['position']}"
        lines += [
            f"- {at}, {v['key']} {v['side']}: {v['outcome']}, {v['excess']:.3g} {v['told']}"
            for v in row["verdicts"]
            if v["outcome"] not in FINE
        ]
    inputs = {(row["number"], v["key"]) for row in rows for v in row["verdicts"]}
    kinks = [v for row in rows if row["name"].startswith("critical") for v in row["verdicts"]]
    table = [("inputs", str(len(inputs))), ("one-sided derivatives", str(len(every)))]
    table += [("of these at kinks", str(len(kinks)))]
    table += [(o, str(n)) for o, n in Counter(v["outcome"] for v in every).most_common()]
    agreed = [v for v in every if v["outcome"] == "agrees"]
    for name, meaning in FIGURES.items():
        figures = np.array([v[name] for v in agreed])
        figures = figures[np.isfinite(figures)]
        if len(figures):
            median, high = np.quantile(figures, [0.5, 0.99])
            table.append((meaning, f"median {median:.1e}, 99 % below {high:.1e}"))
    table += list(facts().items())
    remarks = ["", "To be looked into:", "", *lines] if lines else []
    return "\n".join(["| | |", "|---|---|", *(f"| {n} | {v} |" for n, v in table), *remarks])


ABOUT = """# Sensitivities against differences

Are derivatives right within their stated errors? Those of shipped cases, problems of the stability
map and random trains, also at their critical values, with respect to six inputs each, are compared
on each side with differences of certified solves, over steps that shrink by four, extrapolated.
Where double precision is too noisy to decide, the equilibria are those of the reference in 50
digits. A derivative *agrees* if it is within its own stated error of the difference.
"""


def main() -> None:
    """Run the comparison and print the results."""
    what = "problems, each of some inputs"
    parser = kept.parser(str(__doc__), what, 400, "sensitivities")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rows = kept.run(
        kept.numbers(options),
        {"seed": options.seed},
        options.out / "verdicts.jsonl",
        partial(one, options.seed),
        processes=options.processes,
    )
    words = f"benchmarks.sensitivities --count {len(rows)} --seed {options.seed}"
    kept.publish(options.page, ABOUT, words, text(rows))


if __name__ == "__main__":
    main()
