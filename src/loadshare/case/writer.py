"""A case as TOML text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.items import InlineTable, KeyType, SingleKey, Table

from loadshare.case.content import Content
from loadshare.case.keys import BARE


def toml_text(data: Mapping[str, Any]) -> str:
    """Return a case as the text of a case file.

    Parameters
    ----------
    data : mapping
        A case as plain data.

    Returns
    -------
    str
        TOML, in the order of the case reference.
    """
    document = tomlkit.document()
    for name in Content.model_fields:
        value = data.get(name)
        if not isinstance(value, Mapping):
            if value is not None:
                document.add(name, _item(value))
        elif name in ("operating", "march"):
            document.add(name, _table(value))
        elif not all(isinstance(element, Mapping) for element in value.values()):
            # Without elements it is no valid section, which is reported when the case is read.
            document.add(name, _item(value))
        elif value:
            section = tomlkit.table(is_super_table=True)
            for key, element in value.items():
                section.append(_key(key), _table(element))
            document.add(name, section)
    return tomlkit.dumps(document).rstrip() + "\n"


def _table(data: Mapping[str, Any]) -> Table:
    table = tomlkit.table()
    for key, value in data.items():
        table.append(_key(key), _item(value))
    table.add(tomlkit.nl())
    return table


def _item(value: Any) -> Any:
    if isinstance(value, Mapping):
        inline: InlineTable = tomlkit.inline_table()
        for key, item in value.items():
            inline.append(_key(key), _item(item))
        return inline
    return tomlkit.item(value)


def _key(name: str) -> SingleKey:
    return SingleKey(
        name, t=KeyType.Bare if BARE.fullmatch(name) and name.isascii() else KeyType.Basic
    )
