"""What is marked as assumed must be there."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.content import ABOUT
from loadshare.case.draft import Draft
from loadshare.case.keys import dotted, parse, walk
from loadshare.case.patterns import covers
from loadshare.case.words import did_you_mean
from loadshare.errors import Problem


def check_assumed_patterns(draft: Draft) -> Iterator[Problem]:
    """Yield patterns of `assumed` that match no key of the case."""
    known = [path for path in walk(draft.data) if path[0] not in ABOUT]
    for number, pattern in enumerate(draft.assumed):
        path = ("assumed", number)
        try:
            wanted = parse(pattern)
        except ValueError:
            yield draft.problem(path, "is not a key path", 'a text such as "gears.*.base_radius"')
            continue
        if not any(covers(wanted, key) for key in known):
            names = [dotted(key) for key in known]
            hint = did_you_mean(pattern, names)
            yield draft.problem(path, "matches no key of the case", hint=hint)
