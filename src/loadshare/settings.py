"""The numbers by which solvers, studies and certificates decide: what is small, when to stop.

One table for all rooms. Every number stands with its meaning and, where it is known, the reason for
its size; what is not a ratio says its unit. What is compiled with them is compiled anew when one
changes (`kept_code.py`).
"""

from __future__ import annotations

import sys
from typing import NamedTuple

EPS = sys.float_info.epsilon
"""Distance from 1 to the next double: two roundings."""


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


class Abreast(NamedTuple):
    """Samples of a set side by side; what is out of the ordinary is left undecided."""

    widths: tuple[int, ...] = (8, 16, 32, 64)
    """How many at a time: the first number that is enough, or the last."""
    rounds: int = 4
    """Times that samples begin again beside those that took as long."""
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


class Certify(NamedTuple):
    """Verdicts on answers."""

    tolerance: float = 1e-9
    """Largest scaled residual of a certified answer."""
    band: float = 1e-9
    """Band in which a margin counts as none, in deflections of the case."""
    largest: float = 1e-3
    """Largest tolerance: an answer that misses by more than a thousandth is not certified, it is
    guessed, and Ω is read to three digits behind the point."""
    rounded: float = 16.0 * EPS
    """Rounding of energies, relative to the sum of their sizes."""
    together: int = 2048
    """Answers judged together: as many as a processor's own memory holds."""
    least_deflection: float = 1e-6
    """Deflection of a case [m] in which nothing yields and no load closes a gap."""
    trains: int = 64
    """Trains of which the mechanics are kept: more than the positions of a march judged in turn."""
    carries: float = 1e-9
    """Part of the load from which on a contact counts as carrying, and of the deflection within
    which a radius counts as at a corner: the band of the certificate."""
    rank: float = 1e-10
    """Relative size below which a singular value of unit rows is none."""
    flat: float = 1e-13
    """Relative stiffness below which a move is held by nothing: round-off of the stiffest
    element."""
    nothing: float = 1e-15
    """Curvature that is none: what round-off leaves where rigid contacts allow no move."""
    turned: float = 0.01
    """Angle [rad] of a line of action or a ring's arm from which on a warning is given: forces are
    off by 1 % then, about as far as mesh stiffnesses are known."""
    neglected: float = 0.01
    """Share of the case's deflection that the approach neglects, from which on a warning is given:
    what compliances make of it changes torques by about 1 %."""
    meaningless: float = 1.0
    """Share from which on an answer is refused: the neglected approach is all of the deflection, or
    the compression all of a tooth's height."""
    compressed: float = 0.1
    """Share of a tooth's height by which it yields, from which on a warning is given: the square of
    it, 1 %, is what linear bending neglects."""
    height: float = 2.25
    """Height of a tooth in modules: addendum 1, dedendum 1.25."""
    fewest: int = 17
    """Teeth of a gear of which none are known: the fewest without undercut (20 deg), so that its
    teeth are the highest."""
    noise: float = 1e-12
    """Force, over the largest one, that is a solver's rounding."""
    alike: float = 1e-9
    """Relative difference of figures that differ by round-off alone."""


