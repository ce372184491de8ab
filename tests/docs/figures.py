"""The source of every number in the prose of the documentation.

`RULES` computes numbers again: each rule has a text of a page in which ``{}`` stands for each
number, and a function that returns these numbers in order. `GIVEN` contains patterns of numbers
that are not results, by kind. Whoever writes a number into a page adds it to one of the two;
results to `RULES`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from math import hypot
from pathlib import Path
from tempfile import TemporaryDirectory

import loadshare as ls

ROOT = Path(__file__).parents[2]
CASES = ROOT / "cases"


@dataclass(frozen=True)
class Below:
    """A computed figure that must lie below the number that the page gives."""

    value: float


Values = Callable[[], Sequence[float | Below]]


@dataclass(frozen=True)
class Rule:
    """Numbers of a page, or of a section of it, that are computed again."""

    page: str
    text: str
    values: Values
    section: str = ""


@cache
def solved(name: str, *changes: tuple[str, object], position: int | None = None) -> ls.Result:
    case = ls.load_case(CASES / f"{name}.toml")
    if changes:
        case = case.replace(dict(changes))
    return ls.solve(case, positions=None if position is None else [position])


@cache
def starter() -> ls.Result:
    from loadshare.case.starter import starter_case

    with TemporaryDirectory() as folder:
        file = Path(folder) / "drive.toml"
        file.write_text(starter_case("drive"), encoding="utf-8")
        return ls.solve(file)


def ring(gear: str) -> float:
    reaction = solved("fgfbstts/limit_ring").positions[0].floats[gear].reaction
    return hypot(*reaction)


def shift(result: ls.Result, gear: str, index: int = 0) -> tuple[float, float]:
    """Return a displacement [µm]."""
    x, y = result.positions[index].displacement[gear]
    return 1e6 * x, 1e6 * y


def floats(size: object, **more: object) -> ls.Result:
    changes = {f"rings.{g}.float": size for g in "45"}
    return solved("fgfbstts/limit_ring", *changes.items(), *more.items(), position=1)


@cache
def freed() -> dict[str, float]:
    """Return the float at which each pinion leaves its stop [µm]."""
    events = ls.critical(
        CASES / "fgfbstts/limit_ring.toml", "rings.*.float", "0 um", "12 um", positions=[1]
    ).events
    return {e.element[5]: e.value for e in events if "stop" in e.element}


def wide() -> ls.Result:
    return floats("20 um", **{f"rings.{g}.clearance": "1 um" for g in "45"})


def pair(result: ls.Result, index: int = 0) -> dict[str, float | None]:
    return dict(result.positions[index].pair_share)


INDEX, TUTORIAL, VALIDATION = "docs/index.md", "docs/tutorial.md", "docs/validation.md"
RULES = [
    Rule(
        INDEX,
        "the most loaded branch carries only {} % more than the mean",
        lambda: [100 * (solved("fgfbstts/limit_ring").omega["system"] - 1)],
    ),
    Rule(INDEX, "which push back with {} N and {} N", lambda: [ring("4"), ring("5")]),
    Rule(
        INDEX,
        "Without float the imbalance is {} %",
        lambda: [100 * (floats("0 um").pair_omega["II"] - 1)],
    ),
    Rule(
        TUTORIAL,
        "Of the input torque of {} N·m, mesh 1-2 carries {}",
        lambda: [400.0, starter().positions[0].torque["1-2"]],
    ),
    Rule(
        TUTORIAL,
        "branch 7-10 carries {} % more than the mean",
        lambda: [
            100
            * (
                (
                    pair(solved("fgfbstts/limit_ring", ("rings.4.float", "4 um"), position=1))[
                        "7-10"
                    ]
                    or 0.0
                )
                - 1
            )
        ],
    ),
    Rule(
        TUTORIAL,
        "{} and {} µm from the centre",
        lambda: [hypot(*shift(wide(), "4")), hypot(*shift(wide(), "5"))],
    ),
    Rule(TUTORIAL, "and reaches 1 at {} µm", lambda: [freed()["4"]]),
]

# --- The validation page ---


def star(planets: int, gap: str = "0.4 mrad") -> list[float]:
    """Return the share Ω of each planet."""
    at = solved(f"star/floating_sun_{planets}", ('meshes."sun-planet1".gap', gap)).positions[0]
    return [at.share[f"sun-planet{k + 1}"] or 0.0 for k in range(planets)]


def excess() -> float:
    """Return X of the floating sun with a gap of 0.4 mrad."""
    return star(4)[1] - 1.0


def rigid(what: str) -> float:
    at = solved("fgfbstts/rigid_closed_form").positions[0]
    return at.torque[what] if what in ("1-2", "1-3") else at.pair_share[what] or 0.0


def paths() -> list[float]:
    torque = solved("two_path/clocking_error").positions[0].torque
    return [torque["in-wheelA"], torque["in-wheelB"]]


def twice(values: Sequence[float]) -> list[float]:
    return [*values, *values]


def lost(gap: float) -> Values:
    def row() -> list[float]:
        shares = star(4, f"{gap} mrad")
        return [excess() * gap / 0.4, shares[0] / 4, shares[1] / 4]

    return row


@cache
def moved(gear: str, way: str = "x") -> ls.Result:
    """Return a solution with gear 6's error of 50 um along x given to another gear, or along z."""
    case = ls.load_case(CASES / "fgfbstts/installation_error.toml")
    error = ["50 um", "0 um"] if way == "x" else ["0 um", "0 um", "50 um"]
    return ls.solve(case.replace({"errors": {gear: {"installation": error}}, "assumed": None}))


