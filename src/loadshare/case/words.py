"""Wording of problems: near misses, lists of choices, the value given."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from difflib import SequenceMatcher, get_close_matches
from typing import Any
from unicodedata import normalize

from loadshare.case.keys import dotted
from loadshare.settings import ALLOWED

LONGEST = 72
BITS = 4 * LONGEST
"""Largest size of a whole number that is shown in decimals [bit]."""
SHOWN = 24
"""Number of choices that are listed; more would bury the message."""
DIGITS = re.compile(r"\d+")


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """Return a sentence that proposes the nearest known word, or those of which it is a part.

    Only near words are proposed: names that differ in numbers only are different names.

    Parameters
    ----------
    word : object
        What was given.
    known : iterable of str
        What could have been intended.

    Returns
    -------
    str
        ``Did you mean base_radius?``, or an empty text.
    """
    if not isinstance(word, str) or not word:
        return ""
    options = list(known)
    near = [option for option in options if option.casefold() == word.casefold()]
    if not near and len(options) > ALLOWED.options:
        return ""
    for option in () if near else options:
        if normalize("NFKC", option) == normalize("NFKC", word):
            return f"{option} looks alike, but is written in other characters: copy it."
    if not near:
        near = [o for o in get_close_matches(word, options, n=5) if _is_slip(word, o)][:1]
    near = near[:1] or [option for option in options if _is_part(word, option)][:MOST]
    if not near:
        return ""
    *others, last = near
    return f"Did you mean {', '.join(others)} or {last}?" if others else f"Did you mean {last}?"


MOST = 4
"""Largest number of words proposed together."""


def _is_slip(word: str, option: str) -> bool:
    """Return whether two words differ as by a slip: not in digits alone, by a third at most."""
    if DIGITS.sub("", word) == DIGITS.sub("", option):
        return False
    blocks = SequenceMatcher(None, word, option).get_matching_blocks()
    differing = len(word) + len(option) - 2 * sum(block.size for block in blocks)
    return differing <= max(2, max(len(word), len(option)) // 3)


def _is_part(word: str, option: str) -> bool:
    """Return whether a word consists of whole words of the other, as radius in base_radius."""
    short, long = sorted((word, option), key=len)
    return len(short) > 2 and f"_{short}_" in f"_{long}_"


def choices(known: Iterable[str]) -> str:
    """Return a list of choices, cut where it would bury the message.

    Parameters
    ----------
    known : iterable of str
        The choices, in the order to show.

    Returns
    -------
    str
        The choices, separated by commas; ends in an ellipsis where some are left out.
    """
    names = list(known)
    return ", ".join(names[:SHOWN]) + (", …" if len(names) > SHOWN else "")


def as_given(value: Any) -> str:
    """Return a value as TOML would show it, shortened to what a message can hold.

    Parameters
    ----------
    value : object
        A value of a case; None for nothing.

    Returns
    -------
    str
        The text.
    """
    text = "" if value is None else _toml(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _toml(value: Any) -> str:
    if isinstance(value, Mapping):
        pairs = (f"{dotted((str(key),))} = {_toml(item)}" for key, item in value.items())
        return f"{{ {', '.join(pairs)} }}" if value else "{}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, str | bool):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, int) and value.bit_length() > BITS:
        # Python refuses to print thousands of digits; the last of them do not matter here.
        return hex(value >> max(value.bit_length() - BITS, 0))
    return str(value)
