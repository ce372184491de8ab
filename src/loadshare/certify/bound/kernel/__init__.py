"""The certificate of claims side by side, compiled with Numba: what `batch` asks for.

`of` is the train as columns, `here` the situations, `claim` the claims. First every claim is put
into figures, `found`, and numbered by what acts in it (`claims`); then, with what `batch` makes of
each such `group`, they become bounds (`bounds`). Nothing of it is shared with the certificate of
single answers, nor with a solver: what they get wrong must not be wrong here too.
"""

from loadshare.certify.bound.kernel.bounds import bound_all
from loadshare.certify.bound.kernel.claims import find_all

__all__ = ["bound_all", "find_all"]
