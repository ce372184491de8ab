"""The least-norm displacement where an equilibrium leaves some of it undetermined.

Torques and forces are unique; displacements need not be: a float with play and no load, a gear that
no loaded flank touches. The displacements of one equilibrium then form a convex set: those that
change no force and close no open contact. Of these the one of least norm is returned, and the
coordinates that the set leaves free are named. Source: formulation, section 4.
"""

from __future__ import annotations

import numpy as np

from loadshare.scene.programme import Array
from loadshare.scene.scene import Scene
from loadshare.train.radial import RadialLaw

CARRIES = 1e-12
"""Force, over the largest of the scene, from which on a contact ties displacements."""
ROOM = 1e-12
"""Overlap, relative to the largest gap, that counts as round-off."""
RANK = 1e-13
"""Singular values below this, relative to the largest, count as zero."""


def least_norm(
    scene: Scene,
    x: Array,
    forces: dict[str, float],
    radial_forces: dict[str, Array],
    laws: dict[str, RadialLaw],
) -> tuple[Array, tuple[str, ...]]:
    """Move an equilibrium's coordinates to the least-norm point that keeps every force.

    Parameters
    ----------
    scene : Scene
    x : ndarray, shape (n,)
        Coordinates [m].
    forces : dict of row name to float
        [N].
    radial_forces : dict of radial name to ndarray, shape (2,)
        [N].
    laws : dict of radial name to RadialLaw

    Returns
    -------
    ndarray, shape (n,)
        [m].
    tuple of str
        Names of the undetermined coordinates.
    """
    largest = max([scene.force_unit(), *(abs(f) for f in forces.values())])
    unit, length = scene.force_unit() / scene.length_unit(), scene.length_unit()
    ties = [scene.stiffness / unit]
    open_rows: list[Array] = []
    bounds: list[float] = []
    for row in scene.rows_at(x):
        if abs(forces.get(row.name, 0.0)) > CARRIES * largest:
            ties.append(row.vector[None, :])
        else:
            open_rows.append(row.vector)
            bounds.append((row.gap - float(row.vector @ x)) / length)
    for radial in scene.radials:
        first = laws[radial.name].pieces[0]
        held = first.stiffness > 0.0 or first.force > 0.0
        if held or np.linalg.norm(radial_forces[radial.name]) > CARRIES * largest:
            ties.append(radial.matrix)
    tied = np.vstack(ties)
    _, sizes, right = np.linalg.svd(tied, full_matrices=True)
    rank = int((sizes > RANK * sizes.max(initial=0.0)).sum())
    free = right[rank:].T
    if free.shape[1] == 0:
        return x, ()
    undetermined = tuple(
        name
        for name, move in zip(scene.coordinates, free, strict=True)
        if np.abs(move).max() > 1e-6
    )
    start = free.T @ x / length
    room = np.maximum(np.array(bounds), 0.0)
    limits = np.array(open_rows).reshape(len(room), scene.size) @ free
    move = -start
    if len(room) and (limits @ move > room).any():
        nearest = _nearest_in(limits, room + limits @ start)
        move = np.zeros_like(start) if nearest is None else nearest - start
    return _inside_discs(scene, x, free @ move * length, laws), undetermined


def _nearest_in(limits: Array, bounds: Array) -> Array | None:
    """Least-norm u with `limits` u ≤ `bounds`, by non-negative least squares (Lawson, Hanson).

    None if round-off leaves no such u.
    """
    from scipy.optimize import nnls

    scale = float(np.abs(bounds).max()) or 1.0
    columns = np.vstack([-limits.T, -bounds[None, :] / scale])
    target = np.zeros(len(columns))
    target[-1] = 1.0
    weights, _ = nnls(columns, target)
    residual = columns @ weights - target
    if residual[-1] == 0.0:
        return None
    nearest = -scale * residual[:-1] / residual[-1]
    return nearest if (limits @ nearest <= bounds + ROOM * scale).all() else None


def _inside_discs(scene: Scene, x: Array, move: Array, laws: dict[str, RadialLaw]) -> Array:
    """Take as much of the move as keeps every idle radial element on the piece where it stands."""
    share = 1.0
    for radial in scene.radials:
        reach = laws[radial.name].pieces[0].length
        before, along = radial.matrix @ x - radial.centre, radial.matrix @ move
        inside = float(np.linalg.norm(before + along)) <= reach
        if inside or not along.any():
            continue
        a, b = float(along @ along), float(before @ along)
        c = float(before @ before) - reach**2
        root = (-b + np.sqrt(max(b * b - a * c, 0.0))) / a
        share = min(share, max(float(root), 0.0))
    return x + share * move
