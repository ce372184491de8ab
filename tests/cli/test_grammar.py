"""One grammar: what all commands have in common, and old option names that still work."""

import json
import os
import signal
import subprocess
import sys

import pytest
from tests.cli.conftest import CASES, START, plain_environment
from tests.support import mostly_slow
from typer.main import get_command

import loadshare as ls
from loadshare.cli.forms import FORMS, read_output
from loadshare.cli.main import CASES as READING
from loadshare.cli.main import SCRIPTED, app
from loadshare.cli.old_words import OLD, renewed

RING = CASES / "fgfbstts/limit_ring.toml"
BASE = CASES / "fgfbstts/base.toml"


def options(name: str) -> dict[str, object]:
    """Return the options of a command by all their names."""
    found = get_command(app).commands[name].params
    return {option: p for p in found if p.param_type_name == "option" for option in p.opts}


COMMANDS = sorted(get_command(app).commands)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_takes_the_same_words(name):
    known = options(name)
    assert {"-q", "--quiet"} <= set(known)
    assert ("--set" in known) == (name in {command.__name__ for command in READING})
    if name in {command.__name__ for command in SCRIPTED} | {"check", "batch"}:
        assert "--json" in known
    if "-o" in known:
        assert known["-o"] is known["--output"]
    else:
        assert name in ("check", "explore", "warm")
    # No old name is an option in its own right, except two of `critical`, which are hidden.
    assert not set(OLD) - {"--json"} & set(known)
    hidden = {option for option, p in known.items() if p.hidden}
    assert hidden == ({"--from", "--to"} if name == "critical" else set())


FILES = ("json", "nc", "csv", "parquet", "xlsx", "html", "svg", "png", "pdf")
STARTS = {
    "json": b"{",
    "nc": b"\x89HDF",
    "csv": b"",
    "parquet": b"PAR1",
    "xlsx": b"PK",
    "html": b"<!",
    "svg": b"<svg",
    "png": b"\x89PNG",
    "pdf": b"%PDF",
    "toml": b"",
}
MEASURED = (
    "--set",
    'measured.tried={ position = 1, pair_share = { "6-10" = 0.99 }, uncertainty = 0.01 }',
)
RESULTS = {
    "run": (("--position", 1), (*FILES, "toml")),
    "sweep": (("--over", "rings.4.float=0 um, 4 um", "--position", 1), FILES),
    "critical": (("--over", "rings.4.float=7 um:9 um", "--position", 1), FILES),
    "sensitivity": (("rings.*.float", "--position", 1), FILES),
    "compare": (MEASURED, FILES),
    "fit": ((*MEASURED, "--over", "rings.4.float=1 um:9 um"), (*FILES, "toml")),
    "march": (("--gear", 4, "--revolutions", 1, "--steps", 1), FILES),
    "tolerance": (
        *[("--over", "rings.*.float=1 um:9 um", "--samples", 16, "--position", 1, "--no-worst")],
        FILES,
    ),
}


@pytest.mark.parametrize("name", mostly_slow(RESULTS, RESULTS.keys() - {"tolerance"}))
@pytest.mark.quick(2)
def test_every_result_is_written_in_every_form(command, tmp_path, name):
    words, forms = RESULTS[name]
    files = [tmp_path / f"found.{form}" for form in forms]
    outputs = [word for file in files for word in ("-o", file)]
    done = command(name, RING, *words, "--quiet", *outputs)
    assert (done.exit_code, done.output) == (0, "")
    for form, file in zip(forms, files, strict=True):
        content = file.read_bytes()
        assert content.startswith(STARTS[form])
        assert len(content) > 60
    import pandas as pd

    tables = pd.read_csv(tmp_path / "found.csv"), pd.read_parquet(tmp_path / "found.parquet")
    assert list(tables[0].columns) == list(tables[1].columns)
    assert len(tables[0]) == len(tables[1]) > 0
    json.loads((tmp_path / "found.json").read_text())
    if name == "run":
        assert ls.load_result(files[0]) == ls.load_result(files[1])
        assert ls.load_case(files[-1]).hash == ls.load_case(RING).hash


