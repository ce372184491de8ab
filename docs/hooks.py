"""What the documentation takes from the code when it is built (an mkdocs hook).

The case reference follows from the JSON Schema, the options of the command line from the command,
and formulas become MathML, which browsers show without any script.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

Schema = Mapping[str, Any]


class Kind(NamedTuple):
    """A kind of physical value, and the SI unit in which it is kept."""

    name: str
    unit: str


CASE_REFERENCE = "<!-- case reference -->"
COMMANDS = "<!-- commands -->"

# The tables of a case file in the order of reading: heading, definition, where it stands.
TABLES = (
    ("The file itself", "", ""),
    ("Operating point", "Operating", "[operating]"),
    ("March", "March", "[march]"),
    ("Gears", "Gear", "[gears.NAME]"),
    ("Centre by distance and angle", "Polar", "centre = { … }"),
    ("Support of a pin", "PinSupport", "support = { … }"),
    ("Meshes", "Mesh", '[meshes."DRIVER-DRIVEN"]'),
    ("Law of a mesh", "Law", "law = { … }"),
    ("Table of a mesh", "Table", "table = { … }"),
    ("Shafts", "Shaft", '[shafts."FIRST-SECOND"]'),
    ("Splines", "Spline", "[splines.GEAR]"),
    ("Limit rings", "Ring", "[rings.GEAR]"),
    ("Float range, up and down", "Range", "float = { up = …, down = … }"),
    ("Float range from backlashes", "Backlashes", "float = { upward = …, downward = … }"),
    ("Bearings with clearance", "Bearing", "[bearings.GEAR]"),
    ("Balls or rollers of a bearing", "RollingElements", "rolling = { … }"),
    ("Errors", "Errors", "[errors.GEAR]"),
    ("Installation error by size and direction", "Offset", "installation = { … }"),
    ("Eccentricity", "Eccentricity", "eccentricity = { … }"),
    ("Position error of a pin", "Pin", "pin = { … }"),
    ("Stages", "Stage", "[stages.NAME]"),
    ("Measurements", "Measurement", "[measured.NAME]"),
    ("Studies", "Study", "[study.NAME]"),
    ("Scatter of an input", "Spread", "[study.NAME.inputs.KEY]"),
    ("Correlated inputs", "Group", "groups = [{ … }]"),
)


LIMITS = "<!-- limits -->"
ALLOWED = (
    ("size of a file", "{bytes} bytes; a regular file, no pipe and no device"),
    ("size of a gear unit or workbook to import", "{other_bytes} bytes"),
    ("size of a file of results", "{result_bytes} bytes"),
    ("files that extend one another", "{files}"),
    ("tables and lists within one another", "{depth}"),
    ("elements of a section", "{elements}"),
    ("entries of a table, and of a list of keys", "{entries}"),
    ("cells of a sheet of a workbook", "{cells}"),
    ("problems that are reported", "{problems}"),
    ("a name", "1 to {name} printable characters, no space at either end"),
    ("a length", "{length:g} m"),
    ("any other number with its unit", "0, or {smallest:g} to {largest:g} in SI units"),
    ("a coefficient of friction", "0 to {friction:g}"),
    ("a unit", "{unit} characters, exponents of up to {power:g}"),
    ("teeth of a gear", "{teeth}"),
    ("positions of a mesh cycle", "{positions}"),
    ("steps of a march", "{steps}"),
    ("points of a sweep", "{points}"),
    ("revolutions of a march", "{revolutions:g}"),
    ("positions of a common period", "{common}"),
    ("samples of a study", "{samples}"),
)
"""What a case file may hold, in words; the numbers are those of the settings."""


def on_page_markdown(markdown: str, page: Any = None, **_: Any) -> str:
    """Fill in what a page takes from the code."""
    place = Path(page.file.src_uri) if page is not None else Path()
    if place.parent.name == "gallery" and place.stem != "index":
        markdown += f"\n[Download this page as a notebook]({place.stem}.ipynb)\n"
    if CASE_REFERENCE in markdown:
        from loadshare.case.schema import case_schema

        markdown = markdown.replace(CASE_REFERENCE, case_reference(case_schema()))
    if LIMITS in markdown:
        from loadshare.settings import ALLOWED as NUMBERS

        rows = [f"| {what} | {most.format_map(NUMBERS._asdict())} |" for what, most in ALLOWED]
        markdown = markdown.replace(LIMITS, "\n".join(["| what | at most |", "|---|---|", *rows]))
    if COMMANDS in markdown:
        markdown = markdown.replace(COMMANDS, command_reference())
    return markdown


def on_files(files: Any, config: Any, **_: Any) -> Any:
    """Add the pages of the gallery as notebooks."""
    from mkdocs.structure.files import File

    for page in sorted((Path(config.docs_dir) / "gallery").glob("*.md")):
        if page.stem != "index":
            text = notebook(page.read_text(encoding="utf-8"))
            files.append(File.generated(config, f"gallery/{page.stem}.ipynb", content=text))
    return files


def notebook(page: str) -> str:
    """Return a page of the gallery as a notebook that has not been run.

    Python blocks are its cells; what they print, and the pictures they show, it makes itself.
    """
    parts = re.split(r"^```python\n(.*?)^```\n", page, flags=re.MULTILINE | re.DOTALL)
    cells = []
    for number, part in enumerate(parts):
        code = number % 2 == 1
        if number and not code:
            part = re.sub(r"\A\s*```text\n.*?^```\n", "", part, flags=re.MULTILINE | re.DOTALL)
            part = re.sub(r"\A\s*!\[[^\]]*\]\([^)]*\)\n", "", part)
        if text := part.strip():
            cell: dict[str, Any] = {"cell_type": "code" if code else "markdown", "metadata": {}}
            cell |= {"id": f"cell-{number}", "source": text.splitlines(keepends=True)}
            cells.append(cell | ({"execution_count": None, "outputs": []} if code else {}))
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def on_page_content(content: str, **_: Any) -> str:
    """Turn formulas into MathML, reStructuredText of docstrings into code, pictures into links.

    A picture is drawn as wide as the page; the link shows it in full size.
    """
    content = re.sub(
        r'(?<=<p>)(<img [^>]*src="([^"]+\.svg|[^"/]+\.png)"[^>]*>)(?=</p>)',
        r'<a class="picture" href="\2">\1</a>',
        content,
    )
    content = re.sub(
        r'<span class="arithmatex">\\\((.*?)\\\)</span>', lambda m: _mathml(m[1], False), content
    )
    content = re.sub(
        r'<div class="arithmatex">\s*\\\[(.*?)\\\]\s*</div>',
        lambda m: _mathml(m[1], True),
        content,
        flags=re.DOTALL,
    )
    content = re.sub(r":math:<code>(.*?)</code>", lambda m: _mathml(m[1], False), content)
    return re.sub(
        r":(?:class|func|meth|mod|attr):<code>~?(?:[\w.]*\.)?(\w+)</code>",
        r"<code>\1</code>",
        content,
    )


def _mathml(formula: str, block: bool) -> str:
    from latex2mathml.converter import convert

    shown = convert(html.unescape(formula).strip(), display="block" if block else "inline")
    # Browsers set bars with the space of an operator, and no space after a function's name.
    shown = re.sub(
        r'<mo(?: stretchy="false")?>&#x0007C;</mo>',
        '<mo stretchy="false" lspace="0" rspace="0">&#x0007C;</mo>',
        shown,
    )
    return re.sub(r"<mi>(cos|sin)</mi>", r'<mi>\1</mi><mspace width="0.15em" />', shown)


# --- The case reference --------------------------------------------------------------------------


def case_reference(schema: Schema) -> str:
    """Return the case reference as Markdown: one table for each table of a case file.

    Parameters
    ----------
    schema : mapping
        The JSON Schema of a case file.

    Raises
    ------
    KeyError
        If the schema has a definition that is not in `TABLES`: the reference would miss it.
    """
    definitions = dict(schema["$defs"])
    parts = ["## Physical values\n", _kind_table(), ""]
    for heading, name, place in TABLES:
        table = definitions.pop(name) if name else schema
        whole = table.get("$defs", {}).get("whole", table) if name else schema["then"]
        required = whole.get("required", ())
        parts.append(f"## {heading}\n")
        if place:
            parts.append(f"`{place}`\n")
        parts.append(f"{table['description']}\n")
        parts.append("| key | what it takes | default | description |\n|---|---|---|---|")
        for key, field in table["properties"].items():
            parts.append(_row(key, field, key in required, schema))
        parts.append("")
    if definitions:
        raise KeyError(f"docs/hooks.py does not place {', '.join(definitions)}")
    return "\n".join(parts)


def _row(key: str, field: Schema, required: bool, schema: Schema) -> str:
    takes = "; or ".join(dict.fromkeys(_takes(field, schema)))
    default = "**required**" if required else _default(field)
    description = " ".join(str(field.get("description", "")).split())
    cells = (f"`{key}`", takes, default, description)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _takes(field: Schema, schema: Schema) -> Iterator[str]:
    """Yield each form that a value may have, in words."""
    options = field.get("oneOf") or field.get("anyOf")
    if options:
        for option in options:
            yield from _takes(option, schema)
    elif "$ref" in field:
        yield f"table [{_anchor_text(field['$ref'])}](#{_anchor(field['$ref'])})"
    elif "enum" in field:
        yield ", ".join(f'`"{word}"`' for word in field["enum"])
    elif "const" in field:
        yield f'`"{field["const"]}"`'
    elif field.get("type") == "array":
        yield _list(field, schema)
    elif field.get("type") == "object":
        inner = field["additionalProperties"]
        if "$ref" in inner:
            yield f"tables by name, see [{_anchor_text(inner['$ref'])}](#{_anchor(inner['$ref'])})"
        else:
            yield f"table of {' or '.join(_takes(inner, schema))} by name"
    elif "pattern" in field:
        yield _physical(field)
    else:
        yield _plain(field)


def _list(field: Schema, schema: Schema) -> str:
    items = field.get("items") or field["prefixItems"][0]
    of = " or ".join(dict.fromkeys(_takes(items, schema)))
    low, high = field.get("minItems"), field.get("maxItems")
    if low is not None and low == high:
        return f"list of {low}: {of}"
    if low is not None and high is not None:
        return f"list of {low} to {high}: {of}"
    return f"list: {of}"


def _physical(field: Schema) -> str:
    """Say which kind of physical value is meant; its example, which no other kind shares, tells."""
    *words, example = field["examples"]
    return " or ".join((*(f'`"{word}"`' for word in words), _kinds()[example].name))


def _kinds() -> dict[str, Kind]:
    from loadshare.case import quantity

    dimensions = [d for d in vars(quantity).values() if isinstance(d, quantity.Dimension)]
    return {d.example: Kind(d.kind.partition(" ")[2], d.unit) for d in dimensions}


def _kind_table() -> str:
    rows = [f'| {kind.name} | `"{example}"` | {kind.unit} |' for example, kind in _kinds().items()]
    return "\n".join(("| kind | as in | kept in |\n|---|---|---|", *rows))


def _plain(field: Schema) -> str:
    if field["type"] == "boolean":
        return "`true` or `false`"
    name = {"string": "text", "integer": "whole number", "number": "number"}[field["type"]]
    limits = {
        "minimum": "at least",
        "exclusiveMinimum": "above",
        "maximum": "at most",
        "exclusiveMaximum": "below",
    }
    bounds = [f"{word} {field[key]:g}" for key, word in limits.items() if key in field]
    return " ".join((name, *bounds))


def _default(field: Schema) -> str:
    if "default" not in field:
        return "–"
    default = field["default"]
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    if default in ("", [], {}):
        return "none"
    if isinstance(default, list | tuple):
        return f"`[{', '.join(map(str, default))}]`"
    return f"`{default}`"


def _definition(reference: str) -> str:
    return reference.rpartition("/")[2]


def _anchor_text(reference: str) -> str:
    return next(heading for heading, name, _ in TABLES if name == _definition(reference))


def _anchor(reference: str) -> str:
    heading = _anchor_text(reference).lower()
    return re.sub(r"[^\w]+", "-", heading).strip("-")


# --- The command line ----------------------------------------------------------------------------


def command_reference() -> str:
    """Return all commands with their arguments and options as Markdown."""
    from typer.main import get_command

    from loadshare.cli.main import app

    group = get_command(app)
    parts = []
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        if command.hidden:
            continue
        parts.append(f"## {name}\n\n{_help(command.help)}\n")
        arguments = [p for p in command.params if p.param_type_name == "argument" and not p.hidden]
        options = [p for p in command.params if p.param_type_name == "option" and not p.hidden]
        usage = " ".join(_argument(p) for p in arguments)
        parts.append(f"```text\nloadshare {name} [OPTIONS] {usage}".rstrip() + "\n```\n")
        if arguments:
            parts.append("| argument | description |\n|---|---|")
            parts += [f"| `{_argument(p)}` | {_help(p.help)} |" for p in arguments]
            parts.append("")
        if options:
            parts.append("| option | takes | default | description |\n|---|---|---|---|")
            parts += [_option(p) for p in options]
            parts.append("")
    return "\n".join(parts)


def _argument(parameter: Any) -> str:
    name = parameter.metavar or parameter.name.upper()
    return name if parameter.required else f"[{name}]"


def _option(parameter: Any) -> str:
    names = ", ".join(f"`{flag}`" for flag in (*parameter.opts, *parameter.secondary_opts))
    # Every option that takes a value says what; a switch says nothing.
    takes = f"`{parameter.metavar}`" if parameter.metavar else "–"
    default = parameter.default
    blank = not parameter.metavar or default in (None, (), []) or callable(default)
    shown = "**required**" if parameter.required else "–" if blank else f"`{default}`"
    return f"| {names} | {takes} | {shown} | {_help(parameter.help)} |"


def _help(text: str | None) -> str:
    return " ".join((text or "").split()).replace("|", "\\|")
