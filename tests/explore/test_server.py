"""The server: it agrees with `ls.solve`, refuses malformed requests, and keeps no state."""

from __future__ import annotations

import json
import random
import socket
import tomllib
from concurrent.futures import ThreadPoolExecutor
from urllib.parse import urlsplit

import numpy as np
import pytest
from tests.explore.asking import answer, ask
from tests.explore.conftest import SEED
from tests.report.pages import EVIL, EVIL_CASE
from tests.support import CASES, shipped
from tests.tooth.use.pairs import CASE, SPUR, written

import loadshare as ls
from loadshare.case import Case, load_case
from loadshare.explore.answer import answer_of, plain, whole_of
from loadshare.explore.files import case_file
from loadshare.explore.guard import hosts_of
from loadshare.explore.inputs import PageInputs
from loadshare.report.verdict import largest_forces, resting, sharing

FLOAT = "rings.5.float"


def tables_of(case):
    """Return the rows of tables that a page must show for a case, from an independent solve."""
    result = ls.solve(case)
    rows = [plain(sharing(result))["rows"]] if result.stages else []
    if result.positions[0].floats:
        rows.append(plain(resting(result))["rows"])
    forces = [[cell.text for cell in row.values()] for row in largest_forces(result)]
    return [*rows, forces]


def shown(found):
    return [table["rows"] for table in found["tables"]]


@pytest.mark.parametrize("text", ["0 um", "1.5 um", "2.97657 um", "4 um", "0.002 mm"])
@pytest.mark.quick(2)
def test_an_answer_is_that_of_solve(seed, text):
    found = answer(seed, {FLOAT: text, "operating.power": "1234.5 kW"})
    assert found["status"] == "certified"
    case = load_case(SEED).replace({FLOAT: text, "operating.power": "1234.5 kW"})
    assert shown(found) == tables_of(case)


@pytest.mark.parametrize(
    "name",
    [
        "nrel_5mw/gearbox",
        "planetary/differential",
        "star/floating_sun_5",
        "two_path/nasa",
        "fgfbstts/rigid_closed_form",
        "fgfbstts/full_float",
    ],
)
@pytest.mark.quick(2)
def test_any_case_can_be_explored(served, name):
    with served(shipped(name)) as address:
        status, _, case = ask(address, "/case")
        found = answer(address)
        rest = ask(address, "/whole", {})[2]
    assert status == 200
    assert found["status"] == "certified"
    assert shown(found) == tables_of(shipped(name))
    assert "Bound" in rest["trust"]
    assert case["positions"] == found["count"]


def test_many_positions_are_solved_one_by_one(served):
    with served(shipped("fgfbstts/all_elements")) as address:
        found = answer(address, position=7)
        beyond = answer(address, position=5000)
        whole = ask(address, "/whole", {"position": 7})[2]
        first = answer(address)
    assert (found["count"], found["solved"], found["position"]) == (20, 1, 7)
    assert (found["measure"], whole["measure"]) == ("Ω at position 7", "Kγ")
    # The later answer replaces every figure of the one position.
    assert set(found) - set(whole) == set()
    assert shown(whole) == tables_of(shipped("fgfbstts/all_elements"))
    most = ls.solve(shipped("fgfbstts/all_elements")).omega["II"]
    assert max(b["most"] for b in whole["bars"] if b["stage"] == "II") == most
    assert max(b["most"] for b in first["bars"] if b["stage"] == "II") < 0.95 * most
    result = ls.solve(shipped("fgfbstts/all_elements"), positions=[7])
    assert shown(found)[0] == plain(sharing(result))["rows"]
    assert beyond["position"] == 20


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({FLOAT: "3"}, "has no unit"),
        ({FLOAT: 3}, "has no unit"),
        ({FLOAT: "nan um"}, "is not finite"),
        ({FLOAT: "inf um"}, "is not finite"),
        ({FLOAT: "1e308 um"}, "outside the range of any machine"),
        ({FLOAT: "1e999 um"}, "is not finite|outside the range"),
        ({FLOAT: "-1 um"}, "is negative"),
        ({FLOAT: "3 N"}, "a length is needed"),
        ({FLOAT: ""}, "is not a number"),
        ({FLOAT: "<img src=x onerror=alert(1)>"}, "is not a number"),
        ({"meshes.4-6.law_file": "/etc/passwd"}, "is not an input"),
        ({FLOAT: "9" * 500}, "is too long"),
        ({FLOAT: None}, "is not a value"),
    ],
)
def test_a_setting_that_makes_no_case_is_reported(seed, changes, why):
    import re

    found = answer(seed, changes)
    assert found["status"] == "invalid"
    assert re.search(why, " ".join(found["messages"]))
    assert "tables" not in found