def test_what_a_study_held_by_a_case_is_written_and_varied(command, tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(f"""extends = '{RING.as_posix()}'
[study.floats]
kind = "sweep"
over = {{ "rings.4.float" = "0 um:8 um:5" }}
positions = [1]
[study.march]
kind = "march"
gear = "4"
revolutions = 1.0
steps = 1
""")
    file = tmp_path / "found.json"
    varied = ("--over", "rings.4.float=2 um, 4 um", "-o", file)
    assert command("study", case, "floats", *varied).exit_code == 0
    rows = json.loads(file.read_text())["rows"]
    assert {row["rings.4.float [um]"] for row in rows} == {2.0, 4.0}
    refused = command("study", case, "march", "--over", "rings.4.float=2 um, 4 um")
    assert refused.exit_code == 2
    assert "a march does not vary inputs over values" in refused.stderr
    refused = command("study", case, "floats", "-o", tmp_path / "found.toml")
    assert refused.exit_code == 2
    assert "a sweep can write .csv" in refused.stderr.replace("\n", " ")


@pytest.mark.parametrize(
    ("text", "form", "file"),
    [
        ("a.json", "json", "a.json"),
        ("a.HTM", "html", "a.HTM"),
        ("csv:/dev/null", "csv", "/dev/null"),
        ("nc:-", "nc", "-"),
        ("-", "json", "-"),
        ("c:a.csv", "csv", "c:a.csv"),
        ("box/", "folder", "box"),
    ],
)
def test_the_ending_or_a_word_tells_the_form(text, form, file):
    found = read_output(text, ("json", *FORMS))
    assert (found.form, str(found.file)) == (form, file)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("run", RING, "-o", "x.txt"), "unknown ending .txt. Allowed: "),
        (("run", RING, "-o", "x"), "it has no ending, which says what to write"),
        (("sweep", RING, "--over", "a=1", "-o", "x.toml"), "this command cannot write a case."),
        (("compare", RING, "-o", "x.toml"), "this command cannot write a case."),
        (("run", RING, "-o", "-", "-o", "csv:-"), "only one file can go to standard output"),
        (("run", RING, "-o", "-", "--json"), "only one file can go to standard output"),
        (
            ("run", RING, "-o", "x.csv", "-o", "json:x.csv"),
            "would be written twice in different forms",
        ),
        (("run", RING, "-o", "x.csv", "-o", "x.csv"), "would be written twice; name it once"),
        (("critical", RING), "is missing: KEY=FROM:TO"),
        (("critical", RING, "--over", "a=1"), "is not of the form KEY=FROM:TO"),
        (("critical", RING, "--over", "a=1:2:3"), "is not of the form KEY=FROM:TO"),
        (("critical", RING, "--over", "a=1:2", "--over", "b=1:2"), "takes one range"),
        (("critical", RING, "a", "--over", "a=1:2"), "gives everything: leave out"),
        (("sweep", RING, "--over", "a=1, 2", "--over", "a=3, 4"), "a: is given twice"),
        (("fit", RING, "--over", "a=1:2", "--over", "a=1:3"), "a: is given twice"),
        (("tolerance", RING, "--over", "a=1:2", "--over", "a=1:3"), "a: is given twice"),
    ],
)
def test_what_cannot_be_written_or_varied_is_reported(command, words, message):
    done = command(*words)
    assert done.exit_code == 2
    assert message in " ".join(done.stderr.split())
    assert done.stdout == ""


def test_json_is_for_scripts(command, broken):
    done = command("run", RING, "--position", 1, "--json")
    assert json.loads(done.stdout) == json.loads(ls.solve(RING, positions=[1]).to_json())
    assert done.stderr == ""
    checked = command("check", RING, broken, "--json")
    assert checked.exit_code == 2
    good, bad = json.loads(checked.stdout)["files"]
    assert good == {"file": str(RING), "ok": True, "problems": []}
    assert [p["key"] for p in bad["problems"]] == [
        *("colour", "gears.2.base_radius", "gears.3.base_radius")
    ]


def test_batch_and_report_and_check_change_the_case(command, tmp_path):
    box, page = tmp_path / "box", tmp_path / "page.html"
    change = ("--set", "rings.4.float=20 um")
    batch = command("batch", BASE, "-j", 1, "-o", box, *("--set", "title=Changed"), "--json")
    assert json.loads(batch.stdout)["passed"] is True
    assert ls.load_result(box / "base.json").case.title == "Changed"
    assert command("report", BASE, "-o", page, "--set", "title=Changed").exit_code == 0
    assert "Changed" in page.read_text()
    assert "rings.4" in command("check", BASE, *change).stderr


