"""What a page asks workers, read and bounded."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from loadshare.explore.answer import setting_of
from loadshare.explore.asked import Unasked, number, setting, text
from loadshare.explore.inputs import Inputs
from loadshare.explore.studies import Asked, Piece
from loadshare.settings import ALLOWED, EXPLORE, JOB


def question_of(inputs: Inputs, body: Mapping[str, Any]) -> Asked:
    """Return a question about a setting: of one input over a range, or of several at the setting.

    Raises
    ------
    Unasked
        If it is none.
    CaseError
        If a key or the setting cannot be used.
    """
    name = text(body, "name")
    keys = inputs.keys(name)
    low, high = (_finite(body, end) for end in ("low", "high"))
    # An error that the case lacks must be there for its parts to be varied.
    given = {key: inputs.every[key].text for key in keys} | setting(body)
    wanted = body.get("keys")
    if wanted is not None:
        if not isinstance(wanted, list) or not 0 < len(wanted) <= EXPLORE.keys:
            raise Unasked(400, f"keys is no list of 1 to {EXPLORE.keys} inputs")
        chosen = [str(key) for key in wanted if str(key) in inputs.every]
        given = {key: inputs.every[key].text for key in chosen} | setting(body)
        reaches = tuple(0.1 * (inputs.every[k].high - inputs.every[k].low) for k in chosen)
        keys = tuple(chosen)
    else:
        reaches = ()
    return Asked(
        setting_of(inputs, given),
        keys,
        low,
        high,
        inputs.every[keys[0]].unit,
        number(body, "points", EXPLORE.points, 2, EXPLORE.most_points),
        number(body, "position", 1, 1, ALLOWED.positions),
        reaches,
    )


def piece_of(inputs: Inputs, body: Mapping[str, Any]) -> Piece:
    """Return a piece of a tolerance study in which inputs scatter evenly within ranges.

    Raises
    ------
    Unasked
        If it is none.
    CaseError
        If a key or the setting cannot be used.
    """
    ranges = body.get("ranges")
    if not isinstance(ranges, dict) or not ranges:
        raise Unasked(400, "ranges is no object of [low, high] by input")
    spreads: dict[str, Any] = {}
    given: dict[str, object] = {}
    for name, ends in ranges.items():
        keys = inputs.keys(name)
        if not isinstance(ends, list) or len(ends) != 2:
            raise Unasked(400, f"the range of {name} is no [low, high]")
        unit = inputs.every[keys[0]].unit
        low, high = (_finite({"end": end}, "end") for end in ends)
        ends = [f"{end!r} {unit}" if unit else end for end in (low, high)]
        spreads["=".join(keys)] = {"distribution": "uniform", "low": ends[0], "high": ends[1]}
        given |= {key: inputs.every[key].text for key in keys}
    count = number(body, "samples", 4096, 1, EXPLORE.samples)
    first = number(body, "first", 0, 0, count - 1)
    case = setting_of(inputs, given | setting(body))
    # Within one block of the study, and a second's work at most.
    room = min(JOB.block - first % JOB.block, count - first)
    piece = min(room, max(EXPLORE.piece // max(case.operating.positions, 1), 16))
    seed = number(body, "seed", 0, 0, 2**31)
    return Piece(case, json.dumps(spreads), count, seed, first, piece)


def _finite(body: Mapping[str, Any], name: str) -> float:
    given = body.get(name, 0.0)
    if isinstance(given, bool) or not isinstance(given, int | float) or not math.isfinite(given):
        raise Unasked(400, f"{name} is no number")
    return float(given)
