"""The hot path: Newton's passes on a set, the way from set to set, the proximal search."""

from __future__ import annotations

from typing import NamedTuple


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
    shared: float = 1e-9
    """Part of a redundant in the elements that yield below which only rigid ones take part."""
    noise: float = 1e-13
    """Distance between rigid elements, over the lengths at hand, that is round-off."""
    sign: float = 1e-12
    """Violation of a sign, over the largest quantity of its sort, that counts as round-off."""
    gross: float = 1e-3
    """The same that no later pass mends, so that it is acted on at once."""
    nearly: float = 1e-2
    """Misfit of the laws, relative, from which on signs are looked at before passes settle."""
    floor: float = 1e-6
    """Smallest cube root of a force at which a tangent is taken, over the load's: 1e-18 of it."""
    shrink: float = 0.46
    """Factor on the cube root of the force of a flank that is not compressed: a tenth of the force
    a pass."""
    patience: int = 6
    """Passes after which a flank that stays uncompressed is taken for open."""
    inward: int = 20
    """Passes after which a rigid stop that goes on holding inward is taken for open; directions
    of those that act settle in fifteen."""
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
    of_way: float = 1e-3
    """Part of the largest displacement that lengths are compared with at least."""
    rounded: float = 1e-9
    """Relative excess of a friction bound over the first rise that counts as a jump."""
    least_share: float = 1e-6
    """Share of the load at which a law begins at least, from another sample's forces."""


class Abreast(NamedTuple):
    """Samples of a set side by side; what is out of the ordinary is left undecided."""

    widest: int = 256
    """How many at a time."""
    rounds: int = 4
    """Times that samples begin again together with those that took as long."""
    few: float = 0.125
    """Share of the samples that is not waited for, but in the last round."""
    fewest: int = 4
    """Samples up to which the width is not filled up with one of them."""
    passes: int = 30
    """Passes after which a sample is left undecided."""
    patience: int = 2
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
    yields: float = 1.0
    """Largest compliance along the direction of a slip, where its border leaves the length free."""


class Statics(NamedTuple):
    """Sets of elements that act, and what they leave free."""

    opposed: float = 1e-4
    """Angle [rad] up to which two arcs of a ring count as opposed: what squeezes a gear between
    them moves nothing else."""
    sets: int = 2000
    """Sets of which the statics are kept; with more, all are forgotten, so that memory is
    bounded."""
    trains: int = 4
    """Trains of which the elements are kept, for those who ask for one position after another."""
    rank: float = 1e-10
    """Singular values of directions below this, relative to the largest, count as zero."""
    nothing: float = 1e-14
    """Force of an element, over that of the one which names a redundant, that is round-off."""
    many: int = 8
    """Redundants in one element from which on they are coupled in a chain instead: fewer take no
    longer as they are."""
    samples: int = 256
    """From which on SciPy is loaded, for products with matrices that are all but empty."""
    dense: int = 8192
    """Entries of a matrix up to which its product takes no longer if the empty ones take part."""
    uneven: float = 1.0
    """Logarithm of the ratio of their forces there up to which that is done: next to nothing is
    lost in the differences."""


class Exchange(NamedTuple):
    """From set to set of elements that act."""

    together: int = 6
    """Exchanges of all wrong signs at once; after these, one at a time."""
    returns: int = 3
    """Visits of one set that show a sample to go around."""
    nothing: float = 1e-9
    """Force, over the largest, that is none where a sample goes to and fro between a set that has
    the contact and one that has it not: what a certificate lets pass."""
    turns: int = 24
    """Turns allowed in all: of samples that are settled by exchange, one in a thousand takes
    more."""
    renewals: int = 40
    """Passes that add tangents of round limits; each leaves about a quarter of what is left."""
    fits: float = 1e-12
    """Overlap that counts as none, over the largest room or move."""


class Rule(NamedTuple):
    """A linear rule that names the set on which a sample will end."""

    taught: int = 640
    """Samples from which it is learnt at most: with as many it names five sets in six of the seed's
    limit rings, with half of them four in five."""
    fewest: int = 80
    """Samples from which it is learnt at least."""
    worth: int = 8
    """How many times as many samples it takes for that to be worth while."""
    sets: int = 16
    """Sets that it may name, those met most often."""
    ridge: float = 1e-2
    """Weight on the rule's own size, for numbers that hardly vary by themselves."""
    dense: float = 0.3
    """Share of a table's columns in use from which on it is multiplied whole, which takes less time
    than to pick them."""
    follows: float = 1e-6
    """What is left of a number without the others, over the largest, below which it follows from
    these: so do laws that vary with the position alone."""


class Search(NamedTuple):
    """The proximal search where exchange gets nowhere."""

    stiffer: tuple[float, ...] = (1e-2, 1e-3, 1e-4, 1e-5, *[1e-6] * 3, *[1e-7] * 3, *[1e-8] * 6)
    """Stiffness that every pass adds, in units of the elements: what one moves is load/ε at
    most."""
    softer: float = 1e-11
    """Compliance that every pass adds: each brings forces nearer by ε over the compliance they
    meet. Small from the first pass on, so that rigid arcs hold a gear on its side of a narrow
    wedge."""
    shared: float = 1e3
    """How much softer a radial element is made than a contact at least, so that what both could
    hold is held by the contact: friction is bounded, a contact is not."""
    resolved: float = 1e3
    """Round-offs of the lengths at hand by which the compliance presses a contact in at least."""
    newton: int = 60
    """Newton steps of a pass."""
    rolls: float = 0.1
    """How much deeper a straight step may press a round wall, over how deep it is pressed."""
    slope: float = 0.1
    """Part of the slope at its beginning to which a line search brings a step."""
    secants: int = 6
    """Steps of a line search between two kinks."""
    looks: int = 1000
    """Points at which a search looks in all: more than ever led to an answer, and half a second."""
    patience: int = 12
    """Newton steps in a row that do not halve the gradient, after which round-off stands in the
    way."""
    flat: float = 1e-11
    """Gradient, over the largest force, at which a pass has arrived."""
    still: float = 1e-15
    """Step, over the largest coordinate, that is round-off."""
    gain: float = 1e-18
    """Energy that a step may gain, over the work of all forces, that is round-off."""
    tries: int = 3
    """Passes from which a set is solved exactly: a later one may stand nearer."""
    idle: float = 1e-6
    """Force, over the largest, up to which a contact may be idle: a pass adds some of its own."""
    exchanges: int = 7
    """Sets that an exact solve visits from where the passes stand: enough to tell to and fro."""
    halvings: int = 48
    """Halvings of the way between two kinks that are looked at together: a slope may rise by
    orders."""


HOT = HotPath()
ABREAST = Abreast()
STATICS = Statics()
EXCHANGE = Exchange()
RULE = Rule()
SEARCH = Search()
