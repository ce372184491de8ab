"""Slips in TOML, and what to write instead: what its parser says helps few engineers."""

from __future__ import annotations

import re
import tomllib

LONGEST = 200
"""Most letters of a line that is looked at."""
_BARE = r"[A-Za-z0-9_-]+"
_HEAD = re.compile(r"\[+([^\]\"'#]+)\]")
_VALUE = re.compile(r"[A-Za-z0-9_\-.\"' ]+=\s*([\w.+−-][^\"'#]*?)\s*(?:#.*)?")
_COLON = re.compile(rf"({_BARE})\s*:\s*([^#]*?)\s*(?:#.*)?")
_COMMA = re.compile(r"[-+]?\d+,\d+")
_POINT = re.compile(r"([-+]?)(\d*)\.(\d*)")
_WITH_UNIT = re.compile(r"(?<![\w\"'.])[-+]?\d[\d.]*(?:[eE][-+]?\d+)?\s*[^\W\d_][^\"'\],}#]*")
_CURLED = re.compile("[“”„‟‘’‚«»]")


def slip_in(line: str) -> str:
    """Return what to write instead of a line that is not TOML; empty if that is not obvious.

    Parameters
    ----------
    line : str
    """
    line = line.strip()
    if len(line) > LONGEST:
        return ""
    if _CURLED.search(line):
        return 'Quotes are straight: "100 N*m".'
    if line.startswith(("//", ";", "%", "/*")):
        return "A comment begins with #."
    if head := _HEAD.match(line):
        return _slip_in_head(line, head)
    if colon := _COLON.fullmatch(line):
        return f"Write {colon[1]} = {colon[2]}."
    if line.count('"') % 2:
        return 'A text begins and ends with " on one line.'
    value = _VALUE.fullmatch(line)
    if value is not None:
        return _slip_in_value(value[1])
    if "[" in line and (bare := _WITH_UNIT.search(line.partition("=")[2])):
        return _in_quotes(bare[0].strip())
    return ""


def _slip_in_head(line: str, head: re.Match[str]) -> str:
    names = [name.strip() for name in head[1].split(".")]
    if not all(re.fullmatch(_BARE, name) for name in names):
        quoted = ".".join(n if re.fullmatch(_BARE, n) else f'"{n}"' for n in names)
        return f"Put a name of more than letters, digits, _ and - in quotes: [{quoted}]."
    return "Begin a new line after the head of a table." if line[head.end() :] else ""


def _slip_in_value(value: str) -> str:
    if value.endswith((";", ",")):
        return f"Nothing follows a value: drop the {value[-1]} there."
    try:
        tomllib.loads(f"value = {value}")
    except ValueError:
        pass
    else:
        return ""  # the slip is elsewhere
    if value.isdecimal():
        return f"Write {int(value)}."
    if _COMMA.fullmatch(value):
        return f"Use a decimal point: {value.replace(',', '.')}."
    if point := _POINT.fullmatch(value):
        return f"Write {point[1]}{point[2] or 0}.{point[3] or 0}."
    if value.lower() in ("true", "false", "yes", "no"):
        return "Write true or false."
    return _in_quotes(value)


def _in_quotes(value: str) -> str:
    return f'Put texts, and values with their unit, in quotes: "{value}".'
