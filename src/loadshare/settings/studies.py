"""Studies: paths of active sets, derivatives, marches, fits, tolerances."""

from __future__ import annotations

from typing import NamedTuple

from loadshare.settings.precision import EPS


class Follow(NamedTuple):
    """Following an active set along a parameter, and what proves that no event was passed over."""

    carries: float = 1e-11
    """Force over the load from which on a contact counts as closed."""
    facets: int = 24
    """Sides at first of the polygon that stands for a round ring in which a body floats."""
    finer: int = 8
    """Into so many parts the angle between two sides is cut where a body came to rest."""
    polygons: int = 8
    """Polygons at most; two are taken as a rule, and each leaves 1/64 of the error at most."""
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
    rank: float = 1e-12
    """Singular values below this, relative to the largest, of the scaled Jacobian, count as
    zero."""
    enclosures: int = 6
    """Attempts to find an enclosure."""
    verge: float = 1e-11
    """Gauge, in deflections or loads, that counts as zero: a hundredth of what is certified."""
    unfelt: float = 1e-10
    """Part of a move, or of the load along it, that counts as none."""
    mixed: float = 1e-6
    """Part of a move that round-off may have mixed into it from one that is barely resisted."""
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
    hopeful: int = 5
    """How often stretches are cut of which nothing was proved, before all of it is given up."""
    parts: int = 512
    """Parts, at once, in which sets are followed between points; what is left then is named."""
    most: int = 2000
    """Stretches of a position; what is left then is named as not proved."""
    rounded: float = 64.0
    """Errors of a contact's approach, in units of the last digit of the lengths it is made of."""
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
    last: float = 1e-15
    """Newton step after which there is no better one, relative."""
    lost: float = 1e9
    """Newton step, in deflections or loads, that gets nowhere."""
    balanced: float = 1e-9
    """What the equations may be missed by, over the load."""
    constant: float = 1e-12
    """Relative change of a stiffness along a stretch that is none."""
    round_off: float = 64.0 * EPS
    """Round-off of a residual, over the sum of the sizes of its terms."""
    least_deviation: float = 1e-15
    """Deviation that an enclosure begins with."""
    wider: float = 1.1
    """Factor on what the last slopes ask for in the next attempt."""
    widest: float = 1e12
    """Deviation that no enclosure exceeds."""
    more: float = 1e-9
    """Part by which a proved deviation is enlarged for round-off."""
    around: tuple[float, ...] = (-1e-2, -1e-4, -1e-7, -1e-10, 0.0, 1e-10, 1e-7, 1e-4, 1e-2)
    """Parts of a bracket, around the guess of a zero, that are looked at together."""


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
    other: tuple[float, ...] = (1.0 / 16.0, 1.0 / 256.0, 1.0 / 4096.0, 1.0 / 65536.0, 16.0)
    """Steps, over the usual one, that are tried where it leaves a large error: shorter ones until
    they leave round-off, a longer one if none of them leaves less."""
    regular: float = 1e-3
    """Relative error of a derivative below which a larger one at a shorter step is round-off."""
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
    """Change of an input, relative to its value, within which a step of the answer is reported."""
    least_value: float = 1e-3
    """Value [SI] from which the first step of an input that is zero is taken."""


class March(NamedTuple):
    """A march, whose splines remember their slips."""

    unchanged: float = 1e-11
    """Change of a slip, over the deflection of the case, that is round-off of an answer."""
    negligible: float = 1e-10
    """Friction, over the load, that an answer without it is in balance with, as far as
    certified."""
    quick: int = 200
    """Newton steps in which a step with friction that follows the torque is mostly found at
    once."""
    quick_plan: int = 60
    """Newton steps in which a plan of a step with fixed friction is found, or mostly never."""
    passes: int = 40
    """Passes in which friction follows the torque."""
    settled: float = 1e-14
    """Friction, over its bound under all of the torque, that may be missing at the end."""
    close: float = 1e-11
    """Friction, over the bound, that may be missing where more passes bring no more."""
    singular: float = 1e-3
    """Part of a step that a step must explain."""
    turns: int = 40
    """Turns between slips and displacements."""
    halvings: int = 60
    """Halvings of an angle, to round-off."""
    round_off: float = 1e-15
    """Change of a slip over the displacement, or of a force over its bound, that is none."""
    at_end: float = 1e-6
    """Room left in a clearance, over the clearance, below which its end is near."""


class Fit(NamedTuple):
    """Inputs fitted to what was measured."""

    separable: float = 1e-6
    """Singular value of the scaled sensitivities, over the largest, below which inputs cannot be
    told apart; and part of an input in what is left open, below which it is round-off."""
    felt: float = 1e-6
    """Standard deviations by which the figures must change over the range of an input that they
    determine."""
    at_bound: float = 1e-9
    """Distance to a bound, over the range, that counts as none."""
    inside: float = 1e-10
    """Distance to a bound, over the range, at which a search begins at least."""
    last: float = 1e-13
    """Relative change of inputs, figures and slopes that ends a search."""
    improbable: float = 1e-3
    """How seldom the stated uncertainties make χ² as large as one that is told."""


class Tolerance(NamedTuple):
    """Tolerance studies: what is drawn, what is kept, what counts as the same."""

    samples: int = 16384
    """Samples where no number is given."""
    rows: int = 1024
    """Rows of the design for the shares of variance where no number is given."""
    levels: tuple[float, ...] = (0.5, 0.9, 0.95, 0.99, 0.999)
    """Quantiles where none are given."""
    confidence: float = 0.95
    """Of every interval."""
    sequences: int = 16
    """Scrambled Sobol sequences that take turns; they differ by chance alone, and so tell the
    error."""
    smallest: float = 2.0**-54
    """Stands for a point at 0, of which most distributions make infinity."""
    definite: float = 1e-10
    """Least eigenvalue of a matrix of correlations."""
    far: float = 1e-9
    """Probability beyond the values with which the case is tried before anything is drawn."""
    tail: float = 0.00135
    """Probability beyond each end of a tolerance: three standard deviations of a normal one."""
    small: int = 100_000
    """Equilibria up to which starting worker processes costs more time than they save."""
    ahead: int = 2
    """Parts in flight for each thread of a cluster; more would only fill memory."""
    sampled: int = 2
    """Samples of a part that was found that are solved again."""
    apart: float = 1e-6
    """Relative difference of a figure that two certified answers of one sample cannot have: each is
    known to 1e-9, and a largest figure over branches is no less so."""
    same: float = 1e-9
    """Relative difference of Ω by stage and by group that counts as none."""
    pressed: float = 1e-9
    """Force on a boundary, over the largest one in the study, that counts as one."""
    still: float = 1e-9
    """Deviation, over the size of a figure, below which it does not vary: round-off has no
    share."""
    resamples: int = 1000
    """Bootstrap samples."""
    bins: int = 60
    """Of the histograms."""
    least_width: float = 1e-6
    """Width of a histogram, over the largest figure, at least."""
    worst: int = 4
    """Worst samples from which the search for the worst case starts."""
    corners: int = 6
    """Starting points of that search at random vertices of the box."""
    inner: int = 6
    """Starting points at random inside it."""
    step: float = 0.5
    """First step along an input, over the width of its tolerance."""
    last_step: float = 1e-4
    """Last step, likewise."""
    narrower: float = 0.25
    """Factor of a step that gains nothing."""
    rounds: int = 200
    """Rounds of steps at most."""
    gain: float = 1e-12
    """Change of Ω that counts as one."""


FOLLOW = Follow()
SENSITIVITY = Sensitivity()
MARCH = March()
FIT = Fit()
TOLERANCE = Tolerance()
