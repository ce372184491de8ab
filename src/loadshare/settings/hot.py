"""The fast method: Newton's passes on a set, the way from set to set, the proximal search."""

from __future__ import annotations

from typing import NamedTuple


class HotPath(NamedTuple):
    """Newton's passes on one set of acting elements, and the signs that decide on the next set."""

    passes: int = 60
    """Passes on one set; samples that settle mostly do so in ten."""
    swing: int = 15
    """Passes in a cycle, the last of which are damped: a sample that swings between two tangents
    settles half way."""
    damped: int = 5
    """The last passes of such a cycle, which go half the way."""
    settled: float = 1e-14
    """Change of forces and coordinates between passes, over the largest: a few roundings."""
    stalled: float = 1e-11
    """The same where passes no longer improve: round-off of an ill-conditioned set, still a
    hundredth of the certified tolerance."""
    law: float = 1e-13
    """Misfit of a law, over the largest compression, that ends the passes."""
    creep: float = 1e-8
    """Change from pass to pass below which an unsettled sample is left to the certificate."""
    proximal: float = 1e-8
    """Term, over the largest entry, that makes a singular matrix definite: half the digits."""
    refinements: int = 4
    """Refinements of a solution with that term; each gains eight digits."""
    refined: float = 1e-9
    """Residual, over the largest redundant, above which a matrix counts as singular."""
    shared: float = 1e-9
    """Part of a redundant in the elements that yield below which only rigid ones take part."""
    noise: float = 1e-13
    """Distance between rigid elements, over the largest length, that is round-off."""
    sign: float = 1e-12
    """Violation of a sign, over the largest quantity of its kind, that counts as round-off."""
    gross: float = 1e-3
    """Violation that no later pass corrects, so that it is acted on at once."""
    nearly: float = 1e-2
    """Relative misfit of the laws below which signs are checked before passes settle."""
    floor: float = 1e-6
    """Smallest cube root of a force at which a tangent is taken, over the load's: 1e-18 of it."""
    shrink: float = 0.46
    """Factor on the cube root of the force of a flank that is not compressed: a tenth of the force
    per pass."""
    patience: int = 6
    """Passes after which a flank that stays uncompressed counts as open."""
    inward: int = 20
    """Passes after which a rigid stop that goes on holding inward counts as open; directions of
    stops that act settle in fifteen."""
    outside: int = 2
    """Passes after which a radial element that stays beyond its level piece has left it."""
    beyond: float = 1.01
    """Radius over S2 above which it is beyond."""
    burst: float = 1e6
    """Force over the load above which rigid contacts contradict one another."""
    softest: float = 1e8
    """Largest compliance of a radial element across its offset."""
    far: float = 1e3
    """Distance from the end of the proximal passes, over how far they went, that only a drift
    explains."""
    rolls: int = 4
    """Passes that renew the faces of arcs along a loose move: these turn by thousandths at most."""
    faint: float = 1e-12
    """Least friction bound, over the load, with which a slipping element is held across its
    slip."""
    drift: float = 1e-12
    """Share of the load along a loose move above which it counts."""
    of_way: float = 1e-3
    """Least length for comparisons, over the largest displacement."""
    rounded: float = 1e-9
    """Relative excess of a friction bound over the first rise that counts as a jump."""
    least_share: float = 1e-6
    """Least share of the load at which a law begins, from another sample's forces."""


class SideBySide(NamedTuple):
    """Samples of a set side by side; those that are out of the ordinary are left undecided."""

    widest: int = 256
    """Most samples at a time."""
    rounds: int = 4
    """Rounds in which samples begin again together with others that take as long."""
    few: float = 0.125
    """Share of the samples that is not waited for, except in the last round."""
    fewest: int = 4
    """Samples up to which the width is not padded with one of them."""
    passes: int = 30
    """Passes after which a sample is left undecided."""
    patience: int = 2
    """Patience (see `HotPath`) where all wrong signs are exchanged at once."""
    turned: float = 10.0
    """Weight of the angle by which arcs still turn, in the misfit that has to settle."""
    least: float = 1e-4
    """Least share of a turn that is expected of the next pass."""
    steepest: float = 1e-2
    """Angle [rad] by which no arc turns: 1 mm over 0.1 m."""
    closed_by: float = 1e-12
    """Misfit of compatibility, over the largest compression, above which a sample is undecided."""
    doubtful: float = 1e-8
    """Pivot, over the largest, below which a sample is undecided."""
    close: float = 1e-5
    """Halley's last step on a root, relative, below which the root counts as found: the error is
    its cube."""
    yields: float = 1.0
    """Largest compliance along the direction of a slip, where its border leaves the length free."""


