"""The numbers by which solvers, studies and certificates decide: what is small, when to stop.

One table for all packages, a part for each. Every number has its meaning next to it and, where it
is known, the reason for its size; one that is not a ratio states its unit. Code compiled with them
is compiled again when one changes (`code_cache.py`).
"""

from loadshare.settings.allowed import ALLOWED
from loadshare.settings.certificate import BOUND, CERTIFY
from loadshare.settings.contact import CONTACT, LAWS
from loadshare.settings.explore import EXPLORE
from loadshare.settings.hot import EXCHANGE, HOT, RULE, SEARCH, SIDE_BY_SIDE, STATICS
from loadshare.settings.job import JOB
from loadshare.settings.precision import EPS
from loadshare.settings.studies import FIT, FOLLOW, MARCH, SENSITIVITY, TOLERANCE
from loadshare.settings.teeth import TEETH
from loadshare.settings.undetermined import PLACES

__all__ = [
    "ALLOWED",
    "BOUND",
    "CERTIFY",
    "CONTACT",
    "EPS",
    "EXCHANGE",
    "EXPLORE",
    "FIT",
    "FOLLOW",
    "HOT",
    "JOB",
    "LAWS",
    "MARCH",
    "PLACES",
    "RULE",
    "SEARCH",
    "SENSITIVITY",
    "SIDE_BY_SIDE",
    "STATICS",
    "TEETH",
    "TOLERANCE",
]
