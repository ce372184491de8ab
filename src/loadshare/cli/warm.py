"""`loadshare warm`: compile ahead of time."""

from __future__ import annotations

from loadshare.cli.console import say
from loadshare.cli.exits import UNUSABLE, fail
from loadshare.cli.waiting import erase_line


def warm() -> None:
    """Compile the code for many samples ahead of time, once per version: for container images.

    Without this, small jobs use NumPy, and the first large one compiles. The code for teeth is not
    part of it: the first ltca compiles that, in half a minute.
    """
    from loadshare.job.warm import warm as compiled

    # The compiler's own messages follow.
    erase_line()
    why = compiled()
    if why is not None:
        fail([f"Nothing is kept: {why}"], UNUSABLE)
    say("The compiled code is on disk.")