class Statics(NamedTuple):
    """Sets of elements that act, and the moves that they leave free."""

    opposed: float = 1e-4
    """Angle [rad] up to which two arcs of a ring count as opposed: squeezing a gear between them
    moves nothing else."""
    sets: int = 2000
    """Sets of which the statics are kept; with more, all are forgotten, so that memory is
    bounded."""
    trains: int = 4
    """Trains of which the elements are kept, for callers that solve position after position."""
    rank: float = 1e-10
    """Singular values of directions below this, relative to the largest, count as zero."""
    nothing: float = 1e-14
    """Force of an element in the redundants, over the largest of these, that is round-off."""
    many: int = 8
    """Redundants in one element above which they are coupled in a chain instead: fewer take no
    longer as they are."""
    samples: int = 256
    """Samples from which SciPy is loaded, for products with sparse matrices."""
    dense: int = 8192
    """Entries of a matrix up to which its product takes no longer if zeros take part."""
    uneven: float = 1.0
    """Logarithm of the ratio of forces of such redundants up to which they are chained: almost
    nothing is lost in the differences."""


class Exchange(NamedTuple):
    """From set to set of elements that act."""

    together: int = 6
    """Exchanges of all wrong signs at once; after these, one at a time."""
    returns: int = 3
    """Visits of one set that show that a sample goes around in a cycle."""
    nothing: float = 1e-9
    """Force, over the largest, that counts as zero where a sample alternates between a set with the
    contact and one without it: a certificate lets it pass."""
    turns: int = 24
    """Turns allowed in all: of samples that are settled by exchange, one in a thousand takes
    more."""
    renewals: int = 40
    """Passes that add tangents of round limits; each leaves about a quarter of the overlap."""
    fits: float = 1e-12
    """Overlap that counts as zero, over the largest room or move."""


class Rule(NamedTuple):
    """A linear rule that predicts the set on which a sample will end."""

    taught: int = 640
    """Most samples from which it is learnt: with these it predicts five sets in six of the seed's
    limit rings, with half of them four in five."""
    fewest: int = 80
    """Fewest samples from which it is learnt."""
    worth: int = 8
    """Least ratio of all samples to those from which it is learnt, for it to be worth while."""
    sets: int = 16
    """Sets that it may predict, those met most often."""
    ridge: float = 1e-2
    """Weight on the rule's own size, for numbers that hardly vary independently."""
    dense: float = 0.3
    """Share of a table's columns in use above which it is multiplied whole, which takes less time
    than picking them."""
    follows: float = 1e-6
    """Part of a number that is independent of the others, over the largest, below which it follows
    from these: so do laws that vary with the position alone."""


class Search(NamedTuple):
    """The proximal search where exchange gets nowhere."""

    stiffer: tuple[float, ...] = (1e-2, 1e-3, 1e-4, 1e-5, *[1e-6] * 3, *[1e-7] * 3, *[1e-8] * 6)
    """Stiffness ε that every pass adds, in units of the elements: a pass moves a coordinate by
    load/ε at most."""
    softer: float = 1e-11
    """Compliance ε that every pass adds: each pass brings forces nearer by ε over the compliance
    that they meet. It is small from the first pass on, so that rigid arcs hold a gear on its side
    of a narrow wedge."""
    shared: float = 1e3
    """Least compliance of a radial element over that of a contact, so that what both could hold is
    held by the contact: friction is bounded, a contact is not."""
    resolved: float = 1e3
    """Least compression of a contact by the added compliance, over the round-off of the largest
    length."""
    newton: int = 60
    """Newton steps of a pass."""
    rolls: float = 0.1
    """How much deeper a straight step may press a round wall, over how deep it is pressed."""
    slope: float = 0.1
    """Part of the slope at its beginning to which a line search brings a step."""
    secants: int = 6
    """Steps of a line search between two kinks."""
    looks: int = 1000
    """Points that a search evaluates in all: more than ever led to an answer, and half a second."""
    patience: int = 12
    """Newton steps in a row that do not halve the gradient, after which round-off prevents
    progress."""
    flat: float = 1e-11
    """Gradient, over the largest force, at which a pass has converged."""
    still: float = 1e-15
    """Step, over the largest coordinate, that is round-off."""
    gain: float = 1e-18
    """Energy that a step may gain, over the work of all forces, that is round-off."""
    tries: int = 3
    """Passes from which one set is solved exactly: a later one may be nearer to the answer."""
    idle: float = 1e-6
    """Force, over the largest, up to which a contact may be idle: a pass adds some of its own."""
    exchanges: int = 7
    """Sets that an exact solve visits after a pass: enough to recognise alternation."""
    halvings: int = 48
    """Halvings of the way between two kinks that are evaluated together: a slope may rise by orders
    of magnitude."""


HOT = HotPath()
SIDE_BY_SIDE = SideBySide()
STATICS = Statics()
EXCHANGE = Exchange()
RULE = Rule()
SEARCH = Search()
