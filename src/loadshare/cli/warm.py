"""`loadshare warm`: compile ahead of time."""

from __future__ import annotations

import typer

from loadshare.cli.exits import UNUSABLE, fail


def warm() -> None:
    """Compile what answers many samples, ahead of the first use: for images, once per version.

    Without it, small jobs are answered by NumPy, and the first large one compiles.
    """
    from loadshare.job.warm import warm as compiled

    why = compiled()
    if why is not None:
        fail([f"Nothing is kept: {why}"], UNUSABLE)
    typer.echo("The compiled kernels are on disk.")
