"""Verdicts on answers, and bounds on their errors."""

from __future__ import annotations

from typing import NamedTuple

from loadshare.settings.precision import EPS


class Certify(NamedTuple):
    """Verdicts on answers."""

    tolerance: float = 1e-9
    """Largest scaled residual of a certified answer."""
    band: float = 1e-9
    """Band in which a margin counts as zero, in deflections of the case."""
    largest: float = 1e-3
    """Largest tolerance: an answer that may be off by more than a thousandth would be a guess, and
    Ω is read to three digits after the point."""
    rounded: float = 16.0 * EPS
    """Rounding of energies, relative to the sum of their sizes."""
    resolution: float = 16.0 * EPS
    """Rounding of a length, relative to the largest displacement, error and gap together: some
    terms, each known to a few EPS, as displacements are products over coordinates. A train on soft
    shafts, whose input turns by a thousand turns, misses its laws by up to 6 EPS."""
    side_by_side: int = 8
    """Positions of a result that are judged together: NumPy takes as long for one of them, and
    reading a single one costs no more than these."""
    together: int = 2048
    """Answers judged together: as many as a processor's own memory holds."""
    least_deflection: float = 1e-6
    """Deflection of a case [m] in which nothing yields and no load closes a gap."""
    trains: int = 64
    """Trains of which the mechanics are kept: more than the positions of a march judged in turn."""
    carries: float = 1e-9
    """Part of the load above which a contact counts as carrying, and of the deflection within which
    a radius counts as at a corner: the band of the certificate."""
    rank: float = 1e-10
    """Relative size below which a singular value of unit rows counts as zero."""
    flat: float = 1e-13
    """Relative stiffness below which nothing holds a move: round-off of the stiffest element."""
    nothing: float = 1e-15
    """Curvature that counts as zero: round-off where rigid contacts allow no move."""
    turned: float = 0.01
    """Angle [rad] of a line of action or a ring's arm above which a warning is given: forces are
    then off by 1 %, about as far as mesh stiffnesses are known."""
    neglected: float = 0.01
    """Share of the case's deflection that the approach neglects, above which a warning is given: by
    way of compliances it changes torques by about 1 %."""
    meaningless: float = 1.0
    """Share from which an answer is refused: the neglected approach is all of the deflection, or
    the compression all of a tooth's height."""
    compressed: float = 0.1
    """Compression, as a share of a tooth's height, above which a warning is given: linear bending
    neglects its square, 1 %."""
    apart: float = 0.02
    """Opening of a mesh without a given backlash, over the height of its teeth, above which it is
    reported: 0.045 modules, about the play that teeth usually have."""
    height: float = 2.25
    """Height of a tooth in modules: addendum 1, dedendum 1.25."""
    fewest: int = 17
    """Tooth number assumed where none is known: the fewest without undercut (20 deg), so that the
    teeth are the highest."""
    noise: float = 1e-12
    """Force, over the largest one, that counts as a solver's rounding."""
    alike: float = 1e-9
    """Relative difference of figures that differ by round-off alone."""
    near_root: float = 1e-8
    """Newton step, relative, beyond which a claimed force is no start for the root of a law."""
    roots: int = 60
    """Most Newton steps for the root of a law, from above."""
    root: float = 1e-15
    """Last of these steps, relative."""