class Bound(NamedTuple):
    """Bounds on the distance of a claim from the exact equilibrium."""

    noise: float = 1e-12
    """Force, over the largest one, of a contact that may as well be open: a solver's rounding over
    a clear gap. It is put aside; so is the friction of a spline that takes no more torque than
    that."""
    light_friction: float = 1e-10
    """Friction, in loads of the claim, that may be put aside where nothing else bounds a torque."""
    enough: float = 1e-11
    """Relative bound with which double precision is content."""
    together: int = 512
    """Claims that are looked at in twice the precision at a time."""
    abreast: int = 16
    """Claims whose products Numba finds side by side."""
    soft: float = 1e5
    """Largest compliance of a turn of a line, at first, in compliances of the claim: what is softer
    hardly carries."""
    softest: float = 1e11
    """The same at last, where a turn that is stiffer bounds nothing."""
    yielding: float = 1e3
    """Largest compliance of what slips, in compliances of the claim."""
    light: float = 1e-9
    """Force, in loads of the claim, at which the tangent of a contact without force is taken. Below
    it a Hertz contact is softer still: it answers by something between that tangent and none."""
    reached: float = 4.0
    """Times the force of a contact on the verge up to which its tangent holds."""
    apart: float = 1e-6
    """Gap, over the largest deflection, that is clear."""
    corner: float = 1e-12
    """Relative distance from a level within which a force is on it, up to rounding."""
    secant: float = 0.9
    """Part of the tangent compliance that the secant to the exact force keeps. The bound is far
    below a tenth of the force wherever it is of use; elsewhere it is refused."""
    endless: float = 1e300
    """Compliance, over the tangent's, of a Hertz contact without force: there is no largest."""
    near: float = 1e-6
    """Gap, over the widest one, within which a contact counts among those that may carry."""
    touching: float = 1e-9
    """The same in large batches, whose claims are exact to rounding: fewer sets of elements."""
    opposed: float = 1.0 - 1e-6
    """Cosine from which on two arcs are opposed."""
    in_line: float = 1e-12
    """Angle [rad] between two arcs' lines that is rounding: what they squeeze stays in between."""
    angle: float = 0.02
    """Angle [rad] between two lines that still count as nearly the same."""
    references: int = 16
    """Claims whose lines are tried on all those whose elements act alike."""
    few: int = 8
    """Claims up to which each is bounded by itself where lines turn."""
    gain: float = 0.5
    """Largest share of an error that may come back over friction that follows the torque."""
    wider: float = 2.0
    """How far a box goes beyond what came out of the one before."""
    passes: int = 8
    """Boxes that are tried; the second mostly holds."""
    singular: float = 1e-15
    """Compliance of a self-stress, over the largest, below which it is shared by rigid parts
    alone."""
    shared: float = 1e-7
    """Part of a force in a self-stress of rigid parts from which on it is undetermined."""
    balanced: float = 1e-12
    """Load along a move that nothing resists, over the load, that is rounding."""
    rounded: float = 64.0 * EPS
    """The same over any force: sums of many terms."""
    wider_lines: tuple[float, float] = (2.0, 10.0)
    """Times the error without it, over which the turn of lines is bounded."""
    sets_told_apart: int = 1000
    """Sets of elements that are told apart in a batch."""
    sets_together: int = 64
    """Sets whose figures are found at a time, so that memory is bounded."""
    sets: int = 2000
    """Sets of elements of which the statics are kept, so that memory is bounded."""
    slip_turns: float = 1e-4
    """Angle by which a slip may turn."""
    slack: float = 1e-6
    """Part of the level within which a force is on it where the place says that something slips."""
    at_end: float = 1e-6
    """Distance of a slip from the end of its room, over the slip, within which it is at the end."""
    next_to: float = 1e-12
    """The same over the displacement: rounding of what has moved far."""
    turned: float = 1e-11
    """Error of a torque over a spline, in torques of the claim, for which its room is made wider.
    That much is hardly ever asked for: friction mostly needs its clearance by more than this."""
    slight: float = 1e-6
    """Play, in deflections of the claim, of a gear that counts as locked."""
    bowed: float = 1e-3
    """Play, in centre distances of an arc, below which the arc is taken for its tangent and a
    bow."""
    trains: int = 64
    """Trains of which the columns are kept: more than the positions of a march judged in turn."""
    used_up: float = 1e-9
    """Distance of a force from its friction bound, over the bound, up to which it may be used
    up."""
    margin: float = 1e-6
    """How far the place of a gear whose spline has used up its friction may lie beyond the slip,
    over the clearance: small for the forces, and large beside their errors."""
    rank: float = 1e-11
    """Singular value of the directions, relative to the largest, that counts as zero. Directions
    are cosines and ratios of radii; what geometry makes dependent is so to some 1e-16."""
    loose: float = 1e-7
    """Part of a coordinate in a move that nothing resists from which on it is undetermined."""
    on_the_verge: int = 7
    """Elements on the verge of which every combination is tried. With more, convexity alone bounds
    the error (see `quick`), which asks for no combination."""
    verge_passes: int = 4
    """Passes in which further elements may turn out to be on the verge."""
    idle: float = 1e-9
    """Part in self-stresses below which a contact cannot change a force."""


