"""What a case file may say, as one table of elements."""

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
"""The keys that say something about a case and nothing about the machine."""
FLOATS = ("splines", "rings", "bearings")
"""The sections of what lets a gear float, by gear."""
ENDS = {"meshes": ("driver", "driven"), "shafts": ("ends",)}
"""Keys of what joins two gears that tell them; left out, the element's name does."""


class Sections(Element):
    """What a case file may say, as a whole or as far as it could be read."""

    _data: Mapping[str, Any] = PrivateAttr()
    _origin: Origin = PrivateAttr()

    title: Text = ""
    """One line that says what the case is."""

    source: Text = ""
    """Where its numbers come from."""

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
        """Tell whether something lets a gear float that says nothing of its support."""
        return any(gear in getattr(self, section) for section in FLOATS)

    def centres(self) -> dict[str, Vector]:
        """Return the centres of the gears [m], of those for which they are given or follow."""
        return centres_of(self.gears, self.meshes)

    def outside_problem(self, key: str, named: FilePath) -> Problem | None:
        """Return a problem if the file that a key names must not be read, else None."""
        path = parse(key)
        given = as_given(look_up(self._data, path))
        return self._origin.outside_problem(named, self._origin.of(path), key, given)

    def problem(self, key: str | Path, message: str, allowed: str = "", hint: str = "") -> Problem:
        """Return a problem with a key, with its file and what was given.

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