def eighth(gear: str) -> Values:
    def row() -> list[float]:
        found = moved(gear)
        return [found.omega["I"], found.pair_omega["II"], found.omega["II"]]

    return row


def tenth(mesh: str, printed: float, share: bool, stage: bool = False) -> Values:
    def row() -> list[float]:
        at = solved("fgfbstts/both_errors").positions[0]
        value = (at.share if stage else at.pair_share)[mesh] if share else at.torque[mesh]
        assert value is not None
        return [value, value - printed]

    return row


@cache
def cleared(clearance: float) -> ls.Result:
    keys = {f"splines.{g}.clearance": f"{clearance} um" for g in "45"}
    return solved("fgfbstts/full_float", *keys.items())


def route(**how: object) -> Values:
    """Return differences of torques from the default's, and the residual, for a case with every
    element.
    """

    def row() -> list[Below]:
        case = CASES / "fgfbstts/all_elements.toml"
        usual, other = all_elements(), ls.solve(case, **how) if how else all_elements()
        pairs = zip(usual.positions, other.positions, strict=True)
        size = [(max(map(abs, a.torque.values())), a, b) for a, b in pairs]
        far = max(abs(a.torque[m] - b.torque[m]) / top for top, a, b in size for m in a.torque)
        worst = Below(other.certificate.worst)
        return [Below(far), worst] if how else [worst]

    return row


@cache
def all_elements() -> ls.Result:
    return ls.solve(CASES / "fgfbstts/all_elements.toml")


def point(gear: str, printed: tuple[float, float], ring_of_case: bool) -> Values:
    """Return the place of a pinion [µm], unlimited or in the case's ring, and its distance from the
    paper's.
    """

    def row() -> list[float]:
        if ring_of_case:
            place = shift(solved("fgfbstts/limit_ring"), gear)
        else:
            place = shift(floats(f"{freed()[gear]!r} um"), gear)
        return [*place, *(a - b for a, b in zip(place, printed, strict=True))]

    return row


def ring_row(mesh: str, printed: float, size: str) -> Values:
    def row() -> list[float]:
        value = pair(floats(size))[mesh] or 0.0
        return [value, value - printed]

    return row


@cache
def revolution() -> ls.Result:
    return solved("fgfbstts/eccentricity")


