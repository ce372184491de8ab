"""Fig. 10: both kinds of errors, with the directions of the eccentricities fitted to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.reproduction import printed
from benchmarks.reproduction.chapter import Chapter
from benchmarks.reproduction.drawing import Level, Panel, picture
from benchmarks.reproduction.entry import Entry, entries_table, signed, table
from benchmarks.reproduction.seed import GEARS, Seed, first
from loadshare.case import Case
from loadshare.report.figure import Figure
from loadshare.results import Position, Result
from loadshare.study.fit import Fit, fit

LAST_DIGIT = 0.0005
"""Half a unit in the last digit of the printed shares, taken as their standard deviation."""
TURN = ("-360 deg", "720 deg")
"""Bounds that let every direction turn freely."""
CONDITIONAL = ("4", "5", "10")
"""Gears whose directions alone are determined by the shares if the others are fixed."""
TITLE = "Fig. 10: both errors on all gears, no floats"


@dataclass(frozen=True)
class BothErrors:
    """The fit and the equilibrium that it gives.

    Attributes
    ----------
    fitted : Fit
        Directions of all ten eccentricities, installation errors along x.
    conditional : Fit
        Three of them, with the others fixed: as many as the figures determine.
    case : Case
        With the fitted directions.
    position : Position
    """

    fitted: Fit
    conditional: Fit
    case: Case
    position: Position

    @property
    def directions(self) -> dict[str, float]:
        """Fitted direction of each gear's eccentricity [°], from 0 to 360."""
        return {
            gear: unknown.value % 360.0
            for gear, unknown in zip(GEARS, self.fitted.unknowns, strict=True)
        }


def both_errors(seed: Seed) -> BothErrors:
    """Fit the directions of the eccentricities to the printed shares."""
    along = {f"errors.{gear}.installation.direction": "0 deg" for gear in GEARS}
    case = seed.case("both_errors").replace(along | _measured())
    fitted = fit(case, {_key(gear): TURN for gear in GEARS})
    conditional = fit(fitted.case, {_key(gear): TURN for gear in CONDITIONAL})
    return BothErrors(fitted, conditional, fitted.case, first(fitted.case))


def alternatives(seed: Seed) -> dict[str, Case]:
    """Return other directions that explain the same figure, to show what it leaves open."""
    start = {
        f"errors.{gear}.{kind}.direction": "0 deg"
        for gear in GEARS
        for kind in ("installation", "eccentricity")
    }
    free = fit(seed.case("both_errors").replace(start | _measured()), dict.fromkeys(start, TURN))
    return {
        "the case file's own set": seed.case("both_errors"),
        "all 20 directions fitted, from 0°": free.case,
    }


def errors_of(case: Case) -> dict[str, object]:
    """Return the errors of a case, as changes of another one."""
    return {"errors": case.to_dict()["errors"]}


def _key(gear: str) -> str:
    return f"errors.{gear}.eccentricity.direction"


def _measured() -> dict[str, Mapping[str, object]]:
    figure: dict[str, object] = {
        "position": 1,
        "share": {"1-2": printed.SHARE_I["1-2"]},
        "pair_share": printed.SHARES_II,
        "uncertainty": LAST_DIGIT,
        "source": "Seed paper, Fig. 10",
    }
    return {"measured.fig10": figure}


def share_entries(both: BothErrors) -> list[Entry]:
    """Return the shares that are fitted."""
    at = both.position
    one = [
        Entry(f"Ω of {m}", value, at.share[m] or 0.0, 4, "fitted" if m == "1-2" else "predicted")
        for m, value in printed.SHARE_I.items()
    ]
    return one + [
        Entry(f"Ω of {m}, within the pair", value, at.pair_share[m] or 0.0, 4, "fitted")
        for m, value in printed.SHARES_II.items()
    ]


def torque_entries(both: BothErrors) -> list[Entry]:
    """Return the torques, which no balanced model can meet."""
    everything = printed.TORQUES | printed.TORQUES_II
    return [
        Entry(f"T of {m} [N·m]", value, both.position.torque[m], 1)
        for m, value in everything.items()
    ]


def chapter(
    seed: Seed, both: BothErrors, others: Mapping[str, Case], cycle: Result | None
) -> Chapter:
    """Return the text on Fig. 10."""
    shares = share_entries(both)
    worst = max(abs(e.difference or 0.0) for e in shares if e.kind == "fitted")
    blocks = [
        "`cases/fgfbstts/both_errors.toml`: 50 µm of installation error and of eccentricity on "
        "every gear. All installation errors point along x, as in Fig. 8. `ls.fit` varies the "
        "directions of the ten eccentricities, starting from those of the case file, until they "
        f"reproduce the five printed shares (standard deviation {LAST_DIGIT:g}, half of the last "
        "digit).",
        entries_table(shares),
        *_what_it_determines(both),
        _others(others),
        entries_table(torque_entries(both)),
        _why_torques(both),
    ]
    pictures = {}
    if cycle is not None:
        blocks += ["{both_errors}", _over_the_cycle(cycle)]
        pictures["both_errors"] = torque_picture(
            seed,
            cycle,
            "both_errors",
            "Torque with both errors, no floats",
            printed.TORQUES | printed.TORQUES_II,
            "dotted: printed",
        )
    return Chapter(
        TITLE,
        f"fitted shares within {max(worst, 1e-4):.4f}; torques differ, as the printed ones do not "
        "balance",
        "shares fitted, torques predicted",
        tuple(blocks),
        pictures,
    )


