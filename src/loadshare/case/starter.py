"""Cases to start from."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Literal, get_args

Kind = Literal["split-path", "four-branch", "star", "planetary", "two-stage-planetary"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""Kinds of transmissions, each with a file in `starters/`."""


def starter_case(name: str, kind: Kind = "split-path") -> str:
    """Return a commented case file that runs.

    Parameters
    ----------
    name : str
        Title of the case.
    kind : {"split-path", "four-branch", "star", "planetary", "two-stage-planetary"}

    Returns
    -------
    str
        TOML; the split-path case also shows, commented out, what else a case may contain.
    """
    folder = files("loadshare.case").joinpath("starters")
    text = folder.joinpath(f"{kind}.toml").read_text(encoding="utf-8")
    return text.replace('"TITLE"', json.dumps(name, ensure_ascii=False), 1)