class Follow(NamedTuple):
    """Following an active set along a parameter, and what proves that no event was passed over."""

    carries: float = 1e-11
    """Force over the load from which on a contact counts as closed."""
    facets: int = 24
    """Sides at first of the polygon that stands for a round ring in which a body floats."""
    polygons: int = 24
    """Polygons at most; two are taken as a rule, and each leaves a quarter of the error at most."""
    full: float = 1e-3
    """Part of the room a polygon promises that may be missing."""
    spent: float = 1e-12
    """Room [deflections] that is none."""
    unit_of_room: float = 1e-6
    """Unit of room [deflections] in which a linear programme is exact to the last digits."""
    binds: float = 1e-6
    """Room [deflections] left by the linear programme at which a limit binds."""
    room: float = 1.0
    """Room [deflections] around a floating body that is as good as any more."""
    felt: float = 1e-9
    """Speed at which a move closes a limit, over that of the move, below which it does not."""
    steps: int = 40
    """Newton's steps before a branch counts as lost."""
    solved: float = 1e-11
    """Last step of an answer, relative to the largest unknown."""
    roots: int = 30
    """Newton's steps for a cube root of a force; about six are taken."""
    rank: float = 1e-12
    """Singular values below this, relative to the largest, of the scaled Jacobian, count as
    zero."""
    enclosures: int = 6
    """Attempts to find an enclosure."""
    verge: float = 1e-11
    """Gauge, in deflections or loads, that counts as zero: a hundredth of what is certified."""
    unfelt: float = 1e-10
    """Part of a move, or of the load along it, that counts as none."""
    nodes: int = 5
    """Values of a stretch at which the parameter's effect is sampled."""
    first: int = 8
    """Stretches at the beginning."""
    cut: float = 0.4877
    """Where a stretch is cut: no simple fraction, for those are where thresholds stand."""
    beside: float = 0.05
    """Distance from an event at which a stretch is cut, over its width."""
    least: float = 1e-10
    """Width of a stretch that is not cut any more, over the largest value."""
    most: int = 2000
    """Stretches of a position; what is left then is named as not proved."""
    idle: float = 1e-11
    """Force and compression, over load and deflection, at which a closed contact carries
    nothing."""
    sections: int = 9
    """Values between two ends at which the gauges of one are looked at."""
    grade: float = 0.5
    """Ratio of stretches that shrink towards an event."""
    resolved: float = 1e-9
    """Distance from an event that counts as the event itself, over its value."""
    refinements: int = 16
    """Refinements of a bracket; three are taken as a rule, and each halves it at least."""
    exact: float = 1e-12
    """Width of a bracket, over the largest value, that is good enough where rounding stops it."""
    adjacent: float = 4e-16
    """Width of a bracket, over its value, with nothing in between."""


class Sensitivity(NamedTuple):
    """Derivatives at an equilibrium, by its equations and by differences."""

    loose: float = 1e-9
    """Approach per move that nothing resists, from which on a contact's approach is
    undetermined."""
    roundings: float = 4.0
    """Roundings that a term of the residual has behind it: radii, directions, sums."""
    first: float = 1e-4
    """First step, relative to the input's value or to the step that differencing takes."""
    steps: int = 6
    """Steps that are tried as a rule, each a quarter of the one before."""
    most: int = 16
    """Steps that are tried where an event stands so near that slopes grow as steps shrink."""
    settled: int = 5
    """Steps over which slopes must not have grown to count as settled."""
    solved: float = 1e-12
    """What a certified solve leaves open of the largest force and displacement."""
    safe: float = 3.0
    """Error over the distance of two neighbouring limits."""
    step: float = 1e-3
    """Step relative to the input's value: its fourth power, and round-off over it, are about
    1e-12."""
    shorter: tuple[float, ...] = (1.0, 1.0 / 16.0, 1.0 / 256.0)
    """Shares of the step that are tried until the input may take it."""
    other: tuple[float, ...] = (1.0 / 16.0, 1.0 / 256.0, 16.0)
    """Steps, over the usual one, that are tried where it leaves a large error."""
    close: float = 1e-8
    """Relative error of a derivative that calls for no other step."""
    kink: float = 1e-7
    """Difference of both sides, over the largest derivative, from which on there is a kink."""
    central: float = 1.5
    """Sum of the weights of a central difference: its rounding over that of its terms."""
    forward: float = 5.5
    """The same of a one-sided difference."""
    verge: float = 1e-9
    """Gauge below which an element stands on the verge, in deflections or loads."""
    rank: float = 1e-13
    """Singular values of the equilibrated Jacobian below this, over the largest, count as zero."""
    follows: float = 1e-7
    """Part of a derivative that an active set may leave unbalanced; it counts as an error."""
    slides: float = 1e-7
    """Rate at which a verge element is violated that counts as none, over the largest rate."""
    way: float = 1e-4
    """Move over which the gauges are differenced, in deflections and loads."""
    apart: float = 1e-3
    """Part of a step from the value on which a kink counts as standing somewhere else."""
    near: tuple[float, ...] = (1e-5, 1e-7, 1e-3)
    """Effects of the steps, in deflections and loads, after which the set of a side is looked
    for."""
    round_off: float = 1e-11
    """Effect of an input's step that counts as none, likewise."""
    tie: float = 1e-9
    """Shares that differ by no more are both the largest."""
    beside: float = 1e-6
    """Change of an input, relative to its value, within which a step of the answer is told."""


