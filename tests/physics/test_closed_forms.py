"""Closed forms: the solver must find what can be computed without it.

Sources: the seed's reconstruction, "Closed form for hand checks"; formulation, sections 2 to 4;
Ligata, Kahraman, Singh, J. Mech. Des. 131, 021007 (2009), restated for the definitions here; NASA
split-path tests, ADA314767.

Tolerances: with linear springs and an identified active set an answer is exact up to the round-off
of one small linear solve, 1e-12; 1e-9 is required. If a case has rounded lengths, the closed form
uses its own numbers, and the tolerance only allows for what rounding changes (equal spacing, equal
angles).
"""

import itertools

import numpy as np
import pytest
from tests.support import driver_torques, loaded, shipped

import loadshare as ls
from benchmarks import families
from loadshare.train import build_train

EXACT = 1e-9


def four_branches(
    torque: float, k: dict[str, float], gap: dict[str, float], i12: float, i46: float
) -> dict[str, float]:
    """Return the torques [N·m] of the four-branch train without floats, by the reconstruction.

    `k` contains K12, K46, K610 and K_T [N·m/rad], equal in both branches, `gap` the gaps at the
    drivers [rad].
    """
    c4 = 1 / k["46"] + i46**2 / k["610"]
    c1 = 1 / k["12"] + i12**2 * (1 / k["T"] + c4 / 2)
    inner = gap["4-6"] + i46 * gap["6-10"], gap["5-9"] + i46 * gap["9-10"]
    outer = gap["4-7"] + i46 * gap["7-10"], gap["5-8"] + i46 * gap["8-10"]
    e_a, e_b = (
        gap[mesh] + i12 * (one + other) / 2
        for mesh, one, other in zip(("1-2", "1-3"), inner, outer, strict=True)
    )
    first = torque / 2 + (e_b - e_a) / (2 * c1), torque / 2 - (e_b - e_a) / (2 * c1)
    found = {"1-2": first[0], "1-3": first[1]}
    for side, t, a, b in zip((0, 1), first, inner, outer, strict=True):
        omega = 1 + (b - a) / (c4 * i12 * t)
        names = (("4-6", "6-10"), ("4-7", "7-10")), (("5-9", "9-10"), ("5-8", "8-10"))
        for (driver, driven), share in zip(names[side], (omega, 2 - omega), strict=True):
            found[driver] = share * i12 * t / 2
            found[driven] = i46 * found[driver]
    return found


def ratios(case: ls.Case) -> tuple[float, float]:
    gears = build_train(case).gears
    i12 = gears["2"].base_radius / gears["1"].base_radius
    return i12, gears["6"].base_radius / gears["4"].base_radius


STIFFNESS = {"12": 8.365e5, "46": 4.275e6, "610": 6.425e6, "T": 5e5}


def test_the_hand_check_of_the_reconstruction():
    """T12 = 1081.975, T13 = 1093.225, Ω46 = 0.963454.

    The sixth decimal of the last is off by one: its own formula gives 0.9634527.
    """
    torques = driver_torques(shipped("fgfbstts/rigid_closed_form"))
    assert torques["1-2"] == pytest.approx(1081.975, abs=5e-4)
    assert torques["1-3"] == pytest.approx(1093.225, abs=5e-4)
    share = 2 * torques["4-6"] / (torques["4-6"] + torques["4-7"])
    assert share == pytest.approx(0.963454, abs=1.5e-6)


def test_the_formulas_of_the_reconstruction():
    case = shipped("fgfbstts/rigid_closed_form")
    assert ratios(case) == pytest.approx((4.641, 3.0), rel=1e-12)
    gaps = dict.fromkeys(case.meshes, 0.0) | {"4-6": 3e-4}
    expected = four_branches(2175.2, STIFFNESS, gaps, *ratios(case))
    assert driver_torques(case) == pytest.approx(expected, rel=EXACT)


@pytest.mark.parametrize("seed", range(6))
def test_any_gaps_and_stiffnesses(seed):
    """Both branches are equal, all ten gaps differ, but so little that every contact carries."""
    rng = np.random.default_rng(seed)
    case = shipped("fgfbstts/rigid_closed_form")
    k = {n: v * rng.uniform(0.5, 2.0) for n, v in STIFFNESS.items()}
    gaps = {mesh: rng.uniform(-2e-4, 2e-4) for mesh in case.meshes}
    kinds = {"1-2": "12", "1-3": "12", "4-6": "46", "4-7": "46", "5-8": "46", "5-9": "46"}
    changes = {f'meshes."{m}".gap': f"{g!r} rad" for m, g in gaps.items()}
    changes |= {
        f'meshes."{m}".stiffness': f"{k[kinds.get(m, '610')]!r} N*m/rad" for m in case.meshes
    }
    changes |= {f'shafts."{s}".stiffness': f"{k['T']!r} N*m/rad" for s in case.shafts}
    expected = four_branches(2175.2, k, gaps, *ratios(case))
    assert min(expected.values()) > 0.0
    assert driver_torques(case.replace(changes)) == pytest.approx(expected, rel=EXACT)


