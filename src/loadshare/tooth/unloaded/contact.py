"""The contact of a pair without load: lines, gaps and curvatures at a meshing position."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.tooth.geometry.body import Array


@dataclass(frozen=True, eq=False)
class ContactLine:
    """One pair of teeth at one meshing position.

    The line is the straight contact line of the plane of action for cylindrical gears, the line
    through the contact ellipse along its major axis where contact is localised.

    Parameters
    ----------
    pair : int
        Index of the pair of teeth. Pair 0 meets at the pitch point at phase 0, and pair k is on
        tooth k of the driver: it meets earlier the larger k is.
    points : array (n, 3)
        Points on the driver's flank, in the middle of n equal parts of the line, fixed frame [m].
    normals : array (n, 3)
        Unit vectors from the driver into the driven tooth.
    length : array (n,)
        Length of line that each point stands for [m]; the sum is the length of the line.
    gap : array (n,)
        Distance of the unloaded flanks along the normal [m] when the driver has the transmission
        error of the position: 0 where the flanks first touch (which need not be one of the
        points), positive elsewhere.
    curvature : array (n,)
        Relative curvature across the line [1/m], positive where the flanks part.
    curvature_along : array (n,)
        Relative curvature along the line [1/m]; 0 for an unmodified cylindrical pair.
    driver_uw, driven_uw : array (n, 2)
        Flank coordinates of the points for `ToothBody.outline`.
    """

    pair: int
    points: Array
    normals: Array
    length: Array
    gap: Array
    curvature: Array
    curvature_along: Array
    driver_uw: Array
    driven_uw: Array


@dataclass(frozen=True, eq=False)
class MeshPosition:
    """All that touches, or nearly touches, at one position of the mesh cycle.

    Parameters
    ----------
    index : int
        Number of the position within the cycle, from 0; 0 for a position asked for on its own.
    phase : float
        0 ≤ phase < 1 of the mesh cycle; the driver turns by one pitch per cycle.
    driver_rotation, driven_rotation : float
        Angles about the gears' own axes [rad]; the driver's includes `transmission_error`.
    transmission_error : float
        Angle by which the driver is ahead of the ideal pair when the first flanks touch, the
        driven gear held where the ideal pair would have it [rad].
    lines : tuple of ContactLine
        Every pair whose line has a part on both active flanks, by rising pair index.
    """

    index: int
    phase: float
    driver_rotation: float
    driven_rotation: float
    transmission_error: float
    lines: tuple[ContactLine, ...]
