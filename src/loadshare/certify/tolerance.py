"""The tolerance of a certificate: which values are allowed."""

from __future__ import annotations

from contextlib import suppress
from numbers import Real

from loadshare.settings import CERTIFY


def checked_tolerance(given: object) -> float:
    """Return a tolerance by which a certificate can be judged.

    Parameters
    ----------
    given : object
        What a user asks for.

    Raises
    ------
    ValueError
        If it is not a number above 0 and up to `CERTIFY.largest`.
    """
    if isinstance(given, Real) and not isinstance(given, bool):
        with suppress(OverflowError):
            value = float(given)
            if 0.0 < value <= CERTIFY.largest:
                return value
    raise ValueError(
        f"tolerance {given!r} cannot be used for a certificate; allowed: a number above 0 and up "
        f"to {CERTIFY.largest:g}, such as 1e-9"
    )
