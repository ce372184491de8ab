r"""Planetary sets: how fast every member turns, and which flanks its torque presses.

In a planetary set, meshes link the speeds relative to the carrier c (Willis): the members' own
speeds less the carrier's about their axes. Other meshes link speeds as in a set whose carrier is at
rest, and shafts join equal speeds:

.. math:: \pm r_i (\omega_i - \omega_c) = \pm r_j (\omega_j - \omega_c), \qquad \omega_a = \omega_b,

each along the sense in which the member's rotation is counted, with the signs of `Mesh.senses`.
Written as :math:`C \omega = 0`, the forces and torques f that links transmit balance the load by
the transpose, :math:`C^T f = T`. Source: formulation, section 12.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from loadshare.array_types import Array, Flags, Numbers
from loadshare.train.gear import Gear
from loadshare.train.mesh import running_contact
from loadshare.train.seen import along, seen_from

Ends = tuple[str, str]

LOCKED = 1e-3
"""How far speeds may contradict each other because radii are rounded, over the input's [-]."""
NOISE = 1e-9
"""Share of the largest force, or of the input's speed, that is round-off [-]."""
DRAWS, SPREAD = 32, 2.0
"""Number of draws of the links' stiffnesses, and the decades to either side over which their square
roots are spread: wide enough that a link is almost rigid in some draws, almost absent in others."""


@dataclass(frozen=True, slots=True, eq=False)
class SpeedLinks:
    """The links of a train as rows over the speeds of its members.

    Attributes
    ----------
    gears : mapping of str to Gear
    names : tuple of str
        Meshes, then shafts.
    matrix : ndarray, shape (links, gears)
        C; in base radii [m] for meshes.
    """

    gears: Mapping[str, Gear]
    names: tuple[str, ...]
    matrix: Array

    @classmethod
    def of(
        cls, gears: Mapping[str, Gear], meshes: Mapping[str, Ends], shafts: Mapping[str, Ends]
    ) -> SpeedLinks:
        """Write the links of a train whose senses are settled."""
        order = {name: k for k, name in enumerate(gears)}
        rows = []
        for driver, driven in meshes.values():
            row = np.zeros(len(order))
            _, senses = running_contact(gears, driver, driven)
            for name, sign in ((driver, senses[0]), (driven, -senses[1])):
                row[order[name]] += sign * gears[name].base_radius
            carrier = seen_from(gears, driver, driven)
            if carrier is not None:
                row[order[carrier]] -= sum(
                    row[order[name]] * along(gears[name], gears[carrier])
                    for name in (driver, driven)
                )
            rows.append(row)
        for ends in shafts.values():
            row = np.zeros(len(order))
            row[order[ends[0]]], row[order[ends[1]]] = 1.0, -1.0
            rows.append(row)
        matrix = np.array(rows).reshape(-1, len(order))
        return cls(gears, (*meshes, *shafts), matrix)

    def speeds(self, driving: str) -> tuple[dict[str, float], bool]:
        """Return the speeds over that of the input, and whether they follow from it.

        Raises
        ------
        ValueError
            If the input cannot turn; the message names what holds it.
        """
        names = list(self.gears)
        fixed = [k for k, name in enumerate(names) if self.gears[name].held]
        scale = np.abs(self.matrix).max(axis=1, initial=0.0)[:, None]
        unit = np.eye(len(names))
        matrix = np.concatenate([self.matrix / scale, unit[fixed], unit[[names.index(driving)]]])
        due = np.zeros(len(matrix))
        due[-1] = 1.0
        found, _, rank, _ = np.linalg.lstsq(matrix, due, rcond=1e-9)
        left = np.abs(matrix @ found - due)
        if left.max() > LOCKED:
            # Rows that have no part in the contradiction are satisfied exactly.
            parts = [*self.names, *(f"{names[k]} (held)" for k in fixed)]
            holding = [part for part, off in zip(parts, left[:-1], strict=True) if off > LOCKED**2]
            text = f"{', '.join(holding[:-1])} and {holding[-1]}" if holding[1:] else holding[0]
            raise ValueError(f"cannot turn, the train would lock: {text} hold one another")
        still = np.abs(found) <= NOISE
        speeds = np.where(still, 0.0, found / found[names.index(driving)]).tolist()
        return dict(zip(names, speeds, strict=True)), bool(rank == len(names))

    def pressed(
        self, torques: Mapping[str, ArrayLike], free: Iterable[str]
    ) -> dict[str, tuple[Numbers, Flags]]:
        """Return which flank of every mesh loads press, and whether it may be the other one.

        It may be if statics leaves open how loads are shared, and some stiffnesses of the links
        would press one flank, others the other. Parallel branches that transmit a single load press
        the same flanks however they share it; with several loads, or power that may circulate in a
        loop, this need not be so.

        Parameters
        ----------
        torques : mapping of str to array_like
            External torques [N·m], of one shape.
        free : iterable of str
            Gears that neither the housing nor the load holds.

        Returns
        -------
        dict of str to (ndarray, ndarray)
            1 for drive, −1 for coast, 0 for neither; and whether it may be the other one.
        """
        turning, balance, response = self._statics(free)
        every = np.broadcast_arrays(*(torques.get(name, 0.0) for name in self.gears))
        load = np.stack(every)[turning]
        force = response @ load.reshape(len(turning), -1)
        either = self._either(balance, response, load)
        force[np.abs(force) <= NOISE * np.abs(force).max(axis=0, initial=0.0)] = 0.0
        signs = np.sign(force).astype(np.intp).reshape(-1, *load.shape[1:])
        return dict(zip(self.names, zip(signs, either, strict=True), strict=True))

    def open_to_stiffness(self, free: Iterable[str]) -> dict[str, bool]:
        """Return for every link whether statics leaves its force open, whatever the torques are.

        Parameters
        ----------
        free : iterable of str
            As in `pressed`.
        """
        _, balance, response = self._statics(free)
        return dict(zip(self.names, _idle(balance, response).tolist(), strict=True))

    def _statics(self, free: Iterable[str]) -> tuple[list[int], Array, Array]:
        """Return the gears that turn, their torque balance, its pseudo-inverse (least forces)."""
        order = {name: k for k, name in enumerate(self.gears)}
        turning = [order[name] for name in free]
        balance = self.matrix[:, turning].T
        return turning, balance, np.linalg.pinv(balance, rcond=NOISE).astype(float, copy=False)

    def _either(self, balance: Array, response: Array, load: Array) -> Flags:
        """Return whether links may transmit loads (gears, ...) either way, (links, ...)."""
        either = np.zeros((len(response), *load.shape[1:]), dtype=bool)
        if not _idle(balance, response).any():
            return either
        # At each drawn set of stiffnesses, loads are shared with the least energy.
        root = 10.0 ** np.random.default_rng(0).uniform(-SPREAD, SPREAD, (DRAWS, len(response)))
        drawn = root[:, :, None] * np.linalg.pinv(balance * root[:, None, :], rcond=NOISE)
        force = np.tensordot(drawn, load, 1)
        least = NOISE * np.abs(force).max(axis=1, keepdims=True)
        return np.asarray((force > least).any(axis=0) & (force < -least).any(axis=0))


def _idle(balance: Array, response: Array) -> Flags:
    """Return which links can carry forces in balance without a load: statics leaves these open."""
    left = np.abs(np.eye(len(response)) - response @ balance)
    return np.asarray(left.max(axis=1, initial=0.0) > NOISE)
