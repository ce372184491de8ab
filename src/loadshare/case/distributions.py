"""How inputs scatter in a tolerance study, as a case file may say it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Strict, Tag

from loadshare.case.element import NESTED, VALUE, Element, Number, Rule, shaped

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
    """Kind: a Rayleigh amount goes with a uniform phase, which is an angle over a whole turn."""

    mean: Given | None = None
    """Normal: mean; truncated normal: mean before it is cut off [unit of the input]."""

    deviation: Given | None = None
    """Normal: standard deviation; truncated normal: before it is cut off [unit of the input]."""

    low: Given | None = None
    """Uniform, truncated normal: lowest value [unit of the input]."""

    high: Given | None = None
    """Uniform, truncated normal: highest value [unit of the input]; "class" for the eccentricity
    that the gear's `tolerance_class` allows, half of the runout."""

    scale: Given | None = None
    """Rayleigh: scale σ, the most frequent value [unit of the input]; the mean is 1.2533 σ."""

    def rules(self) -> Iterator[Rule]:
        """Yield numbers that the distribution lacks, or does not know."""
        needed = NUMBERS[self.distribution]
        for key in needed:
            if getattr(self, key) is None:
                yield Rule("is missing", (key,), hint=f"A {self.distribution} input needs it.")
        for key in self.given("mean", "deviation", "low", "high", "scale"):
            if key not in needed:
                allowed = ", ".join(("distribution", *needed))
                yield Rule(f"does not apply to a {self.distribution} input", (key,), allowed)


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
