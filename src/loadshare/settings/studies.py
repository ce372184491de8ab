"""Studies: paths of active sets, derivatives, marches, fits, tolerances."""

from __future__ import annotations

from typing import NamedTuple

from loadshare.settings.precision import EPS


class Follow(NamedTuple):
    """Following an active set along a parameter, and the proof that no event was passed over."""

    carries: float = 1e-11
    """Force over the load above which a contact counts as closed."""
    facets: int = 24
    """Sides, at first, of the polygon that replaces a round ring in which a body floats."""
    finer: int = 8
    """Parts into which the angle between two sides is cut where a body came to rest."""
    polygons: int = 8
    """Most polygons; two are usual, and each leaves 1/64 of the error at most."""
    full: float = 1e-3
    """Part of the room promised by a polygon that may be missing."""
    spent: float = 1e-12
    """Room [deflections] that counts as zero."""
    unit_of_room: float = 1e-6
    """Unit of room [deflections] in which a linear programme is exact to the last digits."""
    binds: float = 1e-6
    """Room [deflections] left by the linear programme at which a limit binds."""
    room: float = 1.0
    """Room [deflections] around a floating body beyond which more is no better."""
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
    """Gauge, in deflections or loads, that counts as zero: a hundredth of the certified
    tolerance."""
    unfelt: float = 1e-10
    """Part of a move, or of the load along it, that counts as zero."""
    mixed: float = 1e-6
    """Part of a move that round-off may have mixed into it from a move that is barely resisted."""
    nodes: int = 5
    """Values of a stretch at which the parameter's effect is sampled."""
    first: int = 8
    """Stretches at the beginning."""
    cut: float = 0.4877
    """Where a stretch is cut: not a simple fraction, as thresholds tend to lie at those."""
    beside: float = 0.05
    """Distance from an event at which a stretch is cut, over its width."""
    least: float = 1e-10
    """Width of a stretch that is not cut any more, over the largest value."""
    hopeful: int = 5
    """Number of cuts of stretches of which nothing was proved before they are given up."""
    parts: int = 512
    """Most parts, at once, in which sets are followed between points; the rest is reported."""
    most: int = 2000
    """Most stretches of a position; the rest is reported as not proved."""
    rounded: float = 64.0
    """Error of a contact's approach, in units of the last digit of its terms."""
    idle: float = 1e-11
    """Force and compression, over load and deflection, at which a closed contact carries
    nothing."""
    sections: int = 9
    """Values between two ends at which the gauges of one are evaluated."""
    grade: float = 0.5
    """Ratio of stretches that shrink towards an event."""
    resolved: float = 1e-9
    """Distance from an event that counts as the event itself, over its value."""
    refinements: int = 16
    """Most refinements of a bracket; three are usual, and each at least halves it."""
    exact: float = 1e-12
    """Width of a bracket, over the largest value, that is good enough where rounding stops it."""
    adjacent: float = 4e-16
    """Width of a bracket, over its value, with nothing in between."""
    last: float = 1e-15
    """Relative Newton step after which none is better."""
    lost: float = 1e9
    """Newton step, in deflections or loads, that shows divergence."""
    balanced: float = 1e-9
    """Largest misfit of the equations, over the load."""
    constant: float = 1e-12
    """Relative change of a stiffness along a stretch that counts as zero."""
    round_off: float = 64.0 * EPS
    """Round-off of a residual, over the sum of the sizes of its terms."""
    least_deviation: float = 1e-15
    """Deviation with which an enclosure begins."""
    wider: float = 1.1
    """Factor, in the next attempt, on the deviation that the last slopes require."""
    widest: float = 1e12
    """Deviation that no enclosure exceeds."""
    more: float = 1e-9
    """Part by which a proved deviation is enlarged for round-off."""
    around: tuple[float, ...] = (-1e-2, -1e-4, -1e-7, -1e-10, 0.0, 1e-10, 1e-7, 1e-4, 1e-2)
    """Parts of a bracket, around the guess of a zero, that are evaluated together."""


class Sensitivity(NamedTuple):
    """Derivatives at an equilibrium, by its equations and by differences."""

    loose: float = 1e-9
    """Approach per move that nothing resists, above which a contact's approach is
    undetermined."""
    roundings: float = 4.0
    """Roundings in every term of the residual: radii, directions, sums."""
    first: float = 1e-4
    """First step, relative to the input's value or to the step that differencing takes."""
    steps: int = 6
    """Steps that are usually tried, each a quarter of the one before."""
    most: int = 16
    """Steps that are tried where an event is so near that slopes grow as steps shrink."""
    settled: int = 5
    """Steps over which slopes must not have grown to count as settled."""
    solved: float = 1e-12
    """Uncertainty of a certified solve, over the largest force and displacement."""
    safe: float = 3.0
    """Error over the difference of two neighbouring limits."""
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
    """Relative error of a derivative that needs no other step."""
    kink: float = 1e-7
    """Difference of both sides, over the largest derivative, above which there is a kink."""
    central: float = 1.5
    """Sum of the weights of a central difference: its rounding over that of its terms."""
    forward: float = 5.5
    """The same for a one-sided difference."""
    verge: float = 1e-9
    """Gauge below which an element is on the verge, in deflections or loads."""
    rank: float = 1e-13
    """Singular values of the equilibrated Jacobian below this, over the largest, count as zero."""
    follows: float = 1e-7
    """Part of a derivative that an active set may leave unbalanced; it counts as an error."""
    slides: float = 1e-7
    """Rate of violation of an element on the verge, over the largest rate, that counts as zero."""
    way: float = 1e-4
    """Move over which the gauges are differenced, in deflections and loads."""
    apart: float = 1e-3
    """Distance of a kink from the value, over a step, above which it counts as being elsewhere."""
    near: tuple[float, ...] = (1e-5, 1e-7, 1e-3)
    """Effects of the steps, in deflections and loads, after which the set of a side is looked
    for."""
    round_off: float = 1e-11
    """Effect of an input's step that counts as zero, likewise."""
    tie: float = 1e-9
    """Difference up to which two shares both count as the largest."""
    beside: float = 1e-6
    """Change of an input, relative to its value, within which a step of the answer is reported."""
    least_value: float = 1e-3
    """Value [SI] from which the first step of an input that is zero is taken."""


