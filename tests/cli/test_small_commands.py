"""`check`, `schema`, `new`, `--version`, and the help."""

import json

import pytest

import loadshare as ls


def test_check_tells_ok_for_every_good_case(command, cases):
    result = command("check", cases)
    assert result.exit_code == 0
    assert result.stderr == ""
    lines = result.stdout.splitlines()
    assert len(lines) == len([f for f in cases.rglob("*.toml") if f.parent.name != "pairs"])
    assert all(line.startswith("OK  ") for line in lines)


def test_check_lists_all_problems_of_all_files(command, cases, broken, tmp_path):
    good = cases / "fgfbstts/base.toml"
    result = command("check", broken, good, tmp_path / "none.toml")
    assert result.exit_code == 2
    assert result.stdout == f"OK  {good}\n"
    lines = result.stderr.splitlines()
    assert sum("broken.toml" in line for line in lines) == 3
    assert "no such file" in lines[3]
    assert lines[-1] == "4 problems in 2 of 3 cases."


def test_check_sees_what_only_the_train_shows(command, cases, tmp_path):
    case = tmp_path / "locked.toml"
    base = (cases / "star/floating_sun_3.toml").as_posix()
    text = f"extends = '{base}'\n[meshes.\"planet1-planet2\"]\npressure_angle = '20 deg'\n"
    case.write_text(text + "stiffness = '1e6 N*m/rad'\n", encoding="utf-8")
    result = command("check", case)
    assert result.exit_code == 2
    assert "locked.toml" in result.stderr


def test_check_without_a_case_is_wrong_usage(command, tmp_path):
    assert command("check", tmp_path).exit_code == 2


def test_schema_is_plain_json(command, tmp_path):
    printed = command("schema")
    assert printed.exit_code == 0
    assert json.loads(printed.stdout) == ls.case_schema()
    target = tmp_path / "schema.json"
    assert command("schema", "-o", target).stdout == ""
    assert target.read_text(encoding="utf-8") == printed.stdout


def test_a_new_case_runs_and_is_certified(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = command("new", "My drive")
    assert made.exit_code == 0
    assert "loadshare run 'My drive.toml'" in made.stdout
    result = command("run", "My drive.toml")
    assert result.exit_code == 0
    assert result.stdout.startswith("My drive\n")
    assert "PASSED" in result.stdout


def test_new_does_not_overwrite_unless_forced(command, tmp_path):
    target = tmp_path / "mine.toml"
    target.write_text("mine", encoding="utf-8")
    refused = command("new", "drive", "-o", target)
    assert refused.exit_code == 2
    assert "--force" in refused.stderr
    assert target.read_text(encoding="utf-8") == "mine"
    assert command("new", "drive", "-o", target, "--force").exit_code == 0
    assert 'title = "drive"' in target.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["drive", "drive.toml", "sub/drive"])
def test_a_name_becomes_a_file(command, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    assert command("new", name).exit_code == 0
    (file,) = tmp_path.rglob("*.toml")
    assert file.name == "drive.toml"
    assert 'title = "drive"' in file.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["", ".toml", "/"])
def test_a_case_needs_a_name(command, name):
    assert command("new", name).exit_code == 2


def test_version(command):
    assert command("--version").stdout == f"loadshare {ls.__version__}\n"


def test_the_help_names_every_command(command):
    stdout = command("--help").stdout
    assert all(f"\n  {name} " in stdout for name in ("run", "batch", "check", "schema", "new"))


def test_an_unknown_command_is_wrong_usage(command):
    result = command("slove")
    assert result.exit_code == 2
    assert "No such command" in result.stderr


def test_check_certifies_results_again(command, cases, tmp_path):
    case = cases / "star/floating_sun_3.toml"
    good, arrays, bad = tmp_path / "good.json", tmp_path / "good.nc", tmp_path / "bad.json"
    command("run", case, "--json", good, "--netcdf", arrays)
    result = command("check", good, arrays, case)
    assert result.exit_code == 0
    assert result.stdout.count("1 position certified again") == 2
    document = json.loads(good.read_text(encoding="utf-8"))
    document["positions"][0]["torque"]["sun-planet1"] *= 1.5
    bad.write_text(json.dumps(document), encoding="utf-8")
    result = command("check", good, bad)
    assert result.exit_code == 2
    assert 'bad.json: positions[0].torque."sun-planet1" = ' in result.stderr
    assert "1 problem in 1 of 2 files." in result.stderr


def test_new_writes_a_shipped_case_that_stands_alone(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("fgfbstts/limit_ring", "star/floating_sun_4"):
        made = command("new", "own", "--example", name, "--force")
        assert made.exit_code == 0, made.stderr
        assert ls.load_case("own.toml") == ls.examples(name)
    unknown = command("new", "other", "--example", "star/floating_son_4")
    assert unknown.exit_code == 2
    assert "star/floating_sun_4" in unknown.stderr
    bound = command("new", "other", "--example", "fgfbstts/from_geometry")
    assert bound.exit_code == 2
    assert "cannot be copied alone" in bound.stderr
    both = command("new", "other", "--kind", "star", "--example", "star/floating_sun_4")
    assert both.exit_code == 2
    assert "--example: contradicts --kind" in both.stderr
    assert not (tmp_path / "other.toml").exists()