@pytest.mark.parametrize(
    ("command_", "old", "new"),
    [
        ("march", "CASE --with a=1", "CASE --set a=1"),
        ("march", "CASE --with=a=1", "CASE --set a=1"),
        ("sweep", "CASE --set a=1:2:3 --with b=1", "CASE --over a=1:2:3 --set b=1"),
        ("sweep", "CASE --over a=1:2:3 --set b=1", "CASE --over a=1:2:3 --set b=1"),
        ("fit", "CASE --unknown a=1:2", "CASE --over a=1:2"),
        ("run", "CASE --csv a --netcdf b", "CASE -o csv:a -o nc:b"),
        ("run", "CASE --tables a --tables b.xlsx", "CASE -o folder:a -o xlsx:b.xlsx"),
        ("run", "CASE --json a.json", "CASE -o json:a.json"),
        ("run", "CASE --json -", "CASE -o json:-"),
        ("run", "CASE --json", "CASE --json"),
        ("run", "CASE --json --csv a", "CASE --json -o csv:a"),
        ("run", "--json CASE.toml", "--json CASE.toml"),
        ("sweep", "CASE --over a=1 --json", "CASE --over a=1 --json"),
        ("run", "CASE --set", "CASE --set"),
        ("run", "CASE --csv", "CASE -o"),
        ("run", "-- --with", "-- --with"),
    ],
)
def test_old_words_are_renewed(command_, old, new):
    assert renewed(command_, old.split())[0] == new.split()


def test_old_words_go_on_working_with_a_note(command, tmp_path):
    old = command(
        *("critical", RING, "rings.4.float", "--from", "8 um", "--to", "9 um"),
        *("--position", 1, "--with", "title=Ring"),
    )
    new = command(
        "critical", RING, "--over", "rings.4.float=8 um:9 um", "--position", 1, "--set", "title=x"
    )
    assert (old.exit_code, old.stdout, new.stderr) == (0, new.stdout, "")
    assert "Note: --with is now --set." in old.stderr
    assert "Note: KEY --from FROM --to TO is now --over KEY=FROM:TO." in old.stderr
    one, other = tmp_path / "one", tmp_path / "other.json"
    words = ("run", RING, "--position", 1, "-q")
    assert command(*words, "--json", one).output == ""
    assert command(*words, "-o", other).output == ""
    assert one.read_bytes() == other.read_bytes()


def test_quiet_says_what_went_wrong(command, half_held, monkeypatch):
    assert command("run", RING, "-q").output == ""
    assert command("check", RING, "-q").output == ""
    monkeypatch.setattr("loadshare.job.warm.warm", lambda: None)
    assert command("warm", "-q").output == ""
    assert command("warm").stdout == "The compiled code is on disk.\n"
    refused = command("run", half_held, "-q")
    assert (refused.exit_code, refused.stdout) == (1, "")
    assert refused.stderr.startswith("REFUSED  position 2: ")


def proposed(line: str) -> list[str]:
    """Return the completions that the shell proposes at the end of a line."""
    words = line.split(" ")
    count = str(len(words) - 1)
    variables = {"COMP_WORDS": line, "COMP_CWORD": count, "_LOADSHARE_COMPLETE": "complete_bash"}
    done = subprocess.run(
        [sys.executable, "-c", START],
        capture_output=True,
        text=True,
        check=False,
        env=plain_environment(**variables),
    )
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("loadshare sens", ["sensitivity"]),
        ("loadshare sweep x --ov", ["--over"]),
        (f"loadshare run {RING} --set rings.4.fl", ["rings.4.float="]),
        (f"loadshare march {RING} --gear ", [str(k) for k in range(1, 11)]),
        (f"loadshare sensitivity {RING} rings.5.fl", ["rings.5.float"]),
        (f"loadshare study {CASES / 'fgfbstts/tolerance.toml'} ", ["errors"]),
        ("loadshare new x --kind st", ["star"]),
        ("loadshare run none.toml --set ri", []),
    ],
)
@pytest.mark.quick(2)
def test_the_shell_completes_names(line, found):
    assert proposed(line) == found


@pytest.mark.skipif(os.name != "posix", reason="no such signals on this system")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_who_stops_a_command_is_told_what_is_kept(command, monkeypatch, number, code):
    def stopped(*_, progress, **__):
        progress(12, 61)
        os.kill(os.getpid(), number)
        pytest.fail("the signal was not taken")

    monkeypatch.setattr("loadshare.study.sweep.sweep", stopped)
    handlers = {one: signal.getsignal(one) for one in (signal.SIGINT, signal.SIGTERM)}
    # A shell makes background processes ignore SIGINT.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        done = command("sweep", RING, "--over", "rings.*.float=0 um:12 um:61")
    finally:
        for one, handler in handlers.items():
            signal.signal(one, handler)
    assert done.exit_code == code
    assert done.stderr == (
        "Interrupted after 12 of 61 points. Nothing is kept. "
        "The same command starts from the beginning.\n"
    )
