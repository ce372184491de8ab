"""The explorer: what a page may ask for, and how much of it at a time."""

from __future__ import annotations

from typing import NamedTuple


class Explore(NamedTuple):
    """What a page may ask for, and how much of it at a time."""

    body: int = 256 * 1024
    """Bytes of a request: some thousand changed inputs."""
    depth: int = 8
    """Lists and tables within one another in a request."""
    text: int = 200
    """Characters of a value."""
    steps: int = 1000
    """Steps of a slider, at least; two and a half times as many at most."""
    together: int = 12
    """Positions up to which every setting is solved at all of them."""
    points: int = 41
    """Points of a sweep behind a slider, whose ends and steps are then round."""
    most_points: int = 401
    """Points of a sweep that a page may ask for."""
    keys: int = 2000
    """Keys that a page may ask to differentiate by."""
    samples: int = 1_000_000
    """Samples of a tolerance study that a page may ask for; its figures are kept in memory."""
    piece: int = 8000
    """Equilibria that a worker solves before the page hears of it: a second's work at most."""
    waiting: int = 16
    """Requests that may wait for each worker; more are told to come back later."""


EXPLORE = Explore()
