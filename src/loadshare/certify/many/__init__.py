"""The certificate of many answers at once: the same figures as `certify`, as arrays.

It is built as the single certificate is, from force vectors on bodies and the train's own approach,
and like it knows of no solver and no scene. Tests hold the two against each other, on right answers
and on wrong ones.
"""

from loadshare.certify.many.judge import Judge
from loadshare.certify.many.verdicts import RESIDUALS, Verdicts

__all__ = ["RESIDUALS", "Judge", "Verdicts"]
