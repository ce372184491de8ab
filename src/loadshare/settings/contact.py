"""Programmes of contact: laws as they are given, exact active sets, cones, the outer loop."""

from __future__ import annotations

from typing import NamedTuple


class Laws(NamedTuple):
    """Laws as they are given."""

    written: float = 1e-6
    """Relative excess of K_w S1 over F_m that the digits of a written S1 explain: six are usual."""
    wall_start: float = 1e-12
    """Force, over the load, at which the wall of a bearing that begins without stiffness is taken
    to begin."""


class Contact(NamedTuple):
    """Programmes of contact: exact active sets, the proximal method and the outer loop."""

    tolerance: float = 1e-9
    """Largest residual, in forces and lengths of the problem."""
    stop: float = 1e-12
    """Misfit of laws, faces and friction bounds at which the outer loop ends."""
    iterations: int = 120
    """Passes of the outer loop before the other method is tried."""
    interior: float = 1e-11
    """Gap and residuals that interior-point methods must reach; the exact solve follows."""
    interior_steps: int = 200
    """Most steps of interior-point methods."""
    splitting: float = 1e-9
    """Residuals that operator splitting must reach, before it is polished."""
    splitting_steps: int = 100_000
    """Most steps of operator splitting."""
    refined: int = 3
    """Passes of a linear solve: the first solves, the others refine."""
    equilibrated: int = 4
    """Passes that bring the largest entry of every row near 1."""
    yields: float = 1e-6
    """Compression, in lengths of the problem, below which a contact counts as rigid when a claim is
    measured: its force does not show in its place."""
    far: float = 1e100
    """Coordinate, in units of the programme, at which a search has run away; its square is still a
    double."""
    least_way: float = 1e-6
    """Least part of a move by which it must leave an end behind, for the end to count as not
    held."""
    loose: float = 1e-9
    """Part of a coordinate in a move that nothing resists above which it is undetermined."""
    sign: float = 1e-11
    """Violation of a sign, in units of the programme, that counts as round-off."""
    sign_of_size: float = 1e-14
    """The same, relative to the largest quantity of its kind."""
    newton_steps: int = 40
    """Newton steps on one set; those that converge mostly do so in ten."""
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
    """Passes that do not halve the misfit, after which a loop counts as endless."""
    aligned: float = 0.999
    """Cosine of two moves along arcs above which one continues the other."""
    slow: float = 0.5
    """Ratio of a move along arcs to the one before, above which the rest is summed as a series:
    below it, the passes themselves converge soon."""
    ahead: float = 1e4
    """Most moves that are added at once: a ratio this close to 1 is hardly known any better."""
    shrink: float = 0.1
    """An open flank's next tangent is taken at this fraction of its last force."""
    singular: float = 1e-12
    """Eigenvalue of a stiffness, over its largest entry, that counts as zero."""
    arrived: float = 1e-13
    """Residual of a pass, relative to the largest force or displacement, that is round-off."""
    condensed: float = 1e-12
    """Least eigenvalue of the scaled stiffness with which coordinates are condensed."""
    still: float = 1e-15
    """Newton step on a set, over the largest coordinate or force, after which no other is made."""
    settled: float = 1e-11
    """The same where steps no longer halve."""
    near: float = 1e-10
    """Last step with which a set counts as solved when the steps are used up."""
    least_force: float = 1e-12
    """Least force, in units of the programme, at which the tangent of a Hertz law is taken."""
    least_offset: float = 1e-9
    """Least offset at which the tangent of a graph without stiffness at its centre is taken."""
    moves: float = 1e-8
    """Part of a unit move in coordinates above which it is a move, not a self-stress."""
    roots: int = 60
    """Most Newton steps for a force of b F + c F^(2/3); about six are taken."""
    root: float = 1e-16
    """Last of these steps, relative."""
    many_roots: float = 1e-15
    """The same for many contacts at once, so that none goes to and fro for its last digit."""
    straight: float = 1e-14
    """Relative deviation of a table's points from a line that digits explain."""
    least_step: float = 1e-3
    """Part of a step below which it is taken even if the energy rises."""
    faint: float = 1e-18
    """Least force, over the unit of force, at which a law is linearised."""
    of_gaps: float = 1e-3
    """Least unit of length, over the largest gap, under light loads."""
    least_length: float = 1e-6
    """Unit of length [m] where no flank drives."""
    pulls: tuple[float, ...] = (*[1e-5] * 8, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, *[1e-11] * 7)
    """ε of every proximal pass, in units of the programme (a flank's compliance is about 1). A pass
    moves a coordinate by load/ε at most, so a wide gap under a light load needs a weak pull."""


LAWS = Laws()
CONTACT = Contact()
