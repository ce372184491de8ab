"""Places that forces leave undetermined."""

from __future__ import annotations

from typing import NamedTuple


class Places(NamedTuple):
    """Places that forces leave open, limits that contradict one another, loads that drive."""

    carries: float = 1e-11
    """Force, over the largest, above which a contact holds: far above the round-off of forces, far
    below the precision that a certificate guarantees."""
    loose: float = 1e-9
    """Part of a coordinate in a move above which it takes part: round-off of the moves is
    smaller."""
    play: float = 1e-9
    """Range, in lengths of the case, below which a place counts as determined: contacts that carry
    nothing leave only round-off between them."""
    renewals: int = 12
    """Passes that renew the faces of arcs."""
    inside: float = 1e-12
    """How far a point may lie outside, in sizes of the region: round-off of what bounds it."""
    almost: float = 1e-6
    """Distance to a bound, in sizes of the region, at which an interior-point answer reaches it."""
    few: int = 3
    """Shares of a part, at most, whose least place is found for many samples at once."""
    limits: int = 8
    """Limits of such a part, at most: every set of them that may be reached is tried."""
    far: float = 1e6
    """Distance, in sizes of the region, beyond which a place counts as unlimited."""
    passes: int = 20
    """Most Newton passes on the bounds that are reached."""
    arrived: float = 1e-14
    """Step, in sizes of the region, that ends these passes."""
    balanced: float = 1e-9
    """Part of a pull, in sizes of the region, that its bounds may leave unbalanced."""
    noise: float = 1e-12
    """Force, over the one that would press the stiffest gap shut, that counts as round-off."""
    verified: float = 1e-11
    """Violation of a removed inequality that counts as round-off, in deflections and loads."""
    work: float = 10.0
    """Work of the load along a move, over load and move and in tolerances of the certificate, above
    which the load drives the move."""
    yields: float = 1e-7
    """Part of a move, over that work, that elements may still seem to resist: forces that balance
    the load in spite of it would be ten million times as large."""
    resists: float = 1e-13
    """Stiffness of a coordinate with the others free to move, over its stiffness with them fixed,
    above which a spring resists: less is round-off."""
    overlap: float = 1e-12
    """Overlap, over the largest length, that counts as round-off."""
    named: float = 1e-6
    """Share in a contradiction, or in a move that nothing holds, above which a limit or a
    coordinate is named."""
    programmes: int = 20
    """Programmes in which tangents of round limits are added to those before."""
    pushed: float = 1e-9
    """Load along a move, over the load, above which it counts: with a smaller limit, flanks whose
    normals are opposite up to the digits of a case file would seem to give way."""
    facets: int = 64
    """Sides of the polygon that replaces friction where a load may run away: corners lie 1/800
    outside."""
    cone: float = 1e-10
    """Tolerance of the cone programme that shows which limits are reached."""


PLACES = Places()
