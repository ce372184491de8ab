"""`loadshare run`: its printed output, its files, and the exit code."""

import json
import math

import pytest

import loadshare as ls
from loadshare.cli.options import MethodName, SolverName
from loadshare.contact.backends.backend import SOLVERS
from loadshare.contact.record import METHODS

NEUTRAL = """
[operating]
input = "in"
output = "out"
torque = "200 N*m"

[gears]
in = { base_radius = "56 mm", centre = ["0 mm", "0 mm"] }
wheel = { base_radius = "28 mm", centre = ["90 mm", "0 mm"] }
pinion = { base_radius = "54 mm", centre = ["90 mm", "0 mm", "100 mm"] }
back = { base_radius = "30 mm", centre = ["0 mm", "0 mm", "100 mm"] }
sun = { base_radius = "30 mm", centre = ["0 mm", "0 mm"] }
carrier = { type = "carrier", centre = ["0 mm", "0 mm"] }
out = { type = "internal", base_radius = "78 mm", centre = ["0 mm", "0 mm"] }

[gears.planet]
copies = 3
carrier = "carrier"
base_radius = "24 mm"
centre = { distance = "57 mm", angle = "0 deg" }

[meshes]
in-wheel.stiffness = "1e6 N*m/rad"
pinion-back.stiffness = "1e6 N*m/rad"
sun-planet.stiffness = "1e6 N*m/rad"
planet-out.stiffness = "1e6 N*m/rad"

[shafts]
wheel-pinion.stiffness = "1e5 N*m/rad"
in-carrier.stiffness = "1e5 N*m/rad"
back-sun.stiffness = "1e5 N*m/rad"
"""


def test_a_certified_case_prints_everything_an_engineer_asks_for(command, cases):
    result = command("run", cases / "fgfbstts/limit_ring.toml")
    assert result.exit_code == 0
    assert result.stderr == ""
    for line in (
        "Limit rings on the floating pinions",
        "limit_ring.toml",
        "Input torque 2175.238 N·m on gear 1, output gear 10; 5 positions",
        "Ω stage",
        "9-10",
        "upper stop + arc 6",
        "gear 1 x, gear 1 y: not determined, without limit",
        "energy gap",
        "PASSED  5 of 5 positions certified",
    ):
        assert line in result.stdout


def test_the_figures_printed_are_those_of_the_result(command, cases):
    path = cases / "fgfbstts/installation_error.toml"
    solved = ls.solve(path)
    stdout = command("run", path).stdout
    for mesh, torque in solved.positions[0].torque.items():
        row = next(line for line in stdout.splitlines() if f" {mesh} " in line)
        assert f"{torque:.1f}" in row.split()
    for stage, omega in solved.omega.items():
        row = next(
            line for line in stdout.splitlines() if line.split()[:2] == [stage, f"{omega:.4f}"]
        )
        assert f"{solved.pair_omega[stage]:.4f}" in row


def test_few_positions_stand_side_by_side_and_many_are_summed_up(command, cases):
    case = cases / "fgfbstts/all_elements.toml"
    few = command("run", case, "--set", "march.steps=4").stdout
    assert all(f"at {k}" in few for k in (1, 2, 3, 4))
    many = command("run", case, "--set", "march.steps=8").stdout
    assert "least" in many
    assert "at 1" not in many
    assert "on boundary" in many
    assert "upper stop" in many
    assert "displacement  " in many


def test_no_line_of_the_report_is_wider_than_the_terminal(command, cases):
    for case in ("fgfbstts/all_elements.toml", "star/floating_sun_6.toml"):
        stdout = command("run", cases / case, "--explain").stdout
        lines = [line for line in stdout.splitlines() if "/" not in line]
        assert max(map(len, lines)) <= 80
        assert "…" not in stdout.replace(" … ", "")


def test_json_is_the_documented_form(command, cases, tmp_path):
    target = tmp_path / "made" / "result.json"
    case = cases / "fgfbstts/limit_ring.toml"
    assert command("run", case, "-o", target).exit_code == 0
    document = json.loads(target.read_text(encoding="utf-8"))
    assert document == json.loads(ls.solve(case).to_json())
    assert {"case", "version", "positions", "omega"} <= set(document)
    assert "refused" not in document
    position = document["positions"][0]
    assert {
        *("position", "torque", "share", "pair_share"),
        *("displacement", "floats", "certificate"),
    } <= set(position)
    assert position["certificate"]["passed"] is True
    assert set(document["omega"]) == {"I", "II", "system"}


def test_csv_and_netcdf_hold_the_result(command, cases, tmp_path):
    case = cases / "fgfbstts/base.toml"
    table, arrays = tmp_path / "t.csv", tmp_path / "r.nc"
    assert command("run", case, "-o", table, "-o", arrays).exit_code == 0
    rows = table.read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("position,mesh,torque")
    assert len(rows) == 1 + 5 * 10
    assert ls.load_result(arrays) == ls.solve(case)


