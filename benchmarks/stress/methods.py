"""The methods on the map: ours, and peers with their own outer loops."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.peers import PEERS, Entry
from benchmarks.peers.form import form_of
from benchmarks.stress.problem import Problem
from benchmarks.stress.verdict import Method, ours
from loadshare.scene import assemble
from loadshare.train import Train
from loadshare.train.equilibrium import Equilibrium

OURS = "ours"
MAPPED = ("Clarabel, new", "power cone", "OSQP", "PIQP", "DAQP", "SLSQP", "trial states")
"""Peers on the map, each at its tightest tolerance; the others differ from these only in speed."""
EVERY = {"SLSQP": 10, "power cone": 4}
"""Slow peers are given only every n-th problem."""


@dataclass(frozen=True, slots=True)
class _AsPeer:
    entry: Entry

    def __call__(self, problem: Problem, train: Train) -> Equilibrium:
        """Answer a problem; a `Failure` carries the peer's own message."""
        form = form_of(assemble(train, 1))
        peer = self.entry.make(self.entry.tolerances[-1])
        peer.prepare(form)
        claim = peer.solve(form)
        return form.equilibrium(claim.x, claim.forces, claim.pulls)


def methods(peers: bool) -> dict[str, tuple[Method, int]]:
    """Return the methods by name, each with n if it is given every n-th problem.

    Parameters
    ----------
    peers : bool
        Whether to include the peers that are installed.
    """
    found: dict[str, tuple[Method, int]] = {OURS: (ours, 1)}
    for name in MAPPED if peers else ():
        if not PEERS[name].missing:
            found[name] = (_AsPeer(PEERS[name]), EVERY.get(name, 1))
    return found