def partly_refused():
    """Return more positions than are solved at once; at position 9 two meshes are far too soft."""
    soft = ["4.275e6 N*m/rad"] * 8 + ["1e3 N*m/rad"] + ["4.275e6 N*m/rad"] * 6
    stiffness = {f'meshes."{mesh}".stiffness': soft for mesh in ("4-6", "4-7")}
    return load_case(SEED).replace({"operating.positions": 15, **stiffness})


def test_a_position_without_an_answer_is_reported():
    inputs = PageInputs(partly_refused())
    assert answer_of(inputs, {}, 1)["status"] == "certified"
    whole = whole_of(inputs, {}, 1)
    assert (whole["status"], whole["measure"]) == ("partly refused", "Ω at 14 of 15")
    assert "14 of 15 positions certified" in whole["bound"]
    assert "position 9" in whole["messages"][0]
    refused = answer_of(inputs, {}, 9)
    assert (refused["status"], refused["solved"], refused["count"]) == ("refused", 1, 15)
    whole = whole_of(inputs, {}, 9)
    assert "tables" in whole
    assert "forces" not in whole


@pytest.mark.parametrize(
    ("name", "power"),
    [
        ("limit_ring", "2000 kW"),
        ("limit_ring", "-2000 kW"),
        ("all_elements", "2000 kW"),
        ("all_elements", "-2000 kW"),
        ("all_elements", "0 kW"),
    ],
)
def test_the_arrows_turn_no_idler(name, power):
    """The moments of all drawn forces about the centre of an idler add up to zero."""
    inputs = PageInputs(shipped(f"fgfbstts/{name}"))
    found = answer_of(inputs, {"operating.power": power}, 1)
    view = found["train"]["views"][0]
    places = {mesh["name"]: np.array(mesh["at"]) for mesh in view["meshes"]}
    gears = {gear["name"]: gear for gear in view["gears"]}
    for idler in "6789":
        moments = []
        for force in found["forces"]:
            if idler not in force["mesh"].split("-"):
                continue
            u, v = np.array(view["frame"]) @ force["push"] * force["force"]
            side = 1.0 if f"on gear {idler}:" in force["text"] else -1.0
            x, y = places[force["mesh"]] - gears[idler]["centre"]
            moments.append(side * (x * v - y * u))
        assert sum(moments) == pytest.approx(0.0, abs=1e-3 * max(map(abs, moments), default=0.0))
    rows = [row for row in found["states"]["rows"] if row[0] == "mesh 8-10"]
    flanks = [force for force in found["forces"] if force["mesh"] == "8-10"]
    assert len(flanks) == (2 if power == "0 kW" else 1)
    assert [float(row[2]) for row in rows] == pytest.approx([f["force"] for f in flanks], rel=1e-4)
    assert all(row[1].endswith(" flank closed") for row in rows)


def test_a_value_is_returned_in_the_unit_of_the_slider(seed):
    given = {FLOAT: "0.002 mm", "operating.power": "-2 MW"}
    assert answer(seed, given)["numbers"] == {FLOAT: 2.0, "operating.power": -2000.0}


def test_a_refused_setting_is_reported(seed):
    """The load would compress teeth by more than their height."""
    found = answer(seed, {"operating.power": "2e9 kW"})
    assert found["status"] == "refused"
    assert len(found["messages"]) == 5
    assert "displacements are too large" in found["messages"][0]
    assert "tables" not in found


