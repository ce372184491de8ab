"""Altair for users whom the system knows by number only."""

import os
from pathlib import Path


def import_altair() -> None:
    """Import Altair, which asks for the user's home even where there is none."""
    try:
        Path.home()
    except RuntimeError:
        os.environ["HOME"] = os.sep
        try:
            import altair  # noqa: F401
        finally:
            del os.environ["HOME"]