def test_positions_are_chosen_and_each_solved_once(command, cases, tmp_path):
    target = tmp_path / "r.json"
    words = ("--position", "3", "--position", "2", "--position", "3", "-o", target)
    result = command("run", cases / "fgfbstts/base.toml", *words)
    assert result.exit_code == 0
    assert "positions 2-3 of 5\n" in result.stdout
    found = json.loads(target.read_text(encoding="utf-8"))["positions"]
    assert [p["position"] for p in found] == [3, 2]


def test_a_single_position_is_not_given_as_a_count(command, cases):
    result = command("run", cases / "fgfbstts/base.toml", "--position", "3")
    assert "output gear 10; position 3 of 5\n" in result.stdout


def test_a_change_is_reported_and_made(command, cases):
    words = ("--set", "operating.power=", "--set", "operating.torque=100 N*m")
    result = command("run", cases / "fgfbstts/base.toml", *words, "--set", "operating.speed=")
    assert result.exit_code == 0
    assert "changed: operating.torque=100 N*m" in result.stdout
    assert "Input torque 100 N·m" in result.stdout


def test_a_change_may_give_what_the_file_leaves_open(command, cases, tmp_path):
    text = (cases / "star/floating_sun_4.toml").read_text()
    open_one = tmp_path / "template.toml"
    open_one.write_text(text.replace('torque = "1000 N*m"', ""))
    assert command("run", open_one).exit_code == 2
    change = ("--set", "operating.torque=1000 N*m")
    assert "Input torque 1000 N·m" in command("run", open_one, *change).stdout
    assert "OK" in command("check", open_one, *change).stdout
    assert "1 certified" in command("batch", open_one, *change, "-o", tmp_path / "o").stdout
    for name, file in (("report", "page.html"), ("draw", "train.svg")):
        assert command(name, open_one, *change, "-o", tmp_path / file).exit_code == 0, name


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("method", METHODS)
def test_every_solver_and_method_prints_the_same_shares(command, cases, solver, method):
    case = cases / "fgfbstts/limit_ring.toml"
    words = ("--position", "1", "--no-reduce")
    result = command("run", case, "--solver", solver, "--method", method, *words)
    assert result.exit_code == 0
    assert "7582.0" in result.stdout


def test_the_words_of_the_options_are_those_of_the_solver_room():
    assert SolverName.__args__ == ("auto", *SOLVERS)
    assert MethodName.__args__ == METHODS


def test_explain_tells_how_the_first_position_was_solved(command, cases):
    """A back-end requested by name answers on its own rung."""
    options = ("--explain", "--solver", "clarabel")
    result = command("run", cases / "fgfbstts/limit_ring.toml", *options)
    assert result.stdout.count("How position") == 1
    for line in (
        *("How position 1 was solved", "clarabel + exact", "QP, 15 coordinates", "gear 4 x"),
        *("ring 4: arc 6", "clarabel + ", " + exact", "active set kept", "its bearing is rigid"),
    ):
        assert line in result.stdout


def test_explain_tells_what_acts_on_the_hot_path(command, cases):
    result = command("run", cases / "fgfbstts/limit_ring.toml", "--explain")
    for line in (
        *("fast method", "force method, 2 redundants, 15 coordinates", "sets tried"),
        *("Acting", "ring 4: arc 6", "open by", "its bearing is rigid"),
    ):
        assert line in result.stdout


def test_explain_follows_the_requested_positions_and_options(command, cases):
    words = ("--position", "2", "--position", "4", "--solver", "osqp", "--explain")
    stdout = command("run", cases / "fgfbstts/limit_ring.toml", *words).stdout
    assert "How position 2 was solved" in stdout
    assert "How position 4 was solved" in stdout
    assert "osqp + exact" in stdout


def test_a_refusal_leaves_with_1_and_names_what_nothing_holds(command, unheld):
    result = command("run", unheld)
    assert result.exit_code == 1
    assert result.stderr.startswith("REFUSED  position 1: ")
    assert "nothing balances the load on gear sun" in result.stderr
    assert "PASSED" not in result.stdout


def test_only_a_mesh_squeezed_between_its_flanks_is_said_to_carry_on_both(command, cases):
    """A mesh that its second gear drives carries on one flank: its torque is no difference."""
    driven = "Where the torque is negative, the gear named first is driven."
    case = cases / "planetary/four_planets.toml"
    words = ("--set", "operating.torque=-1000 N*m")
    braking = command("run", case, *words).stdout
    assert driven in braking
    assert "coast flank" not in braking
    changes = (
        'meshes."sun-planet2".backlash=0 um',
        'meshes."planet2-ring".backlash=0 um',
        "gears.sun.support=rigid",
        "errors.planet2.pin.radial=-50 um",
        "operating.torque=100 N*m",
    )
    squeezed = command("run", case, *(w for c in changes for w in ("--set", c))).stdout
    assert driven in squeezed
    assert squeezed.count("coast flank carries up to") == 1
    assert "Mesh sun-planet2: the coast flank carries up to " in squeezed
    assert driven not in command("run", case).stdout


