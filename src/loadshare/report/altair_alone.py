"""Altair for users whom the system knows by number only, and the Vega-Lite that it writes."""

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


def vega_lite_version() -> str:
    """Version of Vega-Lite, such as "6.4", in which Altair writes its charts."""
    import altair as alt

    return ".".join(str(alt.SCHEMA_VERSION).removeprefix("v").split(".")[:2])
