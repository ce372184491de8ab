"""The reference pages agree with the code."""

from __future__ import annotations

import importlib
import importlib.util
import json
import pkgutil
import re
from pathlib import Path

import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.case.schema import case_schema
from loadshare.settings import ALLOWED, TOLERANCE

ROOT = Path(__file__).parents[2]
_spec = importlib.util.spec_from_file_location("docs_hooks", ROOT / "docs" / "hooks.py")
hooks = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(hooks)


def _tables(schema):
    return [schema, *schema["$defs"].values()]


def test_every_key_of_a_case_is_in_the_reference():
    schema = case_schema()
    page = hooks.case_reference(schema)
    sections = dict(re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL))
    for heading, name, _ in hooks.TABLES:
        table = schema["$defs"][name] if name else schema
        rows = re.findall(r"^\| `(\w+)` \|", sections[heading], re.MULTILINE)
        assert rows == list(table["properties"])
    keys = {key for table in _tables(schema) for key in table["properties"]}
    assert all(f"| `{key}` |" in page for key in keys)


def test_every_name_of_the_library_in_the_pages_is_there():
    text = "".join(page.read_text("utf-8") for page in (ROOT / "docs").rglob("*.md"))
    names = set(re.findall(r"\b(?:loadshare|ls)\.([A-Za-z_.]*[A-Za-z_])", text))
    missing = [name for name in sorted(names) if not _resolved(f"loadshare.{name}")]
    assert not missing


def _resolved(name):
    try:
        return pkgutil.resolve_name(name) is not None
    except (ImportError, AttributeError):
        return False


def test_every_row_has_a_form_and_a_description():
    for row in re.findall(r"^\| `.*$", hooks.case_reference(case_schema()), re.MULTILINE):
        cells = [cell.strip() for cell in row.strip("|").split(" | ")]
        assert len(cells) == 4
        assert all(cells)


def _numbers(schema, field):
    """Return whether a value, or an item of a list or table, is a number or has a unit."""
    options = field.get("oneOf") or field.get("anyOf")
    if options:
        return any(_numbers(schema, option) for option in options)
    inner = field.get("items") or field.get("additionalProperties") or field.get("prefixItems")
    if inner and inner is not True:
        return any(_numbers(schema, i) for i in (inner if isinstance(inner, list) else [inner]))
    return "pattern" in field or field.get("type") in ("number", "integer")


def test_every_number_states_its_unit():
    """The unit is in brackets, such as [length], or [-] without one, for every kind of value."""
    schema = case_schema()
    missing = [
        f"{name}.{key}"
        for name, table in schema["$defs"].items()
        for key, field in table["properties"].items()
        if _numbers(schema, field) and not re.search(r"\[[\w/^() -]+\]", field["description"])
    ]
    assert missing == []
    page = hooks.case_reference(schema)
    kinds = page.partition("## Physical values")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| ([\w' ]+) \| `.*` \| (\S+) \|$", kinds, re.MULTILINE)
    assert len(rows) == len(hooks._kinds()) > 10


def test_every_limit_of_a_case_is_in_the_reference():
    told = {name for _, text in hooks.ALLOWED for name in re.findall(r"\{(\w+)", text)}
    elsewhere = {"options", "file_name", "shape", "line_points"}
    assert told | elsewhere == set(ALLOWED._fields)


def test_defaults_of_a_tolerance_study_are_those_of_the_settings():
    keys = case_schema()["$defs"]["Study"]["properties"]
    assert f"; {TOLERANCE.samples} when left out" in keys["samples"]["description"]
    assert f"; {TOLERANCE.rows} when left out" in keys["indices"]["description"]
    levels = ", ".join(map(str, TOLERANCE.levels))
    assert f"; {levels} when left out" in keys["quantiles"]["description"]


def test_every_key_of_a_result_is_in_its_reference():
    page = (ROOT / "docs" / "results.md").read_text("utf-8")
    page = page.partition("## The JSON form")[2].partition("\n## ")[0]
    document = json.loads(ls.solve(shipped("fgfbstts/limit_ring")).to_json())
    position = document["positions"][0]
    keys = {*document, *document["stamp"], *position, *position["floats"]["4"]}
    for key in ("scales", "validity", "uniqueness", "loads", "elastic", "effort", "claim"):
        keys |= set(position[key])
    assert {key for key in keys if f"`{key}`" not in page} == set()


def test_a_new_definition_is_not_forgotten():
    schema = case_schema()
    schema["$defs"]["Novelty"] = {"description": "New.", "properties": {}}
    with pytest.raises(KeyError, match="Novelty"):
        hooks.case_reference(schema)


def test_links_within_the_reference_lead_somewhere():
    page = hooks.case_reference(case_schema())
    headings = {
        re.sub(r"[^\w]+", "-", heading.lower()).strip("-")
        for heading in re.findall(r"^## (.*)$", page, re.MULTILINE)
    }
    assert set(re.findall(r"\(#([\w-]+)\)", page)) <= headings


def test_every_option_is_in_the_reference():
    from typer.main import get_command

    from loadshare.cli.main import app

    page = hooks.command_reference()
    for name, command in get_command(app).commands.items():
        assert f"## {name}\n" in page
        for parameter in command.params:
            for flag in (*parameter.opts, *parameter.secondary_opts):
                if flag.startswith("-") and not parameter.hidden:
                    assert f"`{flag}`" in page


@pytest.mark.parametrize(
    "name",
    sorted(
        set(
            re.findall(
                r"`((?:train|scene|solver|certify|results)\.[\w.]+)`",
                (ROOT / "docs/theory.md").read_text("utf-8"),
            )
        )
    ),
)
def test_functions_that_the_theory_names_exist(name: str):
    parts = ["loadshare", *name.split(".")]
    for cut in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        for part in parts[cut:]:
            found = getattr(found, part)
        return
    raise AssertionError(name)


def test_every_case_is_listed():
    listed = set(re.findall(r"`([\w/]+\.toml)`", (ROOT / "cases/README.md").read_text("utf-8")))
    there = {str(f.relative_to(ROOT / "cases")) for f in (ROOT / "cases").rglob("*.toml")}
    assert listed == there


def test_what_the_list_of_cases_says_was_measured():
    import loadshare as ls

    rows = re.findall(
        r"^\| `([\w/]+\.toml)` \|.*\| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$",
        (ROOT / "cases/README.md").read_text("utf-8"),
        re.MULTILINE,
    )
    assert rows
    for file, first, second, pair in rows:
        result = ls.solve(ROOT / "cases" / file)
        measured = (result.omega["I"], result.omega["II"], result.pair_omega["II"])
        # Printed with four decimals.
        assert [f"{v:.4f}" for v in measured] == [first, second, pair], file