BODIES = [
    (b"", 400),
    (b"[]", 400),
    (b"null", 400),
    (b"{", 400),
    (b'{"position": NaN}', 400),
    (b'{"changes": {"rings.4.float": "\\ud800 um"}}', 400),
    (b'{"position": 1e308}', 400),
    (b'{"position": 1e999}', 400),
    (b'{"changes": {"rings.4.float": 1' + b"0" * 400 + b"}}", 400),
    (b'{"position": -1}', 400),
    (b'{"position": true}', 400),
    (b'{"changes": []}', 400),
    (b"[" * 100_000, 400),
    (b'{"a":' * 20_000, 400),
    (b"\xff\xfe", 400),
    (b" " * 300_000, 413),
]


@pytest.mark.parametrize(("body", "status"), BODIES)
def test_odd_requests_are_answered_with_a_message(seed, body, status):
    path = "/answer"
    found = ask(seed, path, body)
    assert found[0] == status
    assert found[2]["status"] == "failed"
    assert found[2]["messages"]


def test_other_methods_types_and_paths(seed):
    assert ask(seed, "/answer")[0] == 405
    assert ask(seed, "/nowhere")[0] == 404
    assert ask(seed, "/answer", b"{}", {"Content-Type": "text/plain"})[0] == 415
    for path in ("/page/../server.py", "/page/%2e%2e%2fserver.py", "/page//etc/passwd", "/page/x"):
        assert ask(seed, path)[0] == 404


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"Host": "localhost:{port}"}, 200),
        ({"Host": "evil.example"}, 403),
        ({"Host": "127.0.0.1"}, 403),
        ({"Host": "127.0.0.1:1"}, 403),
        ({"Host": ""}, 403),
        ({"Origin": "http://127.0.0.1:{port}"}, 200),
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": "http://localhost:{port}"}, 403),
        ({"Sec-Fetch-Site": "same-origin"}, 200),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
        ({"Sec-Fetch-Site": "same-site"}, 403),
    ],
)
@pytest.mark.parametrize("path", ["/", "/case", "/answer"])
def test_who_may_ask(seed, path, headers, status):
    port = urlsplit(seed).port
    sent = {name: value.format(port=port) for name, value in headers.items()}
    found = ask(seed, path, {} if path == "/answer" else None, sent)
    assert found[0] == status
    assert "default-src 'none'" in found[1]["content-security-policy"]
    assert "unsafe" not in found[1]["content-security-policy"]
    assert "access-control-allow-origin" not in found[1]


def test_further_names():
    hosts = hosts_of("0.0.0.0", 8000, ["Gears.example", "proxy.example:443"])
    assert {"gears.example", "gears.example:8000", "proxy.example:443"} <= hosts
    assert "0.0.0.0:8000" not in hosts
    assert "[::1]:80" in hosts_of("::1", 80)
    assert "localhost" in hosts_of("127.0.0.1", 80)


@pytest.mark.slow
def test_a_hundred_at_once_do_not_mix(served):
    """Everybody gets the answer to their own setting, whoever else asks at the same time."""
    draw, case = random.Random(5), shipped("star/floating_sun_4")
    texts = [f"{draw.uniform(100.0, 900.0):.3f} N*m" for _ in range(12)]
    wanted = {text: tables_of(case.replace({"operating.torque": text})) for text in texts}
    requests = [draw.choice(texts) for _ in range(100)]
    with served(case) as address, ThreadPoolExecutor(100) as people:
        found = list(people.map(lambda text: answer(address, {"operating.torque": text}), requests))
    assert all(shown(one) == wanted[text] for one, text in zip(found, requests, strict=True))
    assert len({str(rows) for rows in wanted.values()}) == len(texts)


def test_someone_who_goes_away_does_no_harm(seed, caplog):
    parts = urlsplit(seed)
    body = json.dumps({"changes": {}}).encode()
    for cut in (0, 5, len(body)):
        with socket.create_connection((parts.hostname, parts.port)) as line:
            head = (
                f"POST /answer HTTP/1.1\r\nHost: {parts.netloc}\r\n"
                f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
            )
            line.sendall(head.encode() + body[:cut])
    assert answer(seed)["status"] == "certified"
    assert caplog.records == [], "nothing has failed"


