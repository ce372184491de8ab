"""`loadshare` and `python -m loadshare`: the command line."""

from __future__ import annotations

import gc
import signal
import sys

KEPT = 200_000
"""Objects after which cycles among them are looked for: more than a short command makes. What it
imports and reads stays to its end, and looking through it takes a tenth of its time."""

STOPPED = (130, 143)
"""Exit codes of `loadshare.cli.exits`, which is not loaded to end: interrupted, and terminated."""


def main() -> None:
    """Run the command line.

    Raises
    ------
    SystemExit
        Always; see `loadshare.cli.main.main`. What is interrupted before there is a command to say
        so ends in silence.
    """
    gc.set_threshold(KEPT)
    try:
        from loadshare.cli.main import main as run

        run()
    except KeyboardInterrupt:
        sys.exit(130)
    except SystemExit as end:
        if end.code in STOPPED:
            # Python hands signals back to the system before its very end; whoever presses Ctrl-C
            # again would have it end by that one, without its exit code.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
        raise


if __name__ == "__main__":
    main()
