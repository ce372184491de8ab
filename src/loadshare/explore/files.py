"""Settings as case files that extend the original case."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit

from loadshare.case.reader import load_case
from loadshare.case.writer import toml_text
from loadshare.errors import CaseError
from loadshare.explore.inputs import PageInputs
from loadshare.job.positions import prepared
from loadshare.tooth import written_in


def case_file(inputs: PageInputs, given: Mapping[str, object], file: Path | None) -> dict[str, str]:
    """Return a setting as the text of a case file, its name, and a note on where it belongs.

    Parameters
    ----------
    inputs : PageInputs
        Inputs of the case, with the changes that the command line has made to the file.
    given : mapping of str to object
        Inputs that a page has changed.
    file : Path or None
        File of the case; without one, the text extends none.

    Raises
    ------
    CaseError
        If the setting is not a valid case.
    """
    changed = inputs.case.replace(inputs.changes(given))
    # Some faults of a case are found only when its train is built.
    prepared(changed)
    name = f"{inputs.case.name or 'case'}_explored.toml"
    if file is None:
        return {"name": name, "text": written_in(changed).to_toml(), "note": ""}
    try:
        apart, why = _apart(load_case(file).to_dict(), changed.to_dict()), "keys were removed"
    except CaseError:
        apart, why = None, "that cannot be read any more"
    if apart is None:
        note = f"It does not extend the original file, as {why}."
        return {"name": name, "text": written_in(changed).to_toml(), "note": note}
    head = tomlkit.document()
    head.add("extends", tomlkit.item(file.name))
    text = f"{tomlkit.dumps(head).rstrip()}\n\n{toml_text(apart)}"
    return {"name": name, "text": text, "note": f"Put it beside {file.name}, which it extends."}


def _apart(base: Mapping[str, Any], changed: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return what tables add to or change in those they extend; None if keys are gone."""
    if set(base) - set(changed):
        return None
    found: dict[str, Any] = {}
    for key, value in changed.items():
        known = base.get(key)
        if known == value and key in base:
            continue
        if isinstance(known, Mapping) and isinstance(value, Mapping):
            inner = _apart(known, value)
            if inner is None:
                return None
            found[key] = inner
        else:
            found[key] = value
    return found
