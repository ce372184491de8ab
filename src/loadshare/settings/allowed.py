"""Limits on what a case file may hold."""

from __future__ import annotations

from typing import NamedTuple


class Allowed(NamedTuple):
    """Limits on a case file: far more than any machine needs, and no more than can be read."""

    bytes: int = 4 * 2**20
    """Size of a file: read in five seconds, whatever is in it."""
    other_bytes: int = 16 * 2**20
    """Size of another program's file: a gear unit, a workbook."""
    result_bytes: int = 2**30
    """Size of a file that holds a result."""
    files: int = 20
    """Files that extend one another."""
    depth: int = 20
    """Tables and lists within one another."""
    elements: int = 1000
    """Elements of a section. Checks look at pairs of them, and a train of 64 branches has 200."""
    entries: int = 10_000
    """Entries of a table, and of a list that names keys."""
    cells: int = 20_000_000
    """Cells of a sheet, empty ones included: programs fill columns down to row 1,048,576."""
    problems: int = 1000
    """Problems of a case that are reported."""
    options: int = 200
    """Names among which the nearest one to a misspelt name is looked for."""
    name: int = 200
    """Characters of a name."""
    file_name: int = 255
    """Characters of the name of a file, as file systems allow."""
    unit: int = 60
    """Characters of a unit."""
    power: float = 12.0
    """Exponent in a unit."""
    smallest: float = 1e-40
    """Number other than zero, in SI units: its cube is still a double."""
    largest: float = 1e40
    """Number in SI units: likewise."""
    length: float = 1e4
    """Length [m]: a longer one was meant in millimetres and written in megametres."""
    friction: float = 1e3
    """Coefficient of friction [-]."""
    teeth: int = 100_000
    """Teeth of a gear."""
    shape: float = 1e3
    """Size of a number without a unit that shapes teeth, such as a shift in modules."""
    positions: int = 100_000
    """Positions of a mesh cycle."""
    line_points: int = 500
    """Points on a contact line: its matrices grow with their square, to a gigabyte here."""
    common: int = 20_000
    """Positions over the common period of all meshes, each of which keeps its answer."""
    steps: int = 1_000_000
    """Steps of a march."""
    points: int = 20_000
    """Points of a sweep, each of which keeps its result."""
    revolutions: float = 1e6
    """Revolutions of a march: beyond, the angle itself is rounded too coarsely."""
    samples: int = 1_000_000_000
    """Samples of a study."""


ALLOWED = Allowed()
