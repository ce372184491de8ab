"""`loadshare` and `python -m loadshare`: the command line."""

from __future__ import annotations

import gc
import signal
import sys

KEPT = 200_000
"""Objects allocated before the garbage collector searches for cycles: more than a short command
makes. What a command imports and reads stays to its end; searching it takes a tenth of the time."""

STOPPED = (130, 143)
"""Exit codes for interrupted and terminated, as in `loadshare.cli.exits`, not imported here."""


def main() -> None:
    """Run the command line.

    Raises
    ------
    SystemExit
        Always; see `loadshare.cli.main.main`. An interrupt before the command line is loaded ends
        the process without a message.
    """
    gc.set_threshold(KEPT)
    try:
        from loadshare.cli.main import main as run

        run()
    except KeyboardInterrupt:
        sys.exit(130)
    except SystemExit as end:
        if end.code in STOPPED:
            # Python restores the system's signal handlers just before it ends; a second Ctrl-C
            # would then kill it without its exit code.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
        raise


if __name__ == "__main__":
    main()