class Contact(NamedTuple):
    """Programmes of contact: exact active sets, the proximal method and the outer loop."""

    tolerance: float = 1e-9
    """Largest residual, in forces and lengths of the problem."""
    directed: float = 1e-12
    """Offset, in lengths of the problem, that has no direction."""
    loose: float = 1e-9
    """Part of a coordinate in a move that nothing resists from which on it is undetermined."""
    sign: float = 1e-11
    """Violation of a sign, in units of the programme, that counts as round-off."""
    sign_of_size: float = 1e-14
    """The same, relative to the largest quantity of its sort."""
    newton_steps: int = 40
    """Newton steps on one set; those that arrive mostly do in ten."""
    definite: float = 1e-12
    """Least eigenvalue of the stiffness, over its largest, with which it is inverted."""
    rank: float = 1e-13
    """Eigenvalues of the equilibrated matrix below this, relative to the largest, count as zero."""
    consistent: float = 1e-11
    """Relative residual above which a rank-deficient system has no solution. Rounding of a scene
    leaves some 1e-12 along moves that only rounding resists."""
    stalled: float = 1e-9
    """A loop whose misfit no longer falls has arrived at round-off below this, and is stuck
    above."""
    stuck: int = 30
    """Passes that do not halve the misfit, after which a loop goes around without end."""
    shrink: float = 0.1
    """An open flank's next tangent is taken at this fraction of its last force."""
    singular: float = 1e-12
    """Eigenvalue of a stiffness, over its largest entry, that is zero."""
    arrived: float = 1e-13
    """Residual of a pass, relative to the largest force or displacement, that is round-off."""


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


class Search(NamedTuple):
    """The proximal search where exchange leads nowhere."""

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
    tries: int = 3
    """Passes from which a set is solved exactly: a later one may stand nearer."""
    idle: float = 1e-6
    """Force, over the largest, up to which a contact may be idle: a pass adds some of its own."""
    exchanges: int = 7
    """Sets that an exact solve visits from where the passes stand: enough to tell to and fro."""