def eccentric(gear: str) -> float:
    """Return the largest pair Ω over a revolution of one eccentric gear."""
    case = ls.load_case(CASES / "fgfbstts/eccentricity.toml")
    changes = {"errors": {gear: {"eccentricity": {"amount": "50 um"}}}, "march.gear": gear}
    return ls.solve(case.replace({**changes, "assumed": None})).pair_omega["II"]


def over_revolution(mesh: str) -> list[float]:
    shares = [p.share[mesh] or 0.0 for p in revolution().positions]
    return [min(shares), max(shares)]


def loads() -> tuple[list[float], list[float]]:
    """Return (Ω − 1) T of 6-10 [N·m] and the pair Ω of stage II at the eight loads."""
    positions = solved("fgfbstts/load").positions
    shares = [p.share["6-10"] or 0.0 for p in positions]
    # The mean torque of the stage is T/Ω of any branch.
    excess_ = [(w - 1) * p.torque["6-10"] / w for w, p in zip(shares, positions, strict=True)]
    return excess_, [max(p.pair_share[m] or 0.0 for m in PAIRED) for p in positions]


PAIRED = ("6-10", "7-10", "8-10", "9-10")


def printed_load() -> float:
    case = ls.load_case(CASES / "fgfbstts/load.toml")
    changes = {"operating.torque": "283 N*m", "operating.positions": 1}
    return ls.solve(case.replace(changes)).pair_omega["II"]


SPLIT = "Clearance of a bearing shifts a split"


def split_in_bearings(clearance: int) -> list[float]:
    """Return the share of path A of the split-path box with pinions in bearings, for each law."""
    laws = {
        "stiffness": "3e8 N/m",
        "ball_stiffness": "5e10 N/m^1.5",
        "roller_stiffness": "1.2e9 N/m^(10/9)",
    }
    case = ls.load_case(CASES / "two_path/clocking_error.toml")
    case = case.replace({'shafts."wheelA-pinionA".clocking': None})
    shares = []
    for key, value in laws.items():
        bearings = {
            f"pinion{path}": {"clearance": f"{play} um", key: value}
            for path, play in (("A", clearance), ("B", 10))
        }
        at = ls.solve(case.replace({"bearings": bearings})).positions[0]
        shares.append(at.torque["in-wheelA"] / 367.0)
    return shares