def test_a_linear_train_keeps_the_excess_torque():
    """With linear springs, (Ω − 1)·T is constant while no contact is lost: Table 2, Fig. 18.

    The errors are fixed. The first positions of load.toml (220 and 440 N·m) lose contact; the
    figures are pairwise, within each pinion.
    """
    result = ls.solve(shipped("fgfbstts/load"))
    torques = [p.torque for p in result.positions]
    carrying = [t for t in torques if min(t.values()) > 0.0]
    assert len(carrying) >= 5
    for pair in (("6-10", "7-10"), ("8-10", "9-10"), ("1-2", "1-3")):
        excess = [t[pair[0]] - (t[pair[0]] + t[pair[1]]) / 2 for t in carrying]
        assert np.ptp(excess) <= EXACT * abs(excess[0]), pair
    shares = [
        p.pair_omega for p in (ls.solve(shipped("fgfbstts/load"), positions=[k]) for k in (3, 8))
    ]
    assert shares[0]["II"] > shares[1]["II"] > 1.0


# --- Floating sun ---


def series_stiffness(case: ls.Case) -> float:
    """Return the stiffness [N/m] of one planet's two meshes in series at the sun's base circle."""
    train = build_train(case)
    (sun,) = train.meshes["sun-planet1"].laws
    (ring,) = train.meshes["planet1-ring"].laws
    return 1.0 / (sun.b + ring.b)


def star(n: int, floating: bool, torque: float, gaps: list[float]) -> ls.Case:
    """Return a star with the gap `gaps[m]` [m at the base circle] in front of planet m."""
    case = families.star(n, floating)
    radius = build_train(case).gears["sun"].base_radius
    changes = {
        f"meshes.sun-planet{m + 1}.gap": f"{float(e) / radius!r} rad" for m, e in enumerate(gaps)
    }
    # The generator rounds angles to 1e-9 deg and lengths to 1 nm, so exact spacing is written
    # instead.
    changes |= {
        f"gears.planet{m + 1}.centre": {"distance": "90 mm", "angle": f"{m / n!r} rev"}
        for m in range(n)
    }
    return case.replace({**changes, "operating.torque": f"{torque!r} N*m"})


def fractions(case: ls.Case) -> np.ndarray:
    torques = driver_torques(case)
    found = np.array([torques[m] for m in case.meshes if m.startswith("sun-")])
    return found / found.sum()


def coefficients(n: int, floating: bool) -> np.ndarray:
    """Return the first row of n (I − projector on the sun's motions): on 1, cos ψ, sin ψ if it
    floats, on 1 alone if it is fixed.
    """
    psi = 2 * np.pi * np.arange(n) / n
    motions = np.array([np.ones(n), np.cos(psi), np.sin(psi)] if floating else [np.ones(n)]).T
    return n * (np.eye(n) - motions @ np.linalg.pinv(motions))[0]


@pytest.mark.parametrize("floating", [True, False], ids=["floating", "fixed"])
@pytest.mark.parametrize("n", [3, 4, 5, 6])
def test_the_closed_form_while_all_planets_carry(n, floating):
    """L_j = 1/n − (k R_s/(n T_s)) Σ_m c_m e_(j+m) for any gaps that leave every contact closed."""
    gaps = np.random.default_rng(n).uniform(0.0, 8e-6, n)
    case = star(n, floating, 1000.0, list(gaps))
    radius = build_train(case).gears["sun"].base_radius
    c = coefficients(n, floating)
    if not floating:
        assert c == pytest.approx([n - 1] + [-1] * (n - 1))
    elif n == 4:
        assert c == pytest.approx([1, -1, 1, -1])
    elif n == 3:
        assert c == pytest.approx(np.zeros(3), abs=1e-12)
    size = series_stiffness(case) * radius / (n * 1000.0)
    expected = [1 / n - size * sum(c[m] * gaps[(j + m) % n] for m in range(n)) for j in range(n)]
    assert min(expected) > 0.0
    assert fractions(case) == pytest.approx(expected, rel=EXACT)


@pytest.mark.parametrize(
    ("x", "carried"), [(0.25, 0.1875), (0.999, 0.00025), (1.001, 0.0), (3.0, 0.0)]
)
def test_four_planets_lose_contact_at_x_equal_to_one(x, carried):
    """X = k e R_s/T_s: (1−X)/4, (1+X)/4, … and beyond X = 1 the two others carry half each."""
    gap = 1e-5
    radius = build_train(families.star(4)).gears["sun"].base_radius
    torque = series_stiffness(families.star(4)) * gap * radius / x
    found = fractions(star(4, True, torque, [gap, 0.0, 0.0, 0.0]))
    expected = [carried, 0.5 - carried, carried, 0.5 - carried]
    # Near X = 1 the carried part is the small difference of large numbers.
    assert found == pytest.approx(expected, rel=EXACT, abs=1e-10)


