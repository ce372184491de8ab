from pathlib import Path

import pytest

import loadshare as ls
from loadshare.case import load_case
from loadshare.errors import CaseError

ROOT = Path(__file__).parents[2]


def write(folder: Path, **files: str) -> Path:
    """Write files by stem; return the path of the last one."""
    for stem, text in files.items():
        path = folder / f"{stem}.toml"
        path.write_text(text, encoding="utf-8")
    return path


def message_of(path: Path, relative_to: Path) -> str:
    with pytest.raises(CaseError) as caught:
        load_case(path)
    return str(caught.value).replace(f"{relative_to}/", "")


def test_a_case_is_named_after_its_file(drive):
    assert drive.name == "drive"
    assert repr(drive) == "Case(drive: 4 gears, 2 meshes)"


def test_tables_merge_and_the_rest_is_replaced(tmp_path, drive_text):
    own = """
extends = "base.toml"
remove = ['meshes."c-d".stiffness', "stages"]
title = "Changed"
[gears.a]
support = "free"
[meshes."c-d".law]
b = "1e-6 rad/(N*m)"
"""
    case = load_case(write(tmp_path, base=drive_text, changed=own))
    assert case.title == "Changed"
    assert case.gears["a"].support == "free"
    assert case.gears["a"].base_radius.text == "46.9846 mm"
    assert case.meshes["c-d"].stiffness is None
    assert case.stages == {}


def test_what_a_base_assumes_stays_assumed(tmp_path, drive_text):
    own = 'extends = "base.toml"\nassumed = ["gears.b"]\n'
    case = load_case(write(tmp_path, base=drive_text, own=own))
    assert case.assumed == ("gears.*.base_radius", "gears.b")
    assert case.is_assumed("gears.a.base_radius")
    assert case.is_assumed("gears.b.centre.angle")
    assert not case.is_assumed("gears.a.centre")
    assert not case.is_assumed('meshes."a-b".stiffness')


def test_what_is_removed_is_assumed_no_more(tmp_path, drive_text):
    """Patterns that covered nothing else go with it; those that never matched are reported."""
    base = f'assumed = ["stages.*", "meshes.*", "stages.none"]\n{drive_text}'
    base = base.replace('assumed = ["gears.*.base_radius"]\n', "")
    own = 'extends = "base.toml"\nremove = ["stages"]\nassumed = ["gears.b"]\n'
    path = write(tmp_path, base=base, own=own)
    assert message_of(path, tmp_path).splitlines() == [
        'base.toml: assumed[1] = "stages.none": matches no key of the case.'
    ]
    path = write(tmp_path, base=base.replace(', "stages.none"', ""), own=own)
    assert load_case(path).assumed == ("meshes.*", "gears.b")
    whole = load_case(tmp_path / "base.toml")
    assert whole.assumed == ("stages.*", "meshes.*")
    assert whole.replace({"stages": None}).assumed == ("meshes.*",)
    assert whole.replace({"title": None}).assumed == whole.assumed


def test_inheritance_chains_and_problems_name_the_file_of_the_key(tmp_path, drive_text):
    middle = 'extends = "base.toml"\n[gears.a]\nsupport = "3 kg"\nteeth = 20\n'
    top = 'extends = "middle.toml"\nassumed = ["x"]\n[gears.a]\nteeth = 2\n'
    bad = drive_text.replace('"150 mm", "150 mm"', '"150 mm", "15 mm/s"')
    path = write(tmp_path, base=bad, middle=middle, top=top)
    assert message_of(path, tmp_path).splitlines() == [
        "top.toml: gears.a.teeth = 2: is not valid here. Allowed: a number of at least 5.",
        'middle.toml: gears.a.support = "3 kg": is a mass, but a stiffness is needed. '
        'Allowed: "rigid", "free", or a stiffness such as "1.78e7 N/m".',
        'base.toml: gears.d.centre[1] = "15 mm/s": is a speed, but a length is needed. '
        'Allowed: a length such as "45.9 mm".',
        'top.toml: assumed[1] = "x": matches no key of the case.',
    ]