def validation_rules() -> Iterator[Rule]:
    """Yield the rules of the validation page; the texts contain the paper's values."""

    def rule(text: str, values: Values, section: str = "") -> Rule:
        return Rule(VALIDATION, text, values, section)

    for mesh, name in (("1-2", "T12"), ("1-3", "T13")):
        yield rule(f"{name} [N·m] | {{}} | {{}} | < 1e-9 |", lambda m=mesh: [rigid(m)] * 2)
    yield rule(
        "Ω of 6-10 and of 4-6, within the pair | {} | {} | < 1e-12 |",
        lambda: [rigid("6-10")] * 2,
    )
    for clearance in (0, 10, 20, 40, 80):
        yield rule(
            f"| {clearance} | {{}} | {{}} | {{}} |",
            lambda c=clearance: split_in_bearings(c),
            SPLIT,
        )
    rows = {
        3: ("the three planets | {}, {}, {} | {}, {}, {}", 3),
        4: ("planets 1, 2 | {}, {} | {}, {}", 2),
        5: ("planets 1, 2, 3 | {}, {}, {} | {}, {}, {}", 3),
        6: ("planets 1, 2, 3, 4 | {}, {}, {}, {} | {}, {}, {}, {}", 4),
    }
    for planets, (text, shown) in rows.items():
        yield rule(f"Ω of {text} | < 1e-12 |", lambda n=planets, k=shown: twice(star(n)[:k]))
    yield rule(
        "torque of paths A, B at the input [N·m] | {}, {} | {}, {} | < 1e-9 |",
        lambda: twice(paths()),
    )
    yield rule("which is {} here", lambda: [excess()])
    yield rule("larger share is {} %", lambda: [100 * max(paths()) / sum(paths())])
    for gap in ("0.8", "1.2", "1.3", "1.31", "4"):
        yield rule(f"| {gap} | {{}} | {{}} | {{}} |", lost(float(gap)), "Closed forms")
    yield rule("| default | – | {} |", route())
    for name, how in ROUTES.items():
        yield rule(f"| {name} | {{}} | {{}} |", route(**how))
    for gears in ("1", "2, 3", "4", "5", "6", "7", "8", "9", "10"):
        yield rule(
            f"| {gears} | {{}} | {{}} | {{}} |",
            eighth(gears.partition(",")[0]),
            "Fig. 8: installation error of 50 µm, one gear at a time",
        )
    yield rule(
        "largest Ω II | 1.1602 (gear 6) | {} (gear 6) | {} |",
        lambda: [moved("6").pair_omega["II"], moved("6").pair_omega["II"] - 1.1602],
    )
    yield rule(
        "from the gears of stage I | 1.0049 (gear 1) | {} (gear 1) | {} |",
        lambda: [moved("1").omega["I"], moved("1").omega["I"] - 1.0049],
    )
    yield rule("along z, gear 1 gives {}", lambda: [moved("1", "z").omega["I"]])
    yield rule(
        "here they range from {} to {}",
        lambda: [f(moved(g).pair_omega["II"] for g in ("7", "8", "9", "10")) for f in (min, max)],
    )
    for mesh, name, torque in (("1-2", "T12", 1107.7), ("1-3", "T13", 1068.5)):
        yield rule(f"| {name} [N·m] | {torque} | {{}} | {{}} |", tenth(mesh, torque, False))
    yield rule("| Ω of 1-2 | 1.019 | {} | {} |", tenth("1-2", 1.019, True, True))
    for mesh, omega in (("6-10", 0.933), ("7-10", 1.067), ("8-10", 0.967), ("9-10", 1.033)):
        yield rule(f"| Ω of {mesh} | {omega} | {{}} | {{}} |", tenth(mesh, omega, True))
    for mesh, torque in (("6-10", 7064.4), ("7-10", 8079.1), ("8-10", 7321.8), ("9-10", 7821.6)):
        name = f"T{mesh.replace('-', '')}"
        yield rule(f"| {name} [N·m] | {torque} | {{}} | {{}} |", tenth(mesh, torque, False))
    yield from spline_rules(rule)
    yield from ring_rules(rule)
    yield rule("(stage mean) runs between {} and {}", lambda: over_revolution("8-10"))
    yield rule(
        "The largest pair Ω is {}, the paper's 1.1144", lambda: [revolution().pair_omega["II"]]
    )
    yield rule("the same lower one ({})", lambda: [eccentric("7")])
    yield rule("for 6-10 it is {} N·m (by the mean of the stage)", lambda: [sum(loads()[0]) / 8])
    yield rule(
        "falls from {} at 220 N·m to {} at 1760 N·m", lambda: [loads()[1][0], loads()[1][-1]]
    )
    yield rule("At 283 N·m it is {};", lambda: [printed_load()])


def spline_rules(rule: Callable[..., Rule]) -> Iterator[Rule]:
    """Yield the rules of Figs. 11 and 12."""

    def full() -> ls.Result:
        return solved("fgfbstts/full_float")

    for gear, text in (
        ("4", "float of pinion 4, clearance 0.4 mm | 0.356"),
        ("5", "float of pinion 5 | 0.238"),
    ):
        yield rule(f"{text} mm | {{}} mm,", lambda g=gear: [1e-3 * hypot(*shift(full(), g))])
    yield rule("| Ω II | 1.016 | {} |", lambda: [full().pair_omega["II"]])
    yield rule("| Ω I | 1.014 | {} |", lambda: [full().omega["I"]])
    yield rule("a pinion is free after about {} µm", lambda: [hypot(*shift(full(), "4"))])
    for size in (3, 6, 8, 10, 12, 50):
        yield rule(f"| {size} | {{}} | st", lambda c=size: [cleared(c).pair_omega["II"]])
        yield rule(f"| {size} | {{}} | slip", lambda c=size: [cleared(c).pair_omega["II"]])


