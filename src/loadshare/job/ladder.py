"""The ladder: what is tried, in order, until an answer is certified."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from loadshare.certify import Certificate, certify
from loadshare.errors import Refused
from loadshare.scene import assemble
from loadshare.scene.scene import Scene
from loadshare.solver import Options, Record, solve_scene
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """A certified equilibrium, and how it was found.

    Attributes
    ----------
    scene : Scene
    equilibrium : Equilibrium
    certificate : Certificate
    record : Record
        Plan, passes of the outer loop, and what was left out.
    rung : str
        Rung of the ladder that answered.
    """

    scene: Scene
    equilibrium: Equilibrium
    certificate: Certificate
    record: Record
    rung: str


def rungs(options: Options) -> Iterator[tuple[str, Options]]:
    """Yield what was asked for, then the whole scene, then the other forms of the loop."""
    yield "as asked", options
    if options.reduce:
        yield "whole scene", replace(options, reduce=False)
    for method in ("newton", "picard", "power"):
        if method != options.method:
            yield f"whole scene, {method}", replace(options, reduce=False, method=method)


def climb(train: Train, index: int, options: Options, tolerance: float) -> Answer:
    """Answer position `index`, climbing until the certificate passes.

    Raises
    ------
    Refused
        If no rung gives a certified answer; the message says what failed at the first rung and
        carries its figures.
    """
    scene = assemble(train, index)
    first: Refused | None = None
    for rung, rung_options in rungs(options):
        try:
            equilibrium, record = solve_scene(scene, rung_options)
        except Refused as refusal:
            first = first or refusal
            continue
        certificate = certify(train, equilibrium, tolerance)
        if certificate.passed:
            return Answer(scene, equilibrium, certificate, record, rung)
        first = first or _uncertified(index, certificate)
        if not options.polish:
            break
    raise first or Refused(f"position {index}: nothing was tried")


def _uncertified(index: int, certificate: Certificate) -> Refused:
    failing = certificate.failing
    told = "; ".join(
        f"{name.replace('_', ' ')} {r.value:.3g} {r.unit} at {r.where} "
        f"({r.scaled:.1e} of the case, allowed {certificate.tolerance:.0e})"
        for name, r in failing.items()
    )
    return Refused(
        f"position {index}: the answer is not an equilibrium: {told}",
        {name: r.scaled for name, r in failing.items()},
    )
