"""The peers: other solvers of the same equilibrium, one per file, all given the same data."""

from __future__ import annotations

from benchmarks.peers.peer import Entry, Peer

__all__ = ["PEERS", "Entry", "Peer"]

_QP = frozenset({"QP"})
_ALL = frozenset({"QP", "SOCP"})

PEERS: dict[str, Entry] = {
    e.name: e
    for e in (
        Entry(
            "Clarabel, new",
            "clarabel",
            "clarabel_",
            (1e-6, 1e-8, 1e-11),
            _ALL,
            "Newton's loop, a new solver in every pass, presolve off",
        ),
        Entry(
            "Clarabel, update",
            "clarabel",
            "clarabel_update",
            (1e-6, 1e-8, 1e-11),
            _ALL,
            "Newton's loop, one solver updated with q, A, b",
        ),
        Entry(
            "Clarabel, Picard",
            "clarabel",
            "clarabel_picard",
            (1e-6, 1e-8, 1e-11),
            _ALL,
            "Picard's loop, one solver updated with q, A, b",
        ),
        Entry(
            "power cone",
            "clarabel",
            "power_cone",
            (1e-6, 1e-8, 1e-11),
            _ALL,
            "Clarabel with exact power cones for c T^(5/3); passes for ring faces only",
        ),
        Entry(
            "OSQP",
            "osqp",
            "osqp_",
            (1e-4, 1e-6, 1e-9),
            _QP,
            "Newton's loop, update, warm start, polish",
        ),
        Entry("PIQP", "piqp", "piqp_", (1e-6, 1e-9, 1e-12), _QP, "Newton's loop, update"),
        Entry(
            "DAQP",
            "daqp",
            "daqp_",
            (1e-6, 1e-9, 1e-12),
            _QP,
            "Newton's loop, force form (positive definite), update, warm active set",
        ),
        Entry(
            "Clarabel, update, reduced",
            "clarabel",
            "clarabel_update",
            (1e-6, 1e-8, 1e-11),
            _ALL,
            "the same on the reduced problem",
            reduced=True,
        ),
        Entry(
            "DAQP, reduced",
            "daqp",
            "daqp_reduced",
            (1e-6, 1e-9, 1e-12),
            _QP,
            "the same on the reduced problem in its redundants: the equations eliminated as well",
            reduced=True,
        ),
        Entry(
            "moreau",
            "moreau",
            "moreau_",
            (1e-6, 1e-8, 1e-11),
            _ALL,
            "whole batches in step, Newton's loop, CPU",
        ),
        Entry(
            "CVXPY, rebuilt",
            "cvxpy",
            "cvxpy_rebuilt",
            (1e-8, 1e-11),
            _ALL,
            "Newton's loop, the problem written anew in every pass, Clarabel underneath",
            slow=True,
        ),
        Entry(
            "CVXPY, parameters",
            "cvxpy",
            "cvxpy_parameters",
            (1e-8, 1e-11),
            _ALL,
            "Newton's loop, compiled once (DPP), Clarabel underneath",
            slow=True,
        ),
        Entry(
            "SLSQP",
            "scipy",
            "slsqp",
            (1e-8, 1e-12, 1e-16),
            _ALL,
            "SciPy, energy of displacements with its gradient, no outer loop",
            slow=True,
        ),
        Entry(
            "trust-constr",
            "scipy",
            "trust_constr",
            (1e-4, 1e-8),
            _ALL,
            "SciPy, energy of displacements with its gradient, BFGS",
            slow=True,
        ),
        Entry(
            "trial states",
            "numpy",
            "trial_states",
            (1e-6, 1e-9, 1e-12),
            _ALL,
            "the literature's way: displacement iteration with trial contact states",
        ),
    )
}
"""All peers by name."""
