"""Mistakes of a new user: a message is judged by the remedy that it proposes."""

import pytest
from tests.cli.conftest import CASES, on_a_screen_of
from tests.exchange import units

from loadshare.case.words import did_you_mean

BASE = CASES / "fgfbstts/base.toml"
RING = CASES / "fgfbstts/limit_ring.toml"
MESH = '[meshes."4-6"]\n'
GEAR = "[gears.4]\n"

IN_A_CASE = {
    # Units as they are written elsewhere.
    MESH + 'stiffness = "8e4 Nm/rad"': "Did you mean N*m/rad?",
    MESH
    + 'stiffness = "8e4 Nm"': "Nm would be N*m, a torque, but a torsional stiffness is needed.",
    MESH + 'stiffness = "8e4 N/mm"': "is a stiffness, but a torsional stiffness is needed.",
    MESH + "pressure_angle = 20": '20 has no unit. Allowed: an angle such as "20 deg".',
    '[operating]\ntorque = "3 kNm"': "Did you mean kN*m?",
    '[operating]\ntorque = "300 lb-ft"': 'Write "300 ft*lbf".',
    '[operating]\nspeed = "8780 RPM"': "Did you mean rpm?",
    '[operating]\nspeed = "8780 1/min"': 'Write "8780 rpm".',
    '[operating]\nspeed = "8780 U/min"': 'Write "8780 rpm".',
    '[operating]\npower = "2000 KW"': "Did you mean kW?",
    '[operating]\npower = "2000 PS"': "Write W, kW or hp: 1 PS is 735.49875 W.",
    '[gears.2]\nbase_radius = "222,8 mm"': "Use a decimal point",
    '[gears.2]\nbase_radius = "8 inches"': 'Write "8 in".',
    '[gears.2]\nbase_radius = "222 MM"': "Did you mean mm?",
    # Keys in a wrong place, or under another name.
    MESH + 'module = "5 mm"': "Teeth belong to the gears, or in a pair file",
    MESH + "teeth = 20": "Teeth belong to the gears, or in a pair file",
    GEAR + 'module = "5 mm"': "gears.4.teeth: is missing. It is required with module.",
    GEAR + "z = 20": "Did you mean teeth?",
    GEAR + 'radius = "20 mm"': "base_radius, inner_radius, outer_radius or tip_radius?",
    GEAR + 'backlash = "5 um"': "backlash belongs in [meshes.NAME].",
    GEAR + 'torque = "5 N*m"': "torque belongs in [operating].",
    GEAR + 'float = "5 um"': "float belongs in [rings.NAME].",
    GEAR + 'clearance = "5 um"': "belongs in [splines.NAME], [rings.NAME] or [bearings.NAME].",
    '[gear.4]\nbase_radius = "20 mm"': "Did you mean gears?",
    '[mesh."4-6"]\npressure_angle = "20 deg"': "Did you mean meshes?",
    'torque = "3 N*m"': "torque belongs in [operating].",
    '[errors.6]\neccentricity = "10 um"': "Allowed: a table of amount, direction, phase.",
    '[errors.6]\ninstallation = "10 um"': "a list of 2 or 3 lengths, or a table of amount",
    # Names.
    '[meshes."4-11"]\nstiffness = "1e6 N*m/rad"': '"11" is not a gear. Allowed: 1, 2,',
    '[operating]\ninput = "sun"': '"sun" is not a gear. Allowed: 1, 2,',
}


@pytest.mark.parametrize(("text", "message"), IN_A_CASE.items(), ids=list(IN_A_CASE))
def test_a_mistake_in_a_case_is_one_message_that_leads_on(command, tmp_path, text, message):
    case = tmp_path / "case.toml"
    case.write_text(f"extends = '{BASE.as_posix()}'\n{text}\n")
    done = command("run", case)
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stderr.splitlines()[1:] == ["1 problem; nothing was solved."]


@pytest.fixture(scope="module")
def box(tmp_path_factory):
    """Write files of all kinds, none of which is a case."""
    folder = tmp_path_factory.mktemp("box")
    command = on_a_screen_of(80)
    found = [f"{folder}/result.{form}" for form in ("json", "nc", "csv", "xlsx", "svg", "html")]
    outputs = [word for file in (*found, f"{folder}/tables/") for word in ("-o", file)]
    assert command("run", RING, "--position", 1, "-q", *outputs).exit_code == 0
    swept = ("sweep", RING, "--over", "rings.4.float=4 um", "--position", 1, "-q", "-o")
    assert command(*swept, folder / "sweep.json").exit_code == 0
    (folder / "answers").mkdir()
    (folder / "answers/one.json").write_bytes((folder / "result.json").read_bytes())
    (folder / "unit.rexs").write_bytes(units.xml(*units.planetary()))
    (folder / "pair.toml").write_bytes((CASES / "fgfbstts/pairs/p12.toml").read_bytes())
    (folder / "law.toml").write_text('kind = "law"\n')
    (folder / "empty.toml").write_text("")
    (folder / "sixteen.toml").write_text('title = "x"', encoding="utf-16")
    (folder / "little.toml").write_bytes('title = "x"'.encode("utf-16-le"))
    (folder / "big.toml").write_bytes('title = "x"'.encode("utf-16-be"))
    (folder / "dangling.toml").symlink_to("nowhere.toml")
    (folder / "other.toml").write_text('[tool.ruff]\nline-length = 100\n[project]\nname = "x"\n')
    return folder


