r"""What a solver sees: a dimensionless convex programme with named rows and cones.

.. math::

    \min_{x,\,y,\,w,\,s} \; & \tfrac12 x^\mathsf{T} H x - f^\mathsf{T} x + \tfrac12 \lVert y\rVert^2
        + \tfrac25 \sum_e c_e^{-3/2} w_e^{5/2} + \sum_{j,i} \bigl(F_{ji} \lVert s_{ji}\rVert +
        \tfrac12 k_{ji} \lVert s_{ji}\rVert^2\bigr) \\
    \text{s.t.} \; & a_e\cdot x - \sqrt{b_e}\, y_e - w_e \le g_e \quad (= g_e \text{ where assumed
    closed})
        \qquad : F_e \\
    & P_j x - m_j = \textstyle\sum_i s_{ji}, \quad \lVert s_{ji}\rVert \le \ell_{ji} \qquad : \Phi_j

y is the square-root-scaled compression of a linear compliance (b = 0 is a rigid contact and needs
no special case), w the Hertz part (only in the power-cone form), s the pieces of a radial graph.
The multiplier of a row is its force. Source: formulation, sections 4 to 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.contact.radial import RadialLaw


@dataclass(frozen=True, slots=True, eq=False)
class Cone:
    """A radial element in play: force along Px − m with the size of `law`."""

    name: str
    matrix: Array
    centre: Array
    law: RadialLaw

    def offset(self, x: Array) -> Array:
        """Return Px − m, shape (2,)."""
        return np.asarray(self.matrix @ x - self.centre)


@dataclass(frozen=True, slots=True, eq=False)
class Programme:
    """A convex programme in the module's form.

    Attributes
    ----------
    coordinates : tuple of str
        Names of the components of x.
    stiffness : ndarray, shape (n, n)
        H.
    load : ndarray, shape (n,)
        f.
    names : tuple of str
        Names of the rows.
    rows : ndarray, shape (m, n)
        a, of unit norm.
    gaps : ndarray, shape (m,)
        g.
    linear : ndarray, shape (m,)
        b; 0 for a rigid contact.
    hertz : ndarray, shape (m,)
        c; zero except in the power-cone form.
    assumed_closed : ndarray of bool, shape (m,)
        Rows taken as bilateral: their sign is verified afterwards.
    cones : tuple of Cone
    """

    coordinates: tuple[str, ...]
    stiffness: Array
    load: Array
    names: tuple[str, ...]
    rows: Array
    gaps: Array
    linear: Array
    hertz: Array
    assumed_closed: Flags
    cones: tuple[Cone, ...]

    @property
    def kind(self) -> str:
        """Class of the programme: "linear", "QP", "SOCP" or "power cone"."""
        if self.hertz.any():
            return "power cone"
        if self.cones:
            return "SOCP"
        return "linear" if bool(self.assumed_closed.all()) else "QP"


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """An answer to a programme, in its dimensionless units.

    Attributes
    ----------
    x : ndarray, shape (n,)
    forces : ndarray, shape (m,)
        Multipliers of the rows.
    cone_forces : ndarray, shape (k, 2)
        Force that each cone exerts against its offset.
    """

    x: Array
    forces: Array
    cone_forces: Array
