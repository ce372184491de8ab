"""The whole report of a result."""

from __future__ import annotations

from rich.console import Console

from loadshare.cli.refusal import ranges
from loadshare.cli.tables.certificate import print_certificate
from loadshare.cli.tables.floats import print_floats
from loadshare.cli.tables.omega import print_omega
from loadshare.cli.tables.sharing import print_sharing
from loadshare.cli.tables.validity import print_validity
from loadshare.results import Result


def print_result(console: Console, result: Result, wanted: int) -> None:
    """Print load sharing, coefficients, floats, displacements and the certificate.

    Parameters
    ----------
    console : Console
    result : Result
        Of what was certified.
    wanted : int
        Number of positions that were asked for.
    """
    certified = [p.position for p in result.positions]
    if len(certified) < wanted:
        console.print(f"What follows holds for the certified positions only: {ranges(certified)}")
    print_sharing(console, result)
    print_omega(console, result)
    print_floats(console, result)
    print_validity(console, result)
    print_certificate(console, result, wanted)