WRONG_FILES = {
    ("run", "result.json"): "is a result, not a case; `loadshare check` certifies it again.",
    ("sweep", "result.nc"): "is netCDF, not a case; if it is a result, `loadshare check`",
    ("run", "sweep.json"): "is the answer of a study, not a case",
    ("run", "result.csv"): "`loadshare import` takes the folder of all tables of a case",
    ("draw", "result.xlsx"): "`loadshare import` makes a case of the tables",
    ("run", "result.svg"): "is a picture, not a case",
    ("report", "result.html"): "is a page, not a case",
    ("run", "tables"): "is a folder of tables; `loadshare import` makes a case of them",
    ("check", "tables"): "is a folder of tables; `loadshare import` makes a case of them",
    ("check", "answers"): "no case file found; to check results, name their files",
    ("run", "unit.rexs"): "is a gear unit in REXS; `loadshare import` makes a case of it",
    ("run", "pair.toml"): "is a pair with a face gear; `loadshare ltca` analyses it",
    ("run", "law.toml"): "is the law of a mesh, which names it under its key law_file",
    ("run", "empty.toml"): "is empty; `loadshare new NAME` writes a case to start from",
    ("run", "sixteen.toml"): "is UTF-16 text; save it as UTF-8",
    ("run", "little.toml"): "is UTF-16 text; save it as UTF-8",
    ("run", "big.toml"): "is UTF-16 text; save it as UTF-8",
    ("run", "dangling.toml"): "nowhere.toml, where there is no file.\n",
    ("run", "other.toml"): "contains none of the sections of a case",
    ("run", "pare.toml"): "no such file or directory. Did you mean pair.toml?",
    ("ltca", BASE): "is a case; `loadshare run` solves it",
    ("import", BASE): "is a case already; `loadshare run` solves it",
}


@pytest.mark.parametrize(("words", "message"), WRONG_FILES.items(), ids=str)
@pytest.mark.quick(4)
def test_a_file_of_another_kind_says_what_it_is_and_who_takes_it(
    command, box, tmp_path, monkeypatch, words, message
):
    monkeypatch.chdir(tmp_path)
    name, file = words
    more = {"sweep": ("--over", "a=1"), "import": ("-o", "none.toml")}.get(name, ())
    done = command(name, box / file, *more)
    assert done.exit_code == 2
    assert message in done.stderr
    assert not (tmp_path / "none.toml").exists()


WORDS = {
    ("solve", BASE): "No such command 'solve'. Did you mean run?",
    ("slove", BASE): "Did you mean run?",
    ("plot", BASE): "Did you mean draw?",
    ("drive.toml",): "To solve a case: loadshare run drive.toml",
    ("frobnicate", BASE): "No such command 'frobnicate'.",
    ("run", BASE, "--over", "a=1"): "It is an option of sweep, critical, tolerance, fit, study.",
    ("run", BASE, "--positions", "1"): "It is an option of ltca.",
    ("run", BASE, "--sett", "a=1"): "Did you mean --set?",
    ("new", "x", "-o", "x.json"): "this command cannot write a JSON file. Allowed: .toml.",
    ("new", "x", "--kind", "planetery"): "Did you mean planetary?",
    ("run", RING, "--set", "rings.4.float"): "is not of the form KEY=VALUE",
    ("run", RING, "--set", "rings.4.float=4 um", "--set", "rings.4.float = 5 um"): (
        "rings.4.float: is given twice, as '4 um' and '5 um'; give it once"
    ),
    ("run", RING, "--set", "rings.4.float=4 um", "--set", 'rings."4".float=5 um'): (
        "rings.\"4\".float: is given twice, as '4 um' and '5 um'; give it once"
    ),
    ("run", RING, "--set", "4.float=4 um"): "Did you mean rings.4.float?",
    ("run", RING, "--set", "rings.4.flaot=4 um"): "Did you mean float?",
    ("run", RING, "--set", "gears.4.base_radius=46"): 'Allowed: a length such as "46 mm".',
    ("sensitivity", RING, "rings.4.flot"): "Did you mean rings.4.float?",
    ("tolerance", RING): "or inputs (--over)",
    ("run", ""): "Invalid value for 'CASE': an empty text is not a file name; is a shell variable",
    ("check", RING, ""): "Invalid value for 'CASES': an empty text is not a file name",
    ("batch", "", "-o", "out"): "Invalid value for 'CASES': an empty text is not a file name",
    ("batch", RING, "-o", "-"): "into a folder; --json prints its summary",
    ("batch", RING, "-o", ""): (
        "Invalid value for '-o' / '--output': an empty text is not a file name"
    ),
    ("import", ""): "Invalid value for 'UNIT': an empty text is not a file name",
}


@pytest.mark.parametrize(("words", "message"), WORDS.items(), ids=str)
def test_a_mistake_on_the_command_line_leads_on(command, words, message):
    done = command(*words)
    assert done.exit_code == 2
    assert message in " ".join(done.stderr.split())


KEYS = ("base_radius", "outer_radius", "teeth", "bore", "profile_shift", "gears.4.float", "planet1")


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("bas_radius", "base_radius"),
        ("Base_Radius", "base_radius"),
        ("baseradius", "base_radius"),
        ("profil_shift", "profile_shift"),
        ("gears.4.flaot", "gears.4.float"),
        ("planett1", "planet1"),
        ("radius", "base_radius or outer_radius"),
        # A word with only a few letters in common, or another number, is not similar.
        *((word, "") for word in ("torque", "planet7", "gears.5.float", "stiffness", "x", "", 3)),
    ],
)
def test_nothing_is_proposed_that_is_not_near(word, found):
    assert did_you_mean(word, KEYS) == (f"Did you mean {found}?" if found else "")
