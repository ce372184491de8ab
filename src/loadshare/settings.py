"""The numbers by which programmes decide: how small counts as none, how long to go on.

One table for all rooms. Every number stands with its meaning and the reason for its size; what is
not a ratio says its unit. Compiled code is handed them as data, so that it never keeps old ones.
"""

from __future__ import annotations

from typing import NamedTuple


class Laws(NamedTuple):
    """What is given of laws."""

    written: float = 1e-6
    """Relative excess of K_w S1 over F_m that the digits of a written S1 explain: six are usual."""


class HotPath(NamedTuple):
    """Newton's passes on one set of acting elements, and the signs that decide on the next set."""

    passes: int = 60
    """Passes on one set; those that settle mostly do in ten."""
    swing: int = 15
    """After so many passes steps are damped for a while: what swings between two tangents settles
    half way."""
    damped: int = 5
    """The last passes of a swing, that go half the way."""
    settled: float = 1e-14
    """Change of forces and coordinates between passes, over the largest: a few roundings."""
    stalled: float = 1e-11
    """The same where passes no longer improve: round-off of an ill-conditioned set, still a
    hundredth of what is certified."""
    law: float = 1e-13
    """Misfit of a law, over the largest compression, that ends the passes."""
    creep: float = 1e-8
    """Change from pass to pass below which what does not settle is left to the certificate."""
    proximal: float = 1e-8
    """Term, over the largest entry, that makes a singular matrix definite: half the digits."""
    refinements: int = 4
    """Refinements of a solution with that term; each brings its eight digits."""
    refined: float = 1e-9
    """Residual, over the largest redundant, from which on a matrix counts as singular."""
    pivot: float = 1e-15
    """Pivot, over the largest, that counts as none."""
    shared: float = 1e-9
    """Part of a redundant in the elements that yield below which only rigid ones take part."""
    noise: float = 1e-13
    """Distance between rigid elements, over the lengths at hand, that is round-off."""
    sign: float = 1e-12
    """Violation of a sign, over the largest quantity of its sort, that counts as round-off."""
    hurry: float = 1e-3
    """The same that no later pass mends, so that it is acted on at once."""
    nearly: float = 1e-2
    """Misfit of the laws, relative, from which on signs are looked at before passes settle."""
    floor: float = 1e-6
    """Smallest cube root of a force at which a tangent is taken, over the load's: 1e-18 of it."""
    shrink: float = 0.46
    """Factor on the cube root of the force of a flank that is not compressed: a tenth of the force
    a pass."""
    patience: int = 6
    """Passes after which a flank that stays uncompressed is taken for open, and a rigid stop that
    holds inward."""
    outside: int = 2
    """Passes after which a radial element that stays beyond its level piece has left it."""
    beyond: float = 1.01
    """Radius over S2 from which on it is beyond."""
    burst: float = 1e6
    """Force over the load from which on rigid contacts contradict one another."""
    softest: float = 1e8
    """Largest compliance of a radial element across its offset."""
    far: float = 1e3
    """Way from where proximal passes ended, over how far they went, that only a drift explains."""
    rolls: int = 4
    """Passes that renew the faces of arcs along a loose move: these turn by thousandths at most."""
    faint: float = 1e-12
    """Friction bound, over the load, at which a slipping element is held across its slip."""
    drift: float = 1e-12
    """Share of the load along a loose move from which on it counts."""


class Lanes(NamedTuple):
    """Samples of a plain set side by side; what is out of the ordinary is left undecided."""

    rounds: int = 4
    """Times that samples begin again beside those that took as long."""
    few: float = 0.125
    """Share of the lanes that is not waited for, but in the last round."""
    passes: int = 30
    """Passes after which a sample is left undecided."""
    haste: int = 2
    """Patience (see `HotPath`) where all wrong signs are exchanged at once."""
    turned: float = 10.0
    """Weight of the angle by which arcs still turn among what has to settle."""
    least: float = 1e-4
    """Share of a turn that is expected of the next pass at least."""
    steepest: float = 1e-2
    """Angle [rad] by which no arc turns: 1 mm over 0.1 m."""
    closed_by: float = 1e-12
    """Misfit of compatibility, over the largest compression, from which on a sample is left."""
    doubtful: float = 1e-8
    """Pivot, over the largest, below which a sample is left."""
    close: float = 1e-5
    """Halley's last step on a root, relative, from which on the root counts as found: the error is
    its cube."""


LAWS = Laws()
HOT = HotPath()
LANES = Lanes()
