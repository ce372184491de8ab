"""How the train runs: its load, its march through the mesh cycle, its stages."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from loadshare.case.element import (
    Element,
    PerPosition,
    Positions,
    Rule,
    Steps,
    Turns,
    values,
)
from loadshare.case.quantity import (
    ANGULAR_SPEED,
    Acceleration,
    Expansion,
    Force,
    Power,
    Quantity,
    Temperature,
    Torque,
)


class Operating(Element):
    """Where the power enters and leaves, and how much of it."""

    input: str
    """Gear at which the torque enters."""

    output: str
    """Gear at which the torque leaves."""

    running: Literal["counter-clockwise", "clockwise"] = "counter-clockwise"
    """Sense of rotation of the input gear, seen with its axis pointing at the viewer."""

    torque: PerPosition[Torque] | None = None
    """Input torque [torque], one value or one per position; negative where the input brakes."""

    power: PerPosition[Power] | None = None
    """Input power [power], one value or one per position; goes with `speed`."""

    speed: Annotated[Quantity, ANGULAR_SPEED.bounded(above=0)] | None = None
    """Speed of the input gear [angle/time]."""

    positions: Positions = 1
    """Number of meshing positions in a mesh cycle [-]."""

    cycle: Literal["pitch", "common"] = "pitch"
    """Range of the positions: one pitch, with all meshes in step, or their common period.

    Over the common period each mesh is at its own point of its cycle, by tooth numbers and speeds;
    the fastest has `positions` positions in each of its cycles. A march has its own positions.
    """

    phases: Literal["together", "layout"] = "together"
    """Point of its cycle at which each mesh is at the first position.

    together: all at the first position of their laws. layout: each where its teeth are, by tooth
    numbers and centres; the first position of a law is then that of contact at the pitch point.
    """

    rotation: Literal["teeth", "neglected"] = "teeth"
    """How far gears turn over a mesh cycle: by their `teeth`, or not at all.

    One cycle is one tooth of the input gear or, if its tooth number is unknown, of the gear nearest
    to it whose number is known (of several, the one whose name comes first). If neglected,
    eccentricities keep their direction at the first position. A march always turns the gears.
    """

    external: dict[str, Torque] = Field(default_factory=dict)
    """Additional torques on gears [torque], positive in the gear's sense of rotation; none on the
    output or on a held gear."""

    forces: dict[str, Annotated[tuple[Force, ...], Field(min_length=2, max_length=3)]] = Field(
        default_factory=dict
    )
    """Additional forces on the centres of gears, fixed in the housing: x, y and z [force]."""

    gravity: Annotated[tuple[Acceleration, ...], Field(min_length=2, max_length=3)] | None = None
    """Gravity, in the direction of its pull: x, y and z [acceleration]; every gear then needs a
    mass."""

    temperature: Temperature | None = None
    """Rise of the housing's temperature above that at which it was made [temperature]."""

    expansion: Expansion | None = None
    """Thermal expansion of the housing; that of steel when left out [1/temperature]."""

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on torque, power, speed, input and output."""
        allowed = "torque, or power and speed"
        if self.torque is not None and self.power is not None:
            yield Rule.exclusive("power", "torque", allowed)
        elif self.power is not None and self.speed is None:
            yield Rule.required("speed", "power", ANGULAR_SPEED.allowed)
        elif self.torque is None and self.power is None:
            yield Rule("has no load", allowed=allowed)
        for key in ("torque", "power") if self.cycle == "common" else ():
            if isinstance(getattr(self, key), tuple):
                hint = (
                    'Over the common period of all meshes (cycle = "common") the load is one value.'
                )
                yield Rule("is a list", (key,), "one value", hint)
        if self.input == self.output:
            yield Rule("is the input as well", ("output",), "another gear")

    @property
    def input_torque(self) -> tuple[float, ...]:
        """Input torque [N·m], one value or one per position."""
        if self.torque is not None:
            return values(self.torque)
        if self.power is None or self.speed is None:
            raise ValueError("an operating point without a load")
        speed = self.speed.si
        return tuple(power / speed for power in values(self.power))


class March(Element):
    """A march through the rotation of one gear, for errors that turn with their gears."""

    gear: str
    """Gear whose revolutions are counted."""

    revolutions: Turns
    """How far to march [revolutions]."""

    steps: Steps
    """Number of steps [-]."""


class Stage(Element):
    """A set of meshes over which load sharing is counted."""

    meshes: Annotated[tuple[str, ...], Field(min_length=1)]
    """Meshes of the stage, one per branch."""

    groups: tuple[Annotated[tuple[str, ...], Field(min_length=1)], ...] | None = None
    """Meshes that share one torque, as lists; all of the stage when left out."""