def test_a_refusal_names_what_turns_together(command, cases, tmp_path):
    free = tmp_path / "free.toml"
    text = (cases / "planetary/four_planets.toml").read_text(encoding="utf-8")
    free.write_text(text.replace(", held = true", ""), encoding="utf-8")
    result = command("run", free)
    assert result.exit_code == 1
    assert "the load on gear sun rotation: no contact, support or limit holds it; " in result.stderr
    turning = "sun, planet1, planet2, planet3, planet4, … turn together"
    assert f"gears {turning}: hold one (held = true) or give it a torque" in result.stderr


def test_an_output_that_stands_still_as_the_input_turns_is_named(command, tmp_path):
    """A gear pair drives the sun at 3.6 times the carrier's speed, so the ring stands still."""
    neutral = tmp_path / "neutral.toml"
    neutral.write_text(NEUTRAL, encoding="utf-8")
    result = command("run", neutral)
    assert result.exit_code == 1
    assert (
        "gears in, carrier, wheel, pinion, planet1, … turn together: gear out, the output, stands "
        "still as gear in turns (a geared neutral), so no torque on it balances that of the input"
    ) in result.stderr


def test_certified_positions_are_kept_when_others_are_refused(command, half_held, tmp_path):
    target = tmp_path / "partial.json"
    words = ("-o", target, "-o", tmp_path / "t.csv", "--explain")
    result = command("run", half_held, *words, "--position", "2", "--position", "1")
    assert result.exit_code == 1
    assert "certified positions only: 1" in result.stdout
    assert "REFUSED  1 of 2 positions certified" in result.stdout
    assert "no method gave a certified answer" in result.stdout
    assert "REFUSED  position 2: " in result.stderr
    assert "t.csv: not written" in result.stderr
    assert not (tmp_path / "t.csv").exists()
    document = json.loads(target.read_text(encoding="utf-8"))
    assert [p["position"] for p in document["positions"]] == [1]
    assert document["refused"]["message"].startswith("position 2: ")
    assert document["refused"]["figures"] == {}


def test_the_failing_figures_are_reported_and_written(command, cases, tmp_path):
    target = tmp_path / "r.json"
    case = cases / "fgfbstts/limit_ring.toml"
    result = command("run", case, "--tolerance", "1e-30", "-o", target)
    assert result.exit_code == 1
    assert "\nREFUSED  positions 1-5: " in result.stderr
    assert "force balance" in result.stderr
    document = json.loads(target.read_text(encoding="utf-8"))
    assert document["case"] == "limit_ring"
    assert document["positions"] == []
    assert math.isfinite(document["refused"]["figures"]["force_balance"])


def test_a_solver_that_cannot_solve_the_class_is_refused(command, cases):
    result = command("run", cases / "fgfbstts/spline_clearance.toml", "--solver", "osqp")
    assert result.exit_code == 1
    assert "osqp does not solve programmes of class SOCP" in result.stderr


def test_all_problems_of_a_case_are_listed_one_per_line(command, broken):
    result = command("run", broken)
    assert result.exit_code == 2
    assert result.stdout == ""
    lines = result.stderr.splitlines()
    assert len(lines) == 4
    assert all("broken.toml" in line for line in lines[:3])
    assert lines[-1] == "3 problems; nothing was solved."


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--solver", "x"), "'--solver': 'x' is not one of 'auto', 'clarabel', 'osqp', 'cvxpy'"),
        (("--method", "x"), "'--method': 'x' is not one of 'newton', 'picard', 'power'"),
        (("--position", "6"), "this case has positions 1 to 5"),
        (("--tolerance", "nan"), "tolerance nan cannot be used for a certificate"),
        (("--tolerance", "0"), "up to 0.001"),
        (("--tolerance", "1e300"), "up to 0.001"),
        (("--set", "operating.torque"), "KEY=VALUE"),
        (("--set", "gears.11.base_radius=1 mm"), "does not exist"),
        (("--colour",), "No such option"),
    ],
)
def test_wrong_usage_leaves_with_2_and_says_what_is_allowed(command, cases, words, message):
    result = command("run", cases / "fgfbstts/base.toml", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stdout == ""


def test_a_missing_case_is_a_problem(command, tmp_path):
    result = command("run", tmp_path / "none.toml")
    assert result.exit_code == 2
    assert "no such file" in result.stderr


def test_a_file_that_cannot_be_written_is_reported(command, cases, tmp_path):
    (tmp_path / "taken").write_text("")
    result = command("run", cases / "fgfbstts/base.toml", "-o", tmp_path / "taken" / "r.json")
    assert result.exit_code == 2
    assert "cannot be written" in result.stderr
    assert "PASSED" in result.stdout


def test_a_case_that_is_written_keeps_laws_that_follow_from_teeth(command, cases, tmp_path):
    """If it is changed again, its laws change like those of the original case."""
    case, width = cases / "planetary/four_planets.toml", "gears.sun.face_width=30 mm"
    command("run", case, "--set", "operating.torque=2 kN*m", "-o", tmp_path / "made.toml")
    change = ("--set", width, "--set", "operating.torque=2 kN*m", "--json")
    found = [json.loads(command("run", c, *change).stdout) for c in (case, tmp_path / "made.toml")]
    assert found[0]["omega"] == found[1]["omega"]
