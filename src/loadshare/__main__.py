"""`loadshare` and `python -m loadshare`: the command line."""

from __future__ import annotations

import gc
import sys

KEPT = 200_000
"""Objects after which cycles among them are looked for: more than a short command makes. What it
imports and reads stays to its end, and looking through it takes a tenth of its time."""


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


if __name__ == "__main__":
    main()