class March(NamedTuple):
    """A march, whose splines remember their slips."""

    unchanged: float = 1e-11
    """Change of a slip, over the deflection of the case, that is round-off of an answer."""
    negligible: float = 1e-10
    """Friction, over the load, with which an answer found without it is still in balance to the
    certified tolerance."""
    quick: int = 200
    """Newton steps in which a step with friction that follows the torque is mostly found at
    once."""
    quick_plan: int = 60
    """Newton steps in which a plan of a step with fixed friction is found, if at all."""
    passes: int = 40
    """Passes in which friction follows the torque."""
    settled: float = 1e-14
    """Friction, over its bound under the full torque, that may be missing at the end."""
    close: float = 1e-11
    """Friction, over the bound, that may be missing where more passes gain nothing."""
    singular: float = 1e-3
    """Least part of a step that the inverse Jacobian recovers from its effect, for an update."""
    turns: int = 40
    """Alternations between slips and displacements."""
    halvings: int = 60
    """Halvings of an angle, to round-off."""
    round_off: float = 1e-15
    """Change of a slip over the displacement, or of a force over its bound, that counts as zero."""
    at_end: float = 1e-6
    """Room left in a clearance, over the clearance, below which its end is near."""


class Fit(NamedTuple):
    """Inputs fitted to measured figures."""

    separable: float = 1e-6
    """Singular value of the scaled sensitivities, over the largest, below which inputs cannot be
    told apart; and part of an input in a direction left open, below which it is round-off."""
    felt: float = 1e-6
    """Standard deviations by which the figures must change over the range of an input that they
    determine."""
    at_bound: float = 1e-9
    """Distance to a bound, over the range, that counts as zero."""
    inside: float = 1e-10
    """Least distance to a bound, over the range, at which a search begins."""
    last: float = 1e-13
    """Relative change of inputs, figures and slopes that ends a search."""
    improbable: float = 1e-3
    """Probability of a larger χ² under the stated uncertainties, below which χ² is reported."""


class Tolerance(NamedTuple):
    """Tolerance studies: what is drawn, what is kept, what counts as the same."""

    samples: int = 16384
    """Samples where no number is given."""
    rows: int = 1024
    """Rows of the design for the shares of variance where no number is given."""
    levels: tuple[float, ...] = (0.5, 0.9, 0.95, 0.99, 0.999)
    """Quantiles where none are given."""
    confidence: float = 0.95
    """Confidence of every interval."""
    sequences: int = 16
    """Scrambled Sobol sequences that take turns; they differ by chance alone, and so show the
    error."""
    smallest: float = 2.0**-54
    """Replaces a point at 0, which most distributions map to infinity."""
    definite: float = 1e-10
    """Least eigenvalue of a matrix of correlations."""
    far: float = 1e-9
    """Probability beyond the values with which the case is tried before anything is drawn."""
    tail: float = 0.00135
    """Probability beyond each end of a tolerance: three standard deviations of a normal
    distribution."""
    small: int = 100_000
    """Equilibria up to which starting worker processes costs more time than they save."""
    ahead: int = 2
    """Parts in flight for each thread of a cluster; more would only fill memory."""
    sampled: int = 2
    """Samples that are solved again of a part that was found on disk."""
    apart: float = 1e-6
    """Relative difference of a figure that two certified answers of one sample cannot have: each is
    known to 1e-9, and so is a largest figure over branches."""
    same: float = 1e-9
    """Relative difference of Ω by stage and by group that counts as zero."""
    pressed: float = 1e-9
    """Force on a boundary, over the largest one in the study, above which it counts as pressed."""
    still: float = 1e-9
    """Deviation, over the size of a figure, below which the figure does not vary: round-off gets no
    share."""
    resamples: int = 1000
    """Bootstrap samples."""
    bins: int = 60
    """Bins of the histograms."""
    least_width: float = 1e-6
    """Least width of a histogram, over the largest figure."""
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
    """Factor on a step that gains nothing."""
    rounds: int = 200
    """Most rounds of steps."""
    gain: float = 1e-12
    """Least change of Ω that counts as a gain."""


FOLLOW = Follow()
SENSITIVITY = Sensitivity()
MARCH = March()
FIT = Fit()
TOLERANCE = Tolerance()
