"""The reference: the equilibrium of a train at one position, in 50-digit arithmetic.

Written from the physics (formulation, sections 1 to 6) and the train alone: no scene, no programme,
no solver enters. The active set is found by exchange, first in double precision, then settled and
checked in 50 digits.
"""

from benchmarks.reference.solve import NoReference, Reference, reference

__all__ = ["NoReference", "Reference", "reference"]
