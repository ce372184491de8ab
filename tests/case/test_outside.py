"""Files that a case names must be in its own folder, unless its reader allows others."""

import os
from pathlib import Path

import pytest
from tests.support import CASES
from typer.testing import CliRunner

import loadshare as ls
from loadshare.cli.main import app
from loadshare.outside import OUTSIDE
from loadshare.tooth.law.meshes import resolve

BASE = CASES / "fgfbstts" / "base.toml"
PAIR = CASES / "fgfbstts" / "pairs" / "p12.toml"
TELLS = "is outside the folder of the case"


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """Return a folder with a case to inherit in its parent; the environment allows nothing."""
    monkeypatch.delenv(OUTSIDE, raising=False)
    (tmp_path / "above.toml").write_text(BASE.read_text())
    (tmp_path / "case").mkdir()
    return tmp_path / "case"


def written(folder: Path, text: str) -> Path:
    file = folder / "case.toml"
    file.write_text(text)
    return file


def linked(folder: Path) -> str:
    (folder / "near.toml").symlink_to(folder.parent / "above.toml")
    return "near.toml"


WAYS = {
    "above": lambda folder: "../above.toml",
    "absolute": lambda folder: str(folder.parent / "above.toml"),
    "there and back": lambda folder: "deeper/../../above.toml",
    "link": linked,
}


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_a_case_inherits_from_its_own_folder_only(folder, way):
    (folder / "deeper").mkdir()
    file = written(folder, f"extends = {way(folder)!r}\n")
    with pytest.raises(ls.CaseError, match=TELLS):
        ls.load_case(file)
    assert ls.load_case(file, allow_outside=True) == ls.load_case(BASE)


def test_what_is_inherited_stays_in_the_folder_of_the_requested_case(folder):
    """A file further down may refer upwards, as far as that folder."""
    (folder / "deeper").mkdir()
    (folder / "base.toml").write_text(BASE.read_text())
    (folder / "deeper" / "middle.toml").write_text('extends = "../base.toml"\n')
    assert ls.load_case(written(folder, 'extends = "deeper/middle.toml"\n')) == ls.load_case(BASE)
    with pytest.raises(ls.CaseError, match=TELLS):
        ls.load_case(folder / "deeper" / "middle.toml")


@pytest.mark.parametrize("key", ["law_file", "geometry"])
def test_laws_and_teeth_come_from_its_own_folder_only(folder, key):
    (folder / "base.toml").write_text(BASE.read_text())
    secret = folder.parent / "secret"
    secret.write_text("a secret\n")
    laws = f"[meshes.1-2]\n{key} = '../secret'\n"
    text = f'extends = "base.toml"\nremove = [\'meshes."1-2".stiffness\']\n{laws}'
    case = ls.load_case(written(folder, text))
    with pytest.raises(ls.CaseError, match=TELLS) as refused:
        ls.solve(case)
    assert "a secret" not in str(refused.value)
    (problem,) = refused.value.problems
    assert (problem.key, problem.given) == (f'meshes."1-2".{key}', "'../secret'".replace("'", '"'))
    with pytest.raises(ls.CaseError, match="is not valid TOML"):
        ls.solve(ls.load_case(folder / "case.toml", allow_outside=True))


def test_what_its_reader_names_may_lie_anywhere():
    """This includes a change by the reader and a case made in Python: the file is read."""
    changes = {'meshes."1-2".stiffness': None, 'meshes."1-2".geometry': str(PAIR)}
    changed = ls.load_case(BASE).replace(changes)
    for case in (changed, ls.Case(changed.to_dict())):
        with pytest.raises(ls.CaseError, match="p12 has the base radius"):
            resolve(case)


@pytest.mark.parametrize("command", [["run"], ["check"], ["draw"], ["batch"]])
def test_commands_are_allowed_by_an_option(folder, command):
    file = written(folder, 'extends = "../above.toml"\n')
    out = {"draw": ["-o", folder / "a.svg"], "batch": ["-o", folder / "out", "-j", "2"]}
    words = [*command, file, *out.get(command[0], [])]
    refused = CliRunner().invoke(app, [str(word) for word in words])
    assert refused.exit_code != 0
    if command != ["batch"]:
        assert TELLS in refused.output
    done = CliRunner().invoke(app, [str(word) for word in [*words, "--allow-outside"]])
    assert (done.exit_code, OUTSIDE in os.environ) == (0, False), done.output