def test_a_setting_is_saved_as_a_case_that_extends_the_original(seed, tmp_path):
    changes = {FLOAT: "3.3 um", "errors.6.installation.direction": "10 deg"}
    found = ask(seed, "/toml", {"changes": changes})[2]
    written = tomllib.loads(found["text"])
    assert written["extends"] == "limit_ring.toml"
    assert set(written) == {"extends", "rings", "errors"}
    for name in ("base.toml", "limit_ring.toml"):
        (tmp_path / name).write_text((CASES / "fgfbstts" / name).read_text())
    (tmp_path / found["name"]).write_text(found["text"])
    case = load_case(tmp_path / found["name"])
    inputs = PageInputs(load_case(SEED))
    assert case == inputs.case.replace(inputs.changes(changes))
    assert ask(seed, "/toml", {"changes": {FLOAT: "3"}})[2]["status"] == "invalid"
    # The file itself is consistent, but its train is not.
    wrong = {"gears.6.base_radius": "200 mm"}
    for path in ("/answer", "/toml"):
        assert ask(seed, path, {"changes": wrong})[2]["status"] == "invalid", path


def test_what_the_command_line_changed_is_saved_as_well(served, tmp_path):
    case = load_case(SEED).replace({"rings.4.float": "1 um"})
    with served(case, SEED) as address:
        found = ask(address, "/toml", {"changes": {FLOAT: "2 um"}})[2]
    assert tomllib.loads(found["text"])["rings"] == {
        "4": {"float": "1 um"},
        "5": {"float": "2 um"},
    }


def test_a_case_that_lacks_a_key_of_its_file_is_saved_whole(served):
    case = load_case(SEED).replace({"errors.6": None})
    with served(case, SEED) as address:
        found = ask(address, "/toml", {"changes": {}})[2]
    assert Case(tomllib.loads(found["text"])) == case
    assert "does not extend the original file" in found["note"]


def test_a_case_whose_file_is_gone_is_saved_whole(served, tmp_path):
    """The setting used to be lost, and the message gave the path of the file."""
    for name in ("base.toml", "limit_ring.toml"):
        (tmp_path / name).write_text((CASES / "fgfbstts" / name).read_text())
    file = tmp_path / "limit_ring.toml"
    case = load_case(file)
    file.unlink()
    with served(case, file) as address:
        found = ask(address, "/toml", {"changes": {FLOAT: "2 um"}})[2]
    assert Case(tomllib.loads(found["text"])) == case.replace({FLOAT: "2 um"})
    assert "does not extend the original file, as that cannot be read any more" in found["note"]
    assert str(tmp_path) not in str(found)


def test_a_case_saved_whole_needs_no_file_of_a_law(tmp_path):
    written(tmp_path, SPUR, "spur.toml")
    file = written(
        tmp_path, CASE + 'geometry = "spur.toml"\n[errors.b]\ninstallation = ["0 um", "0 um"]'
    )
    case = load_case(file).replace({"errors": None})
    found = case_file(PageInputs(case), {}, file)
    assert "does not extend the original file" in found["note"]
    assert ls.solve(Case(tomllib.loads(found["text"]))).positions[0].certificate.passed


def test_hostile_texts_travel_as_texts(served):
    case = Case(tomllib.loads(EVIL_CASE), name="evil")
    with served(case) as address:
        status, headers, found = ask(address, "/case")
        page = ask(address, "/")[2].decode()
    assert status == 200
    assert headers["content-type"] == "application/json"
    assert found["title"] == EVIL
    assert EVIL not in page


def test_an_answer_has_no_number_that_is_none():
    """Browsers cannot read NaN or infinity."""
    for name in ("fgfbstts/limit_ring", "star/floating_sun_3"):
        json.dumps(answer_of(PageInputs(shipped(name)), {}, 1), allow_nan=False)
