"""A case to start from."""

from __future__ import annotations

import json
from importlib.resources import files


def starter_case(name: str) -> str:
    """Return a commented case file that runs: a small split-path drive.

    Parameters
    ----------
    name : str
        Title of the case.

    Returns
    -------
    str
        TOML, with the blocks that the drive does not need commented out.
    """
    text = files("loadshare.case").joinpath("starter.toml").read_text(encoding="utf-8")
    return text.replace('"TITLE"', json.dumps(name, ensure_ascii=False), 1)
