"""The sections that a case file may contain, with the type of their elements."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import Any

from pydantic import Field, PrivateAttr

from loadshare.case.element import Element, Text
from loadshare.case.gear_errors import Errors
from loadshare.case.gears import Gear
from loadshare.case.keys import Path, look_up, parse
from loadshare.case.links import Bearing, Ring, Shaft, Spline
from loadshare.case.measured import Measurement
from loadshare.case.meshes import Mesh
from loadshare.case.operation import March, Operating, Stage
from loadshare.case.origin import Origin
from loadshare.case.place import Vector, centres_of
from loadshare.case.study import Study
from loadshare.case.words import as_given
from loadshare.errors import Problem

ABOUT = ("title", "source", "notes", "assumed", "measured", "study")
"""The sections that describe a case but not the machine."""
FLOATS = ("splines", "rings", "bearings")
"""The sections of elements that let a gear float, keyed by gear."""
ENDS = {"meshes": ("driver", "driven"), "shafts": ("ends",)}
"""Keys that name the two gears an element joins; if left out, the element's name gives them."""


class Sections(Element):
    """The sections of a case file, whether complete or only partly readable."""

    _data: Mapping[str, Any] = PrivateAttr()
    _origin: Origin = PrivateAttr()

    title: Text = ""
    """One line that says what the case is."""

    source: Text = ""
    """Where the numbers come from."""

    notes: Text = ""
    """Anything else a reader should know."""

    assumed: tuple[str, ...] = ()
    """Key paths of inputs that are assumptions; a star matches any name."""

    operating: Operating | None = None
    """The operating point: where the power enters and leaves, and how much of it."""

    march: March | None = None
    """A march through the rotation of one gear, for errors that turn with their gears."""

    gears: dict[str, Gear] = Field(default_factory=dict)
    """The gears, by name."""

    meshes: dict[str, Mesh] = Field(default_factory=dict)
    """The meshes; one named a-b joins the driver a to the driven gear b."""

    shafts: dict[str, Shaft] = Field(default_factory=dict)
    """The torsion shafts; one named a-b joins the gears a and b."""

    splines: dict[str, Spline] = Field(default_factory=dict)
    """The clearance splines, by the gear that each carries."""

    rings: dict[str, Ring] = Field(default_factory=dict)
    """The limit rings, by the gear that each surrounds."""

    bearings: dict[str, Bearing] = Field(default_factory=dict)
    """The bearings with radial clearance, by the gear that each holds."""

    errors: dict[str, Errors] = Field(default_factory=dict)
    """The installation and manufacturing errors, by gear."""

    stages: dict[str, Stage] = Field(default_factory=dict)
    """The stages in which load sharing is counted, by name."""

    measured: dict[str, Measurement] = Field(default_factory=dict)
    """What was measured on the machine, by name."""

    study: dict[str, Study] = Field(default_factory=dict)
    """Studies of the case, by name."""

    def floats(self, gear: str) -> bool:
        """Tell whether a spline, ring or bearing lets a gear float whose support is left out."""
        return any(gear in getattr(self, section) for section in FLOATS)

    def centres(self) -> dict[str, Vector]:
        """Return the centres [m] of all gears for which they are given or can be derived."""
        return centres_of(self.gears, self.meshes)

    def outside_problem(self, key: str, named: FilePath) -> Problem | None:
        """Return a problem if the file that a key names must not be read, else None."""
        path = parse(key)
        given = as_given(look_up(self._data, path))
        return self._origin.outside_problem(named, self._origin.of(path), key, given)

    def problem(self, key: str | Path, message: str, allowed: str = "", hint: str = "") -> Problem:
        """Return a problem with a key, including its file and the value given.

        Parameters
        ----------
        key : str or tuple of str or int
            Dotted key path, or its steps.
        message, allowed, hint : str
            As in `Problem`.

        Returns
        -------
        Problem
            The problem, to be raised in a `CaseError`.
        """
        path = parse(key) if isinstance(key, str) else key
        return self._origin.problem(self._data, path, message, allowed, hint)


class Content(Sections):
    """A transmission, how it is loaded, and what is known about these inputs."""

    operating: Operating
    """The operating point: where the power enters and leaves, and how much of it."""

    gears: dict[str, Gear]
    """The gears, by name."""

    meshes: dict[str, Mesh]
    """The meshes; one named a-b joins the driver a to the driven gear b."""