def torque_picture(
    seed: Seed, cycle: Result, name: str, title: str, levels: Mapping[str, float], note: str
) -> Figure:
    """Torque of both stages' meshes over the five positions.

    Parameters
    ----------
    seed : Seed
    cycle : Result
    name, title : str
        Name and title of the picture.
    levels : mapping of mesh to float
        Printed torques [N·m].
    note : str
        Meaning of their dotted lines.
    """
    panels = []
    for stage, meshes in cycle.stages.items():
        panels.append(
            Panel(
                f"Stage {stage}",
                "position of the mesh cycle",
                "torque on the driver [N·m]",
                {m: [(p.position, p.torque[m]) for p in cycle.positions] for m in meshes},
                {m: seed.palette.mesh(m) for m in meshes},
                "mesh",
                levels=[_level(cycle, m, levels[m]) for m in meshes],
                least=20.0,
                ticks=tuple(p.position for p in cycle.positions),
            )
        )
    return picture(name, title, f"stiffness of every position from tooth contact; {note}", panels)


def _level(cycle: Result, mesh: str, value: float) -> Level:
    """Return a printed torque; its label is on the side away from the computed one."""
    return Level(value, mesh, below=cycle.positions[0].torque[mesh] > value)


def _what_it_determines(both: BothErrors) -> list[str]:
    sizes = both.fitted.singular_values
    kept = int((sizes > 1e-6 * sizes.max()).sum())
    fitted = table(
        ("gear", *GEARS),
        [("direction of the eccentricity [°]", *(f"{v:.1f}" for v in both.directions.values()))],
    )
    conditional = table(
        ("gear", "direction [°]", "standard deviation [°]"),
        [
            (gear, f"{u.value % 360.0:.1f}", f"{u.deviation:.2f}")
            for gear, u in zip(CONDITIONAL, both.conditional.unknowns, strict=True)
        ],
    )
    matrix = both.conditional.correlation
    correlations = ", ".join(
        f"{CONDITIONAL[i]} with {CONDITIONAL[j]} {signed(matrix[i, j], 2)}"
        for i in range(3)
        for j in range(i + 1, 3)
    )
    return [
        "The fitted directions, from which everything below is predicted:",
        fitted,
        f"**What the figure cannot determine.** The two shares of each pair add up to 2, so five "
        f"shares determine only {kept} combinations of the ten directions (a direction and an "
        f"initial phase are the same thing here). `ls.fit` reports this: "
        f"“{both.fitted.warnings[0]}” The variance of each single direction is infinite. If seven "
        "are held at the values above, the other three are determined:",
        conditional,
        f"Correlations: {correlations}.",
    ]


def _others(others: Mapping[str, Case]) -> str:
    rows = []
    for name, case in others.items():
        at = first(case)
        rows.append(
            (
                name,
                f"{at.share['1-2'] or 0.0:.4f}",
                *(f"{at.pair_share[m] or 0.0:.4f}" for m in printed.SHARES_II),
            )
        )
    header = ("other directions", "Ω of 1-2", *(f"Ω of {m}" for m in printed.SHARES_II))
    return "Very different directions fit equally well:\n\n" + table(header, rows)


def _why_torques(both: BothErrors) -> str:
    total = sum(printed.TORQUES.values())
    share = printed.TORQUES["1-2"] / total
    pinions = [
        printed.TORQUES_II[a] + printed.TORQUES_II[b]
        for a, b in (("6-10", "7-10"), ("8-10", "9-10"))
    ]
    apart = printed.TORQUES["1-2"] / printed.TORQUES["1-3"] - 1
    both_shares = sum(printed.SHARE_I.values())
    return (
        f"**A misprint.** The printed T12 + T13 is {total:.1f} N·m, the input torque "
        f"{printed.TORQUE} N·m. The printed share, 50.88 %, of that torque is "
        f"{0.5088 * printed.TORQUE:.1f} N·m, so T12 = {printed.TORQUES['1-2']} N·m is most likely "
        f"a misprint (it is {100 * share:.2f} % of the printed sum). The two printed Ω of stage I "
        f"add up to {both_shares:.3f}, not to 2.\n\n"
        f"**Pairwise coefficients.** The printed torques of the two pinions are equal "
        f"({pinions[0]:.1f} and {pinions[1]:.1f} N·m) although T12 is {100 * apart:.1f} % above "
        "T13. So the paper's Ω of stage II is taken within each pinion's pair, and torques that "
        "balance cannot agree with both rows: they differ by up to "
        f"{max(abs(e.difference or 0.0) for e in torque_entries(both)):.0f} N·m. Shares can be "
        "compared, absolute torques cannot."
    )


def _over_the_cycle(cycle: Result) -> str:
    spread = max(
        max(p.pair_share[m] or 0.0 for p in cycle.positions)
        - min(p.pair_share[m] or 0.0 for p in cycle.positions)
        for m in printed.SHARES_II
    )
    one = [p.share["1-2"] or 0.0 for p in cycle.positions]

    def best(stage: str) -> int:
        return min(cycle.positions, key=lambda p: _unevenness(p, cycle.stages[stage])).position

    return (
        "With the stiffness curves of Fig. 7 instead of their middle, the shares within the pairs "
        f"change by up to {spread:.4f} over the cycle and Ω of 1-2 by {max(one) - min(one):.4f}: "
        "it “does not change much”, as the paper says. In the paper, stage I shares most evenly at "
        f"position 5 and stage II at position 4; here these are {best('I')} and {best('II')}. The "
        "positions cannot be compared: all meshes of a kind are assumed to be in phase, and the "
        "paper prints neither their relative phases nor where its cycle begins."
    )


def _unevenness(at: Position, meshes: Sequence[str]) -> float:
    """Return the largest deviation of a mesh's torque from the stage's mean, relative to it."""
    return max(abs((at.share[m] or 0.0) - 1.0) for m in meshes)
