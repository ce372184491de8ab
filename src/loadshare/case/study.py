"""Studies of a case, as a case file may hold them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field, Strict

from loadshare.case.distributions import Given, Group, Spread
from loadshare.case.element import Count, Element, Positive, Rule, Steps, Turns
from loadshare.settings import ALLOWED

# What each kind of study needs, and what else it may have.
KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "sweep": (("over",), ()),
    "critical": (("keys", "start", "stop"), ()),
    "sensitivity": ((), ("keys",)),
    "march": ((), ("gear", "revolutions", "steps")),
    "compare": ((), ()),
    "fit": (("unknowns",), ("starts", "seed")),
    "tolerance": (
        ("inputs",),
        ("groups", "samples", "seed", "sampling", "limit", "indices", "quantiles"),
    ),
}
OWN = tuple(dict.fromkeys(key for some in KEYS.values() for keys in some for key in keys))
"""The keys that only some kinds of study know."""
Level = Annotated[float, Strict(), Field(gt=0, lt=1)]


class Study(Element):
    """A question about the case, answered by `loadshare study CASE NAME`."""

    kind: Literal["sweep", "critical", "sensitivity", "march", "compare", "fit", "tolerance"]
    """Kind of study."""

    over: dict[str, str | Annotated[tuple[Given, ...], Field(min_length=1)]] | None = None
    """Sweep: values by key [unit of the key]: a list, or first:last:how many, "0 um:12 um:61"."""

    keys: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """Critical: keys that take the value. Sensitivity: inputs. A star matches any name."""

    start: Given | None = None
    """Critical: where the keys' value starts [unit of the keys]."""

    stop: Given | None = None
    """Critical: where it stops [unit of the keys]."""

    gear: str | None = None
    """March: gear whose revolutions are counted; that of `march` when left out."""

    revolutions: Turns | None = None
    """March: how far [revolutions]."""

    steps: Steps | None = None
    """March: number of steps [-]."""

    unknowns: dict[str, tuple[Given, Given]] | None = None
    """Fit: lowest and highest value by key [unit of the key]."""

    starts: Count = 1
    """Fit: number of starting points [-]."""

    seed: Annotated[int, Strict(), Field(ge=0)] = 0
    """Fit: seed of the further starting points; tolerance: of all samples [-]."""

    inputs: Annotated[dict[str, Spread], Field(min_length=1)] | None = None
    """Tolerance: how inputs vary, by key; a star gives each key its own random value."""

    groups: tuple[Group, ...] | None = None
    """Tolerance: inputs that are correlated."""

    samples: Count | None = None
    """Tolerance: number of samples [-]."""

    sampling: Literal["random", "sobol"] | None = None
    """Tolerance: independent draws, or 16 scrambled Sobol sequences; random when left out."""

    limit: Positive | None = None
    """Tolerance: Ω that should not be exceeded [-]."""

    indices: Annotated[int, Strict(), Field(ge=0, le=ALLOWED.samples)] | None = None
    """Tolerance: rows of the design for the shares of variance [-]; 0 leaves them out."""

    quantiles: Annotated[tuple[Level, ...], Field(min_length=1)] | None = None
    """Tolerance: levels of the quantiles [-]."""

    positions: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    """Positions to solve, from 1 [-]; all when left out."""

    def rules(self) -> Iterator[Rule]:
        """Yield keys that the kind lacks, or does not know."""
        needed, possible = KEYS[self.kind]
        for key in needed:
            if getattr(self, key) is None:
                yield Rule("is missing", (key,), hint=f"A {self.kind} needs it.")
        known = (*needed, *possible)
        for key in OWN:
            if key in self.model_fields_set and key not in known:
                allowed = ", ".join((*known, "positions"))
                yield Rule(f"does not apply to a {self.kind}", (key,), allowed)
