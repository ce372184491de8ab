"""Texts for people, without characters that control a terminal or that no page can hold."""

from __future__ import annotations

import re

CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def readable(text: str) -> str:
    """Return a text with a replacement character for each control character."""
    return CONTROL.sub("\ufffd", text)