class Places(NamedTuple):
    """Places that forces leave open, limits that contradict one another, loads that drive."""

    carries: float = 1e-11
    """Force, over the largest, from which on a contact holds: far above the round-off of forces,
    far below what a certificate vouches for."""
    loose: float = 1e-9
    """Part of a coordinate in a move from which on it takes part: round-off of the moves is
    smaller."""
    play: float = 1e-9
    """Range, in lengths of the case, below which a place counts as determined: what contacts that
    carry nothing leave between them but for round-off."""
    renewals: int = 12
    """Passes that renew the faces of arcs."""
    inside: float = 1e-12
    """How far a point may lie outside, in sizes of the region: round-off of what bounds it."""
    almost: float = 1e-6
    """Distance to a bound, in sizes of the region, at which an interior-point answer reaches it."""
    passes: int = 20
    """Newton passes on the bounds that are reached."""
    arrived: float = 1e-14
    """Step, in sizes of the region, that ends them."""
    balanced: float = 1e-9
    """Part of a pull, in sizes of the region, that its bounds may leave unbalanced."""
    noise: float = 1e-12
    """Force, over what a gap would cost if it were pressed shut, that counts as round-off."""
    verified: float = 1e-11
    """Violation of a removed inequality that counts as round-off, in deflections and loads."""
    work: float = 1e-3
    """Work of the load along a move, over load and move, from which on the load drives it."""
    yields: float = 1e-10
    """Part of a move that elements may still seem to resist: forces that balance the load in spite
    of it would be ten million times as large."""
    overlap: float = 1e-12
    """Overlap, over the lengths at hand, that counts as round-off."""
    named: float = 1e-6
    """Share in a contradiction, or in a move that nothing holds, from which on a limit or a
    coordinate is named."""
    programmes: int = 20
    """Programmes in which tangents of round limits are added to those before."""
    pushed: float = 1e-9
    """Load along a move, over the load, from which on it counts: less, and flanks whose normals are
    opposite up to the digits of a case file would seem to give way."""


class Job(NamedTuple):
    """How cases and samples are taken through: rungs, engines, blocks."""

    least: float = 1e-3
    """Force, in loads, at which the law of a contact that carries less is taken as its tangent."""
    plainly: float = 1e-6
    """Overlap of rigid limits, over the lengths at hand, after which nothing else need be tried."""
    steps: int = 20_000
    """Newton steps in which the rungs after the hot path answer or give up: some ten seconds, and
    twice what ever led to an answer that neither exchange nor search had found."""
    few: int = 2000
    """Equilibria up to which compiling, or reading what was compiled, costs more than it saves."""
    loading: int = 100
    """Equilibria, solved case by case, from which on reading what was compiled is worth while."""
    trial_samples: int = 16
    """Samples that show the others where to begin."""
    worth: int = 32
    """How many times as many samples it takes for that to be worth while."""
    block: int = 4096
    """Samples that are solved together, if every one has a few positions."""
    together: int = 65536
    """Equilibria that are solved together: half as many take a twentieth more time."""
    workers: int = 2
    """Threads; the compiled passes hold no lock."""
    recent: int = 16
    """Machines that are kept, for those who solve samples of one case again and again."""
    starts: int = 64
    """Starts: sets of contacts and places drawn at random."""
    path: int = 12
    """Steps of the path, each with half the extra clearance of the one before, and at last none."""
    generous: float = 100.0
    """Extra clearance at which the path begins, in deflections of the case: no arc carries
    there."""
    small: float = 0.9
    """Part of what is refused below which displacements, measured of many answers at once, are not
    measured one by one; the two ways differ by round-off."""
    same: float = 1e-6
    """Largest difference of flank forces, in loads, of answers that are the same."""


class Allowed(NamedTuple):
    """What a case file may hold: far more than any machine needs, and no more than can be read."""

    bytes: int = 16 * 2**20
    """Size of a file."""
    files: int = 20
    """Files that extend one another."""
    depth: int = 20
    """Tables and lists within one another."""
    entries: int = 10_000
    """Elements of a section, and entries of a list."""
    name: int = 200
    """Characters of a name."""
    unit: int = 60
    """Characters of a unit."""
    power: float = 12.0
    """Exponent in a unit."""
    smallest: float = 1e-40
    """Number other than zero, in SI units: its cube is a number still."""
    largest: float = 1e40
    """Number in SI units: likewise."""
    positions: int = 100_000
    """Positions of a mesh cycle."""
    steps: int = 1_000_000
    """Steps of a march or a sweep."""
    revolutions: float = 1e6
    """Revolutions of a march: beyond, the angle itself is rounded too coarsely."""
    samples: int = 1_000_000_000
    """Samples of a study."""


LAWS = Laws()
HOT = HotPath()
ABREAST = Abreast()
STATICS = Statics()
CERTIFY = Certify()
BOUND = Bound()
FOLLOW = Follow()
SENSITIVITY = Sensitivity()
CONTACT = Contact()
EXCHANGE = Exchange()
SEARCH = Search()
PLACES = Places()
JOB = Job()
ALLOWED = Allowed()