def test_later_rooms_can_name_a_key_with_its_file(tmp_path, drive_text):
    own = 'extends = "base.toml"\n[gears.a]\nsupport = "free"\n'
    path = write(tmp_path, base=drive_text, own=own)
    case = load_case(path)
    problem = case.problem('meshes."c-d".stiffness[2]', "is odd", "less", "Think.")
    expected = f'{tmp_path / "base.toml"}: meshes."c-d".stiffness[2] = "3e6 N*m/rad": is odd.'
    assert str(problem) == f"{expected} Allowed: less. Think."
    assert case.problem("gears.a.support", "x").file == str(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[gears.a]\nteeth = = 3\n",
            "bad.toml: is not valid TOML at line 2, column 9: invalid value.",
        ),
        (
            'extends = "nowhere.toml"\n',
            'bad.toml: extends = "nowhere.toml": there is no such file.',
        ),
        (
            'extends = "bad.toml"\n',
            'bad.toml: extends = "bad.toml": is circular: bad.toml → bad.toml.',
        ),
        (
            "extends = 3\n",
            'bad.toml: extends = 3: is not a file. Allowed: a file such as "base.toml".',
        ),
        (
            'extends = "base.toml"\nremove = ["gears.aa", 3]\n',
            'bad.toml: remove[0] = "gears.aa": is not inherited. Did you mean gears.a?\n'
            "bad.toml: remove[1] = 3: is not a key path. "
            'Allowed: a text such as "errors.6".',
        ),
        (
            'extends = "base.toml"\nremove = "gears.a"\n',
            'bad.toml: remove = "gears.a": is not valid here. '
            'Allowed: a list such as ["errors.6"].',
        ),
        (
            'extends = "base.toml"\nname = "x"\norigin = "y"\n',
            'bad.toml: name = "x": unknown key. Allowed: title, source, notes, assumed, operating, '
            "march, gears, meshes, shafts, splines, rings, bearings, errors, stages, measured, "
            "study.\n"
            'bad.toml: origin = "y": unknown key. Allowed: title, source, notes, assumed, '
            "operating, march, gears, meshes, shafts, splines, rings, bearings, errors, stages, "
            "measured, study.",
        ),
    ],
)
def test_a_file_that_cannot_be_read_is_reported(tmp_path, drive_text, text, message):
    assert message_of(write(tmp_path, base=drive_text, bad=text), tmp_path) == message


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("p12.toml", "is a pair with a face gear; `loadshare ltca` analyses it"),
        ("p46.toml", "is a pair of gears; `loadshare ltca` analyses it"),
        ("law.toml", "is the law of a mesh, which names it under its key law_file"),
        ("result.json", "is a result, not a case; `loadshare check` certifies it again"),
        ("result.nc", "is netCDF, not a case; if it is a result, `loadshare check` certifies"),
    ],
)
def test_another_file_says_what_it_is(tmp_path, cases, name, message):
    pairs = cases / "fgfbstts" / "pairs"
    path = pairs / name if (pairs / name).exists() else tmp_path / name
    starts = {
        "law.toml": b'kind = "law"\n',
        "result.json": b'{"positions": []}',
        "result.nc": b"\x89HDF\r\n",
    }
    if path.parent == tmp_path:
        path.write_bytes(starts[name])
    assert message in message_of(path, path.parent)


def test_a_file_that_is_not_there_is_reported(tmp_path):
    missing = message_of(tmp_path / "missing.toml", tmp_path)
    assert missing == "missing.toml: no such file or directory."
    with pytest.raises(ls.CaseError, match=r'^"": no such file or directory\.$'):
        ls.load_case("")


def test_what_is_no_path_is_reported_with_what_is_wanted():
    for value in ({"gears": {}}, b"case.toml", None, 3):
        kind = type(value).__name__
        with pytest.raises(TypeError, match=f"path of a case file is needed, not {kind}; Case"):
            ls.solve(value)


def test_a_file_that_is_not_text_is_reported(tmp_path):
    path = tmp_path / "latin.toml"
    path.write_bytes(b'title = "\xfc"\n')
    assert message_of(path, tmp_path) == "latin.toml: is not UTF-8 text at byte 9."


def test_an_empty_file_is_one_problem(tmp_path):
    message = message_of(write(tmp_path, empty="\n"), tmp_path)
    assert message == "empty.toml: is empty; `loadshare new NAME` writes a case to start from."


def test_a_case_without_its_sections_lacks_them(tmp_path):
    assert message_of(write(tmp_path, bare='title = "x"\n'), tmp_path).splitlines() == [
        "bare.toml: operating: is missing. The operating point: where the power enters and "
        "leaves, and how much of it.",
        "bare.toml: gears: is missing. The gears, by name.",
        "bare.toml: meshes: is missing. The meshes; one named a-b joins the driver a to the "
        "driven gear b.",
    ]


def test_a_bad_value_does_not_hide_an_unknown_name_beside_it(tmp_path):
    """The ring's clearance is wrong, and so is its neighbour; both are reported together."""
    text = (ROOT / "cases/fgfbstts/limit_ring.toml").read_text(encoding="utf-8")
    base = ROOT / "cases/fgfbstts/base.toml"
    text = text.replace('"base.toml"', f'"{base}"').replace('["9", "8"]', '["9", "88"]')
    file = tmp_path / "two.toml"
    file.write_text(
        text.replace('"0 um"\nfloat = "2.74', '"-1 um"\nfloat = "2.74'), encoding="utf-8"
    )
    with pytest.raises(CaseError) as caught:
        load_case(file)
    keys = [p.key for p in caught.value.problems]
    assert keys == ["rings.5.clearance", "rings.5.neighbours[1]"]


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("torque = 100 N*m", 'Put texts, and values with their unit, in quotes: "100 N*m".'),
        (
            "support = rigid # in its bearing",
            'Put texts, and values with their unit, in quotes: "rigid".',
        ),
        ("centre = [0 mm, 1 mm]", 'Put texts, and values with their unit, in quotes: "0 mm".'),
        ("torque = “100 N*m”", 'Quotes are straight: "100 N*m".'),
        ("held = True", "Write true or false."),
        ("module = 4,5", "Use a decimal point: 4.5."),
        ("profile_shift = -.5", "Write -0.5."),
        ("teeth = 018", "Write 18."),
        ("teeth = 18;", "Nothing follows a value: drop the ; there."),
        ("teeth: 18", "Write teeth = 18."),
        ("// teeth", "A comment begins with #."),
        ('module = "5 mm', 'A text begins and ends with " on one line.'),
        (
            "[gears.high speed]",
            'Put a name of more than letters, digits, _ and - in quotes: [gears."high speed"].',
        ),
        ("[gears.b] teeth = 18", "Begin a new line after the head of a table."),
        ("title = 1\ntitle = 2", ""),
        ("teeth = = 3", ""),
    ],
)
def test_a_slip_in_toml_comes_with_what_to_write(line, hint, tmp_path):
    path = write(tmp_path, bad=f"[gears.a]\n{line}\n")
    with pytest.raises(CaseError, match="is not valid TOML at line") as caught:
        load_case(path)
    assert [problem.hint for problem in caught.value.problems] == [hint]
