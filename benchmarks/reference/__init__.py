"""The reference: the equilibrium of a train at one position, in 50-digit arithmetic.

It is written from the physics (formulation, sections 1 to 6) and the train alone, without the
scene, the programmes or the solvers of `loadshare`. The active set is found by exchange in double
precision, then settled and checked in 50 digits.
"""

from benchmarks.reference.solve import NoReference, Reference, reference

__all__ = ["NoReference", "Reference", "reference"]
