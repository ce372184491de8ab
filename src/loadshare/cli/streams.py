"""Standard streams that are there for every command, also where whoever starts it closed them."""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper

from loadshare.output import Closed


def open_streams() -> None:
    """Put nothing in the place of streams that are closed, as by ``2>&-`` or by some daemons.

    Files and pipes that are opened would get their numbers, and then what libraries and workers
    print. That a file was asked for on a closed output is reported when it is written.
    """
    for number, stream in enumerate((sys.stdin, sys.stdout, sys.stderr)):
        if stream is None and not _is_open(number):
            nowhere = os.open(os.devnull, os.O_RDWR)
            if nowhere != number:
                os.dup2(nowhere, number)
                os.close(nowhere)
            os.set_inheritable(number, True)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            setattr(sys, name, Closed(os.fdopen(nowhere, "wb"), encoding="utf-8"))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            # A stream that cannot show Ω shall show a question mark and go on.
            stream.reconfigure(errors="replace")


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True
