"""Convert a picture: conversion, specification and settings on standard input, file on output."""

from __future__ import annotations

import json
import sys


def _draw() -> None:
    from loadshare.report import converter

    conversion, what, how = json.load(sys.stdin)
    drawn = converter.begin(conversion, what, **how).result()
    sys.stdout.buffer.write(drawn.encode() if isinstance(drawn, str) else drawn)


if __name__ == "__main__":
    _draw()
