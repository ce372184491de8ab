"""The explorer: what a page may ask for, and how much of it at a time."""

from __future__ import annotations

from typing import NamedTuple


class Explore(NamedTuple):
    """What a page may ask for, and how much of it at a time."""

    body: int = 256 * 1024
    """Bytes of a request: some thousand changed inputs."""
    text: int = 200
    """Characters of a value."""
    steps: int = 1000
    """Fewest steps of a slider; two and a half times as many at most."""
    together: int = 12
    """Positions up to which every setting is solved at all of them."""
    points: int = 41
    """Points of a sweep behind a slider, whose ends and steps are then round numbers."""
    most_points: int = 401
    """Points of a sweep that a page may ask for."""
    stretches: int = 6
    """Stretches into which a slider is cut for its critical values: the nearest are known first."""
    keys: int = 2000
    """Keys that a page may ask to differentiate by."""
    batch: int = 2
    """Inputs that a worker differentiates by before it reports to the page."""
    samples: int = 1_000_000
    """Samples of a tolerance study that a page may ask for; its figures are kept in memory."""
    part: int = 1000
    """Equilibria that NumPy solves before it reports to the page: a second's work."""
    least: int = 16
    """Fewest samples in a part."""
    waiting: int = 16
    """Requests that may wait for each worker; more are told to come back later."""


EXPLORE = Explore()
