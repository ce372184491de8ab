"""`loadshare` and `python -m loadshare`: the command line."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line.

    Raises
    ------
    SystemExit
        Always; see `loadshare.cli.main.main`. What is interrupted before there is a command to say
        so ends in silence.
    """
    try:
        from loadshare.cli.main import main as run

        run()
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