def ring_rules(rule: Callable[..., Rule]) -> Iterator[Rule]:
    """Yield the rules of Figs. 13 and 14."""
    texts = (
        ("Ω of 7-10 at float 0 | 1.047 | {} | {} |", "7-10", 1.047, "0 um"),
        ("pair at float 0 | 1.019 (8-10) | {} (9-10) | {} |", "9-10", 1.019, "0 um"),
        ("Ω of 7-10, large float | 1.004 | {} | {} |", "7-10", 1.004, "12 um"),
        ("pair, large float | 1.003 | {} | {} |", "9-10", 1.003, "12 um"),
    )
    for text, mesh, omega, size in texts:
        yield rule(text, ring_row(mesh, omega, size))
    for gear, micrometres in (("4", 8.36), ("5", 2.91)):
        yield rule(
            f"float that frees pinion {gear} [µm] | {micrometres} | {{}} | {{}} |",
            lambda g=gear, x=micrometres: [freed()[g], freed()[g] - x],
        )
    for gear, where in (("4", (4.14, 7.13)), ("5", (1.37, -2.37))):
        printed = f"({where[0]}, {where[1]})".replace("-", "−")
        size = {"4": "8.24", "5": "2.74"}[gear]
        for kind, ringed in (("unlimited", False), (f"ring of {size} µm", True)):
            yield rule(
                f"balance point of pinion {gear}, {kind} [µm] | {printed} | ({{}}, {{}}) | "
                "({}, {}) |",
                point(gear, where, ringed),
            )


ROUTES: dict[str, dict[str, object]] = {
    "Clarabel in place of the fast method": {"solver": "clarabel"},
    "the same without reduction": {"solver": "clarabel", "reduce": False},
    "Picard": {"method": "picard", "solver": "clarabel"},
    "power cone": {"method": "power", "solver": "clarabel"},
    "CVXPY": {"solver": "cvxpy"},
}
RULES += validation_rules()

