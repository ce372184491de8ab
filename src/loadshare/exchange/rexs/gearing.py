"""What belongs to what in a REXS model: gears to shafts, planets to carriers, loads to bodies."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from loadshare.exchange.rexs.holding import BEARINGS
from loadshare.exchange.rexs.model import Component, Model

GEARS = ("cylindrical_gear", "ring_gear")
COUPLINGS = ("coupling", "switchable_coupling", "rigid_connection", "involute_spline_connection")
READ = {
    *GEARS,
    *COUPLINGS,
    *BEARINGS,
    "gear_unit",
    "gear_casing",
    "shaft",
    "shaft_section",
    "cylindrical_stage",
    "planetary_stage",
    "planet_carrier",
    "external_load",
    "flank_geometry",
    "cylindrical_gear_flank",
    "stage_gear_data",
    "cylindrical_stage_gear_data",
}
"""Types of components of which something is read, or that hold nothing by themselves."""
LONG = 6
"""References to the place of another component that follow one another."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Gearing:
    """A model as gears, carriers and shafts.

    Attributes
    ----------
    model : Model
    """

    model: Model

    @cached_property
    def stages(self) -> list[tuple[Component, Component, Component]]:
        """Meshes: stage, and both gears."""
        return [
            (stage, one, other)
            for stage, one, other in self.model.related("stage", "stage", "gear_1", "gear_2")
            if one.type in GEARS and other.type in GEARS and one is not other
        ]

    @cached_property
    def gears(self) -> list[Component]:
        """Gears that mesh."""
        return list({g.id: g for stage in self.stages for g in stage[1:]}.values())

    @cached_property
    def carriers(self) -> list[Component]:
        """Carriers that carry planets."""
        return list({c.id: c for c in self.carrier_of.values()}.values())

    @cached_property
    def names(self) -> dict[str, str]:
        """Names in the case, by id."""
        found: dict[str, str] = {}
        bodies = [("gear", g) for g in self.gears] + [("carrier", c) for c in self.carriers]
        for kind, body in bodies:
            name = f"{kind}_{re.sub('[^A-Za-z0-9]', '_', body.id)[:60]}"
            while name in found.values():
                name += "_"
            found[body.id] = name
        return found

    @cached_property
    def shaft_of(self) -> dict[str, Component]:
        """Shaft of every gear, by id."""
        pairs = self.model.related("assembly", "assembly", "part")
        return {part.id: whole for whole, part in pairs if whole.type == "shaft"}

    @cached_property
    def carrier_of(self) -> dict[str, Component]:
        """Carrier of every planet, by id of its gear."""
        carriers = {
            whole.id: part
            for whole, part in self.model.related("assembly", "assembly", "part")
            if whole.type == "planetary_stage" and part.type == "planet_carrier"
        }
        shafts = {
            shaft.id: carriers[stage.id]
            for stage, shaft in self.model.related("planet_shaft", "planetary_stage", "shaft")
            if stage.id in carriers
        }
        found = {}
        for gear in self.gears:
            shaft = self.shaft_of.get(gear.id)
            if shaft is not None and shaft.id in shafts:
                found[gear.id] = shafts[shaft.id]
        return found

    @cached_property
    def carrier_shafts(self) -> dict[str, Component]:
        """Carrier to which a shaft belongs, by id of the shaft."""
        found = {
            part.id: whole
            for whole, part in self.model.related("assembly", "assembly", "part")
            if whole.type == "planet_carrier" and part.type == "shaft"
        }
        pins = {s.id for _, s in self.model.related("planet_pin", "planetary_stage", "shaft")}
        return {id_: c for id_, c in found.items() if id_ not in pins and c in self.carriers}

    def on_shaft(self, shaft: Component) -> list[tuple[float, str]]:
        """Places along a shaft [m] and names of its gears; of a carrier's shaft the carrier."""
        found = [
            (self.along(g), self.names[g.id])
            for g in self.gears
            if self.shaft_of.get(g.id) is shaft
        ]
        carrier = self.carrier_shafts.get(shaft.id)
        if carrier is not None:
            found.append((0.0, self.names[carrier.id]))
        return sorted(found)

    @staticmethod
    def along(gear: Component) -> float:
        """Middle of a gear along its shaft [m]."""
        return (gear.number("u_coordinate_on_shaft") or 0.0) + 0.5 * (
            gear.number("face_width") or 0.0
        )

    def shafts_of(self, body: Component) -> list[Component]:
        """Shaft of a gear, or the shafts of a carrier."""
        if body.id in self.shaft_of:
            return [self.shaft_of[body.id]]
        return [self.model.components[s] for s, c in self.carrier_shafts.items() if c is body]

    def flanks(self, gear: Component) -> list[Component]:
        """Flanks of a gear."""
        related = self.model.related("flank", "gear", "left", "right")
        return [flank for owner, *both in related if owner is gear for flank in both]

    def place(self, body: Component, depth: int = 0) -> Vector | None:
        """Where a component is [m], its reference's place added if that is another's."""
        here, other = body.vector("support_vector"), self._reference(body)
        if here is None or other is None:
            return here
        start = self.place(other, depth + 1) if depth < LONG else None
        if start is None:
            return here
        return (start[0] + here[0], start[1] + here[1], start[2] + here[2])

    def is_referred(self, body: Component) -> bool:
        """Whether a component's position is given relative to another component than the unit."""
        return self._reference(body) is not None

    def _reference(self, body: Component) -> Component | None:
        reference = body.attributes.get("reference_component_for_position")
        number = isinstance(reference, float) and reference.is_integer()
        other = self.model.components.get(f"{reference:.0f}" if number else str(reference))
        return None if other is None or other is body or other.type == "gear_unit" else other

    def axis(self, body: Component) -> Vector:
        """Direction of a body's axis, of length 1; its shaft's, or x, if it gives none."""
        for one in (body, self.shaft_of.get(body.id)):
            axis = one.vector("u_axis_vector") if one is not None else None
            if axis is not None and any(axis):
                # Of a direction the unit says nothing.
                size = math.hypot(*axis)
                return (axis[0] / size, axis[1] / size, axis[2] / size)
        return (1.0, 0.0, 0.0)

    def coupled(self) -> Iterator[tuple[Component, Component, Component]]:
        """Couplings that are engaged, and what they join."""
        sides = self.model.related("side", "assembly", "inner_part", "outer_part")
        for coupling, one, other in sides:
            open_ = coupling.attributes.get("is_engaged") in (False, "false")
            if coupling.type in COUPLINGS and not open_:
                yield coupling, one, other

    def loads(self) -> list[tuple[Component, Component]]:
        """Shafts with gears or carriers, and the loads on them."""
        return [
            (shaft, load)
            for shaft, load in self.model.related("assembly", "assembly", "part")
            if shaft.type == "shaft" and load.type == "external_load" and self.on_shaft(shaft)
        ]
