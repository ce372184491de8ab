"""The certificate of claims side by side, compiled with Numba, for `batch`.

`of` is the train as columns, `here` the situations, `claim` the claims. First the figures of every
claim are written to `found`, and the claim is numbered by the set that acts in it (`claims`); then,
with what `batch` computes for each such `group`, they become bounds (`bounds`). No code is shared
with the certificate of single answers, nor with a solver, so that none of their mistakes is
repeated here.
"""

from loadshare.certify.bound.kernel.bounds import bound_all
from loadshare.certify.bound.kernel.claims import find_all

__all__ = ["bound_all", "find_all"]