def enumerated(n: int, k: float, force: float, gaps: np.ndarray, angle: float) -> np.ndarray:
    """Return load fractions of a floating sun by trying every set of contacts, as a reference.

    The unknowns are the sun's turn u (at its base circle) and displacement (x, y). The planets'
    approaches are u + n_m·(x, y) − e_m with n_m turned by 90° − α from the planet's direction;
    forces are k times the approach where in contact. A set is right when its forces push, the other
    contacts stay open, and moments and forces balance.
    """
    psi = 2 * np.pi * np.arange(n) / n + np.pi / 2 - angle
    rows = np.array([np.ones(n), np.cos(psi), np.sin(psi)]).T
    right = []
    for size in range(2, n + 1):
        for chosen in itertools.combinations(range(n), size):
            a, e = rows[list(chosen)], gaps[list(chosen)]
            load = np.array([force, 0.0, 0.0]) + k * a.T @ e
            motion, _, _, _ = np.linalg.lstsq(k * a.T @ a, load, rcond=1e-12)
            if np.abs(k * a.T @ a @ motion - load).max() > 1e-9 * force:
                continue
            approach = rows @ motion - gaps
            apart = np.delete(approach, list(chosen))
            if (approach[list(chosen)] >= 0.0).all() and (apart <= 1e-18).all():
                forces = np.zeros(n)
                forces[list(chosen)] = k * approach[list(chosen)]
                right.append(forces / force)
    assert right, "no set of contacts holds the sun"
    for other in right[1:]:
        assert other == pytest.approx(right[0], abs=1e-9)
    return right[0]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n", [3, 4, 5, 6])
def test_contact_loss_by_enumeration_of_all_contact_sets(n, seed):
    """Gaps range from hundredths to hundreds of mean deflections, so that between none and all but
    two planets lose contact.
    """
    rng = np.random.default_rng(100 * n + seed)
    gaps = rng.uniform(0.0, 1.0, n) * 10.0 ** rng.uniform(-6, -3)
    case = star(n, True, 200.0, list(gaps))
    train = build_train(case)
    force = 200.0 / train.gears["sun"].base_radius
    expected = enumerated(n, series_stiffness(case), force, gaps, np.radians(20.0))
    # If two planets that hold a sun are not opposite, its lever is near zero: 1e-9 of its share.
    assert fractions(case) == pytest.approx(expected, rel=EXACT, abs=1e-9)


# --- Two paths ---


def path_stiffness(case: ls.Case, path: str) -> float:
    """Return the torsional stiffness [N·m/rad] of a path at its shaft."""
    train = build_train(case)
    wheel, pinion = train.gears[f"wheel{path}"], train.gears[f"pinion{path}"]
    first = train.meshes[f"in-wheel{path}"].laws[0].b / wheel.base_radius**2
    second = train.meshes[f"pinion{path}-out"].laws[0].b / pinion.base_radius**2
    return 1.0 / (first + second + 1.0 / train.shafts[f"wheel{path}-pinion{path}"].stiffness)


@pytest.mark.parametrize("soft", [1.0, 0.3])
@pytest.mark.parametrize("clocking", [-2e-3, 0.0, 1.2e-3])
def test_the_two_path_split(clocking, soft):
    """T_A = k_A T/(k_A + k_B) + k_A k_B β/(k_A + k_B): β > 0, here clocking < 0, loads path A."""
    case = families.two_path(f"{clocking} rad")
    case = case.replace({"shafts.wheelB-pinionB.stiffness": f"{soft * 8e4} N*m/rad"})
    a, b = path_stiffness(case, "A"), path_stiffness(case, "B")
    train = build_train(case)
    ratio = train.gears["wheelA"].base_radius / train.gears["in"].base_radius
    expected = (a * 367.0 * ratio - a * b * clocking) / (a + b) / ratio
    found = driver_torques(case)
    assert found["in-wheelA"] == pytest.approx(expected, rel=EXACT)
    assert found["in-wheelB"] == pytest.approx(367.0 - expected, rel=EXACT)


def test_the_boxes_of_nasa():
    """At 367 N·m, at most 53 % of the torque is in one path.

    The clockings are −0.0012 ± 0.0007 and 0.0023 ± 0.0009 rad. The stiffnesses of the tested boxes
    are not in the source, so the shipped ones are assumed; the measured clocking is taken at the
    shaft. Box 1 (0.0012 rad) then stays within 53 %. The sign of the clocking decides which path it
    is.
    """
    for clocking, path in ((-1.2e-3, "A"), (1.2e-3, "B")):
        torques = driver_torques(families.two_path(f"{clocking} rad"))
        share = torques[f"in-wheel{path}"] / 367.0
        assert 0.5 < share <= 0.53


def test_light_load_leaves_one_path():
    """If the torque cannot wind up the stiffer path by the clocking, the other carries nothing."""
    case = loaded(families.two_path("1.2 mrad"), "10 N*m")
    torques = driver_torques(case)
    # The unloaded wheel between two closed gaps carries no more than round-off.
    assert torques["in-wheelA"] == pytest.approx(0.0, abs=10.0 * 1e-12)
    assert torques["in-wheelB"] == pytest.approx(10.0, rel=EXACT)
