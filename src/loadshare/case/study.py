"""Studies in a case file, and how inputs scatter in them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Strict, Tag

from loadshare.case.element import (
    NESTED,
    VALUE,
    Count,
    Element,
    Number,
    Positive,
    Rule,
    Steps,
    Turns,
    shaped,
)
from loadshare.settings import ALLOWED

CLASS = "class"
"""Word for a number that follows from the tolerance class of a gear."""
Given: TypeAlias = str | Number
Coefficient = Annotated[float, Strict(), Field(ge=-1, le=1)]

# Which numbers each distribution takes.
NUMBERS: dict[str, tuple[str, ...]] = {
    "normal": ("mean", "deviation"),
    "truncated normal": ("mean", "deviation", "low", "high"),
    "uniform": ("low", "high"),
    "rayleigh": ("scale",),
    "uniform phase": (),
}


class Spread(Element):
    """How an input varies; a star in its key gives each key its own random value."""

    distribution: Literal["normal", "truncated normal", "uniform", "rayleigh", "uniform phase"]
    """Kind: a Rayleigh amount goes with a uniform phase, an angle spread over a whole turn."""

    mean: Given | None = None
    """Normal: mean; truncated normal: mean before it is cut off [unit of the input]."""

    deviation: Given | None = None
    """Normal: standard deviation; truncated normal: before it is cut off [unit of the input]."""

    low: Given | None = None
    """Uniform, truncated normal: lowest value [unit of the input]."""

    high: Given | None = None
    """Uniform, truncated normal: highest value [unit of the input]; "class" for the eccentricity
    that the gear's `tolerance_class` allows, half the runout."""

    scale: Given | None = None
    """Rayleigh: scale σ, the most frequent value [unit of the input]; the mean is 1.2533 σ."""

    def rules(self) -> Iterator[Rule]:
        """Yield numbers that the distribution needs and lacks, or does not take."""
        needed = NUMBERS[self.distribution]
        given = self.given("mean", "deviation", "low", "high", "scale")
        allowed = "distribution", *needed
        yield from _fitting(self, f"{self.distribution} input", needed, given, allowed)


class Group(Element):
    """Inputs that are correlated, by a Gaussian copula."""

    inputs: Annotated[tuple[str, ...], Field(min_length=1)]
    """Keys of the inputs, as given under `inputs`; a star matches any name."""

    correlation: Annotated[
        Annotated[Coefficient, Tag(VALUE)]
        | Annotated[tuple[tuple[Coefficient, ...], ...], Tag(NESTED)],
        shaped("a number between -1 and 1, or a matrix of them as a list of rows"),
    ]
    """Correlation of the normal scores [-]: one for all pairs, or a matrix."""


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
"""The keys that only some kinds of study take."""
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
    """Tolerance: number of samples [-]; 16384 when left out."""

    sampling: Literal["random", "sobol"] | None = None
    """Tolerance: independent draws, or 16 scrambled Sobol sequences; random when left out."""

    limit: Positive | None = None
    """Tolerance: Ω that should not be exceeded [-]."""

    indices: Annotated[int, Strict(), Field(ge=0, le=ALLOWED.samples)] | None = None
    """Tolerance: rows of the design for the shares of variance [-]; 1024 when left out. 0 leaves
    the shares out."""

    quantiles: Annotated[tuple[Level, ...], Field(min_length=1)] | None = None
    """Tolerance: levels of the quantiles [-]; 0.5, 0.9, 0.95, 0.99, 0.999 when left out."""

    positions: Annotated[tuple[Count, ...], Field(min_length=1)] | None = None
    """Positions to solve, from 1 [-]; all when left out."""

    def rules(self) -> Iterator[Rule]:
        """Yield keys that the kind of study needs and lacks, or does not take."""
        needed, possible = KEYS[self.kind]
        given = [key for key in OWN if key in self.model_fields_set]
        allowed = *needed, *possible, "positions"
        yield from _fitting(self, self.kind, needed, given, allowed)


def _fitting(
    element: Element, kind: str, needed: Iterable[str], given: Iterable[str], allowed: Sequence[str]
) -> Iterator[Rule]:
    """Yield keys that an element of some kind needs and lacks, and those that it does not take."""
    for key in needed:
        if getattr(element, key) is None:
            yield Rule("is missing", (key,), hint=f"A {kind} needs it.")
    for key in given:
        if key not in allowed:
            yield Rule(f"does not apply to a {kind}", (key,), ", ".join(allowed))