class Bound(NamedTuple):
    """Bounds on the distance of a claim from the exact equilibrium."""

    noise: float = 1e-12
    """Force, over the largest one, of a contact that may as well be open: a solver's rounding over
    a clear gap. It is put aside; so is the friction of a spline that transmits no more torque than
    this."""
    light_friction: float = 1e-10
    """Friction, in loads of the claim, that may be put aside where nothing else bounds a torque."""
    enough: float = 1e-11
    """Relative bound below which twice the precision is not tried."""
    together: int = 512
    """Claims that are bounded in twice the precision at a time."""
    side_by_side: int = 64
    """Claims whose products Numba computes side by side."""
    soft: float = 1e5
    """Largest compliance of a turn of a line, at first, over the largest of the claim: a softer one
    hardly carries."""
    softest: float = 1e11
    """The same in the second attempt, where a stiffer turn bounds nothing."""
    yielding: float = 1e3
    """Largest compliance of an element that slips, over the largest of the claim."""
    light: float = 1e-9
    """Force, in loads of the claim, at which the tangent of a contact without force is taken. Below
    it a Hertz contact is softer still: its response lies between that tangent's and none."""
    reached: float = 4.0
    """Times the force of a contact on the verge up to which its tangent holds."""
    apart: float = 1e-6
    """Gap, over the largest deflection, above which a contact is clearly open."""
    corner: float = 1e-12
    """Relative distance from a level within which a force is on it, up to rounding."""
    secant: float = 0.9
    """Least secant compliance to the exact force, over the tangent's. The bound is far below a
    tenth of the force wherever it is of use; elsewhere it is refused."""
    bent: float = 0.05
    """Error, over the force, up to which `secant` holds for a wall with a power law."""
    endless: float = 1e300
    """Compliance, over the tangent's, of a Hertz contact without force: it is unbounded."""
    near: float = 1e-6
    """Gap, over the widest one, within which a contact counts among those that may carry."""
    touching: float = 1e-9
    """The same in large batches, whose claims are exact to rounding: fewer sets of elements."""
    opposed: float = 1.0 - 1e-6
    """Cosine above which two arcs are opposed."""
    in_line: float = 1e-12
    """Angle [rad] between two arcs' lines that is rounding: the arcs can hold a squeezed float."""
    angle: float = 0.02
    """Angle [rad] between two lines that still count as nearly the same."""
    references: int = 16
    """Claims whose lines are tried for all claims whose elements act alike."""
    operators: int = 1 << 21
    """Numbers in the operators of claims that are found together, so that memory is bounded."""
    few: int = 8
    """Number of claims up to which each is bounded separately where lines turn."""
    gain: float = 0.5
    """Largest share of an error that may be fed back by friction that follows the torque."""
    wider: float = 2.0
    """Size of a box over the result of the box before."""
    passes: int = 8
    """Boxes that are tried; the second mostly holds."""
    singular: float = 1e-15
    """Compliance of a self-stress, over the largest, below which it is one of rigid parts alone."""
    shared: float = 1e-7
    """Part of a force in a self-stress of rigid parts above which it is undetermined."""
    balanced: float = 1e-12
    """Load along a move that nothing resists, over the load, that is rounding."""
    rounded: float = 64.0 * EPS
    """The same over any force: sums of many terms."""
    wider_lines: tuple[float, float] = (2.0, 10.0)
    """Sizes of the box over which the turn of lines is bounded, over the error without a turn."""
    sets_distinguished: int = 1000
    """Sets of elements that are distinguished in a batch."""
    sets_together: int = 64
    """Sets whose figures are computed at a time, so that memory is bounded."""
    sets: int = 2000
    """Sets of elements of which the statics are kept, so that memory is bounded."""
    slip_turns: float = 1e-4
    """Angle [rad] by which a slip may turn."""
    slack: float = 1e-6
    """Part of the level within which a force is on it where the place shows that it slips."""
    at_end: float = 1e-6
    """Distance of a slip from the end of its room, over the slip, within which it is at the end."""
    next_to: float = 1e-12
    """The same over the displacement: rounding after a long move."""
    turned: float = 1e-11
    """Error of a torque over a spline, in torques of the claim, for which its room is made wider.
    This is hardly ever needed: friction mostly uses up its clearance by more than this."""
    slight: float = 1e-6
    """Play, in deflections of the claim, of a gear that counts as locked."""
    bowed: float = 1e-3
    """Play, in centre distances of an arc, below which the arc is replaced by its tangent and a
    bow."""
    trains: int = 64
    """Trains of which the columns are kept: more than the positions of a march judged in turn."""
    used_up: float = 1e-9
    """Distance of a force from its friction bound, over the bound, up to which it may be used
    up."""
    margin: float = 1e-6
    """How far the place of a gear whose spline has used up its friction may lie beyond the slip,
    over the clearance: small for the forces, and large compared with their errors."""
    rank: float = 1e-11
    """Singular value of the directions, relative to the largest, that counts as zero. Directions
    are cosines and ratios of radii; what geometry makes dependent is so to some 1e-16."""
    by_singular_values: int = 32
    """Directions, and coordinates, up to which singular values take no longer than reflections."""
    loose: float = 1e-7
    """Part of a coordinate in a move that nothing resists above which it is undetermined."""
    on_the_verge: int = 7
    """Most elements on the verge of which every combination is tried. With more, convexity alone
    bounds the error (see `quick`), which needs no combination."""
    verge_passes: int = 4
    """Passes in which further elements may turn out to be on the verge."""
    idle: float = 1e-9
    """Part in self-stresses below which a contact cannot change a force."""
    still: tuple[tuple[float, float], ...] = ((1e-10, 1e-4), (1e-10, 0.0), (2e-9, 1e-4))
    """Pairs that are tried in turn, up to which a spline counts as not moving: force by which it
    may give way within its room, in loads of the claim, and change of a slip, over the slip. What
    they neglect of the law is bounded."""
    digits: int = 20
    """Elements whose ways of acting make one number below 2⁶³."""
    step: float = 1e-12
    """Relative room below a friction bound above which a graph jumps."""


CERTIFY = Certify()
BOUND = Bound()