GIVEN: dict[str, tuple[str, ...]] = {
    "names of gears, meshes, stages and figures": (
        r"\b[Gg]ears? [\d, ]+(?:(?:and|to|or) \d+)?",
        r"\b[Pp]inions? [\d, ]+(?:(?:and|to) \d+)?",
        r"\b[Ii]dlers? [\d, ]+(?:(?:and|to) \d+)?",
        r"\b[Pp]lanets? [\d, ]+(?:(?:and|to) \d+)?",
        r"\b\d+-\d+\b",
        r"\bFigs?\. \d+(?: (?:and|to) (?:Fig\. )?\d+)?",
        r"\bgears, 2 and 3\b",
    ),
    "versions, standards, sources": (
        r"Python 3\.\d+",
        r"[Vv]ersion 0\.1\.0",
        r"UTF-8",
        r"SHA-256",
        r"netCDF-4",
        r"J\. Mech\. Des\. 131, 021007, 2009",
    ),
    "definitions and exponents": (
        r"[≥=] 0\b",
        r"\^\(2/3\)",
        r"= 1/k\b",
        r"\b1e-9\b",
        r"of length 1\b",
        r"^\| `format` \| \d+;",
        r"at force 0\b",
        r"\(95 %\)|95 % interval",
        r"from 1 \|$",
        r"position, \w+ \| 1 \|",
        r"and reaches 1 at",
        r"and 0, ½ beyond",
        r"\(Ω − 1\)",
        r"10¹²|10⁻⁹",
    ),
    "inputs of the cases": (
        r"0\.1 mm out of position",
        r"^eccentricities, 20 positions",
        r"50 µm (?:off|of eccentricity|out of position)",
        r"^4 and 5; both drive the output",
        r"clocked by 0\.5 mrad",
        r"with 1 µm of clearance",
        r"10 µm at pinion B",
        r"K = [\d.]+e\d+ N/m(?:\^1\.5|\^\(10/9\))?",
        r"(?:where|in|against) 50 digits|50-digit",
        r"^\| (?:0|10|20|40|80) \|",
    ),
    "exit codes": (r"^\| (?:0|1|2|130|143) \|", r"exit code (?:is )?\d(?: or \d)?"),
    "settings, each also a constant of the code": (
        r"^\| (?:line of action turned|approach neglected|mesh compression|arm of a ring).*$",
        r"^\| open (?:where either flank may carry|without a backlash).*$",
        r"Mesh stiffnesses are known to about 1 %",
        r"κ [<≥] 1\b",
        r"some \$2/\\kappa - 1\$ times",
        r"64 starts from random contacts",
        r"a wedge of some 10⁻⁵ rad",
        r"height is 2\.25 modules",
        r"gear with 17 teeth",
        r"16 (?:independently|sequences|Sobol)",
        r"down to intervals of 1e-10\b",
        r"over 16 sequences",
        r"1024 by default; 0 turns",
        r"0\.135 % lie beyond",
        r"blocks of (?:at least )?4096",
        r"an eighth and at most 640\b",
        r"\bin 512 parts\b",
        r"about 1e-12 of the value|round-off, 1e-12 of the largest",
        r"After 120 passes",
        r"is used from 300 equilibria on",
    ),
    "defaults and settings of a pair file, and where laws are fitted": (
        r"^\| `(?:torque|helices|analysis|profile_shift|addendum|rim|youngs_modulus)`.*$",
        r"^\| `(?:modification|inner)`.*$",
        r"contact ratio below 1\b",
        r"1\.5 tooth heights deep",
        r"50 N per mm of face width",
        r"at T, 0\.95 T and 0\.9 T",
        r"at 0\.1, 0\.5 and 0\.9 T",
        r"is set to 0\b",
    ),
    "printed by the seed paper": (
        r"\(8\.36 and 2\.91 µm there\)",
        r"the paper's 1\.0049",
        r"T12 \+ T13 is 2176\.2 N·m, but its input torque is 2175\.2 N·m",
        r"\(15143\.5 and 15143\.4 N·m",
        r"differ by 3\.7 %",
        r"\\cdot10\^7",
        r"not after 0\.36 mm",
        r"ΔA_y\d = [+−]0\.1 mm",
        r"keeps 0\.3 to 0\.4 %|^0\.3 to 0\.4 % of imbalance",
        r"1\.1144",
        r"theory gives 1\.078",
        r"at most 53 %",
        r"at float 0\b",
        r"With 50 N of",
        r"\| 220 N·m",
    ),
    "measured on a machine, by the benchmark that the text names": (
        r"with JAX [\d.]+ it gave .* agreed to 4e-16",
        r"^A million samples of this case.*$",
        r"^disk\. A loop over CVXPY.*$",
        r"−6 to 62 µrad at 20 positions, at most 5 % of the loaded error",
    ),
}
"""Numbers that are not results of the library, or were measured: patterns by kind."""

MEASURED_FROM = {
    "docs/ltca.md": "## How far it can be trusted",
    "docs/reliability.md": "## Files",
}
"""Pages that, from a heading on, state targets and the results of dated runs."""

PAGES = (
    *("README.md", INDEX, TUTORIAL, "docs/studies.md", "docs/results.md", "docs/pictures.md"),
    *("docs/api.md", "docs/theory.md", "docs/design.md", VALIDATION, "docs/ltca.md"),
    "docs/design-parts.md",
    *("docs/case-reference.md", "docs/command-line.md", "docs/decisions.md"),
    "docs/reliability.md",
)
"""All pages except those that a command writes as a whole (reproduction, evidence)."""
