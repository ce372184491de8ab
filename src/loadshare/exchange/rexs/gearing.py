"""Assignments in a REXS model: gears to shafts, planets to carriers, couplings to parts."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from loadshare.case.place import Vector, dot
from loadshare.exchange.rexs.model import (
    BEARINGS,
    COUPLINGS,
    FIXED,
    GEARS,
    Component,
    Model,
    may_turn,
    transmits,
)
from loadshare.exchange.rexs.places import Places, ahead

Stage = tuple[Component, Component, Component]
"""A stage and both its gears."""


def loose_stages(
    stages: list[Stage], shaft_of: Mapping[str, Component], held: set[str], opened: set[str]
) -> list[Stage]:
    """Return the meshes of gears that turn loose on open couplings; they carry no load.

    Parameters
    ----------
    stages : list of (Component, Component, Component)
    shaft_of : mapping of str to Component
        Shaft of every gear, by id.
    held : set of str
        Ids of shafts and gears on which something other than meshes exerts torque.
    opened : set of str
        Ids of the shafts at open couplings.
    """
    left, opened = list(stages), set(opened)
    loose: list[Stage] = []
    while True:
        ends = [gear for stage in left for gear in stage[1:]]
        shafts = Counter(shaft_of[gear.id].id for gear in ends if gear.id in shaft_of)
        free = {
            gear.id
            for gear in ends
            if gear.id in shaft_of
            and gear.id not in held
            and (shaft := shaft_of[gear.id].id) in opened - held
            and shafts[shaft] == 1
        }
        found = [stage for stage in left if {stage[1].id, stage[2].id} & free]
        if not found:
            return loose
        loose += found
        left = [stage for stage in left if stage not in found]
        # What drove only a loose gear is loose itself.
        opened |= {shaft_of[g.id].id for stage in found for g in stage[1:] if g.id in shaft_of}


def _both(stage: Stage) -> frozenset[str]:
    """Return the ids of both gears of a stage."""
    return frozenset(gear.id for gear in stage[1:])


class Joint(NamedTuple):
    """A bearing or coupling, a shaft on one side ("inner" or "outer"), and what is on the other."""

    part: Component
    side: str
    shaft: Component
    other: Component


@dataclass(frozen=True)
class Gearing:
    """A model as gears, carriers and shafts.

    Attributes
    ----------
    model : Model
    """

    model: Model

    @cached_property
    def places(self) -> Places:
        """Places of components."""
        return Places(self.model)

    @cached_property
    def stages(self) -> list[Stage]:
        """Meshes that carry load: stage, and both gears."""
        return [stage for stage in self._pairs if stage not in self.loose]

    @cached_property
    def loose(self) -> list[Stage]:
        """Meshes of gears that turn loose."""
        pairs = self.model.parts
        held = {
            shaft.id for coupling, *both in self.coupled if transmits(coupling) for shaft in both
        }
        held |= {shaft.id for shaft, load in pairs if may_turn(load)}
        held |= {part.id for whole, part in pairs if whole.type == "planet_carrier"}
        held |= {g.id for whole, g in pairs if whole.type in FIXED and g.type in GEARS}
        held |= {*self._on_carriers("planet_shaft"), *self._on_carriers("planet_carrier_shaft")}
        opened = {
            shaft.id
            for coupling, *both in self.joined(*COUPLINGS)
            if not self.is_engaged(coupling)
            for shaft in both
        }
        return loose_stages(self._pairs, self.shaft_of, held, opened)

    @cached_property
    def _pairs(self) -> list[Stage]:
        return list(self._by_gears[0].values())

    @property
    def repeated(self) -> list[tuple[Stage, Stage]]:
        """Stages of two gears that mesh already, each with the first stage of the same gears."""
        first, further = self._by_gears
        return [(stage, first[_both(stage)]) for stage in further]

    @cached_property
    def _by_gears(self) -> tuple[dict[frozenset[str], Stage], list[Stage]]:
        """The first stage of each pair of gears, by their ids, and all further ones."""
        first: dict[frozenset[str], Stage] = {}
        further: list[Stage] = []
        for stage, one, other in self.model.related("stage", "stage", "gear_1", "gear_2"):
            if one.type in GEARS and other.type in GEARS and one is not other:
                each = (stage, one, other)
                if first.setdefault(_both(each), each) is not each:
                    further.append(each)
        return first, further

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
        return {part.id: whole for whole, part in self.model.parts if whole.type == "shaft"}

    @cached_property
    def carriers_of_stages(self) -> dict[str, Component]:
        """Carrier of every planetary stage, by id of the stage."""
        return {
            whole.id: part
            for whole, part in self.model.parts
            if whole.type == "planetary_stage" and part.type == "planet_carrier"
        }

    def _on_carriers(self, relation: str) -> dict[str, Component]:
        """Return the carriers of shafts that a relation gives to planetary stages, by shaft id."""
        of_stage = self.carriers_of_stages
        related = self.model.related(relation, "planetary_stage", "shaft")
        return {shaft.id: of_stage[stage.id] for stage, shaft in related if stage.id in of_stage}

    @cached_property
    def carrier_of(self) -> dict[str, Component]:
        """Carrier of every planet, by id of its gear."""
        shafts = self._on_carriers("planet_shaft")
        return {
            gear.id: shafts[self.shaft_of[gear.id].id]
            for gear in self.gears
            if gear.id in self.shaft_of and self.shaft_of[gear.id].id in shafts
        }

    @cached_property
    def pins(self) -> set[str]:
        """Ids of the shafts on which planets sit: as the file says, or by their bearings.

        A shaft that is part of a carrier and bears several planets is no pin, but the carrier's
        shaft.
        """
        found = {s.id for _, s in self.model.related("planet_pin", "planetary_stage", "shaft")}
        riders = {self.shaft_of[planet].id for planet in self.carrier_of}
        geared = {self.shaft_of[g.id].id for g in self.gears if g.id in self.shaft_of}
        others = geared | set(self._on_carriers("planet_carrier_shaft"))
        borne: dict[str, set[str]] = {}
        for _, *both in self.joined(*BEARINGS):
            for pin, rider in (both, both[::-1]):
                if rider.id in riders and pin.type == "shaft" and pin.id not in others:
                    borne.setdefault(pin.id, set()).add(rider.id)
        own = self._parts_of_carriers
        return found | {pin for pin, ones in borne.items() if pin not in own or len(ones) == 1}

    @cached_property
    def _parts_of_carriers(self) -> dict[str, Component]:
        """Carriers that have a shaft as a part, by id of the shaft."""
        return {
            part.id: whole
            for whole, part in self.model.parts
            if whole.type == "planet_carrier" and part.type == "shaft"
        }

    @cached_property
    def carrier_shafts(self) -> dict[str, Component]:
        """Carrier to which a shaft belongs, by id of the shaft."""
        found = self._parts_of_carriers | self._on_carriers("planet_carrier_shaft")
        return {id_: c for id_, c in found.items() if id_ not in self.pins and c in self.carriers}

    def parts_of(self, carrier: Component) -> set[str]:
        """Return the ids of a carrier, its shafts and all side plates, which belong to carriers."""
        shafts = {id_ for id_, whole in self.carrier_shafts.items() if whole is carrier}
        return {carrier.id, *shafts, *(plate.id for plate in self.model.of_type("side_plate"))}

    @cached_property
    def casing(self) -> set[str]:
        """Ids of components that stand still."""
        return {c.id for c in self.model.of_type(*FIXED)}

    # Places ---------------------------------------------------------------------------------------

    def on_shaft(self, shaft: Component) -> list[tuple[float, str]]:
        """Return the gears on a shaft, and its carrier if any: places along it [m] and names."""
        return self._bodies.get(shaft.id, [])

    @cached_property
    def _bodies(self) -> dict[str, list[tuple[float, str]]]:
        """Places along shafts [m] and names of bodies, by id of the shaft."""
        found: dict[str, list[tuple[float, str]]] = {}
        for gear in self.gears:
            if gear.id in self.shaft_of:
                body = self.along(gear), self.names[gear.id]
                found.setdefault(self.shaft_of[gear.id].id, []).append(body)
        for id_, carrier in self.carrier_shafts.items():
            place, _ = self.joint(self.model.components[id_])
            found.setdefault(id_, []).append((place, self.names[carrier.id]))
        return {id_: sorted(bodies) for id_, bodies in found.items()}

    def along(self, gear: Component) -> float:
        """Return the place of a gear's middle along its shaft [m]."""
        shaft = self.shaft_of.get(gear.id)
        return (self.places.along(gear, shaft) if shaft is not None else None) or 0.0

    def joint(self, shaft: Component) -> tuple[float, Component | None]:
        """Return where along a carrier's shaft its torque acts [m], and the coupling there, if any.

        Without a coupling to a side plate it is the place along the shaft nearest to the planets.
        """
        carrier = self.carrier_shafts[shaft.id]
        mates = self.parts_of(carrier) - set(self.carrier_shafts)
        for coupling, inner, outer in self.coupled:
            for mine, other, side in ((inner, outer, "inner"), (outer, inner, "outer")):
                if mine is shaft and other.id in mates and transmits(coupling):
                    return self.places.along(coupling, shaft, side) or 0.0, coupling
        middle, start = self.middle(carrier), self.places.of(shaft)
        if middle is None or start is None:
            return 0.0, None
        ends = [
            end
            for section in self.sections(shaft)
            if (at := section.number("u_coordinate_on_shaft")) is not None
            for end in (at, at + (section.number("length") or 0.0))
        ]
        at = ahead(middle, start, self.places.axis(shaft))
        return (min(max(at, min(ends)), max(ends)) if ends else at), None

    def sections(self, shaft: Component) -> list[Component]:
        """Return the sections of a shaft."""
        parts = (part for whole, part in self.model.parts if whole is shaft)
        return [part for part in parts if part.type == "shaft_section"]

    def nearest(self, shaft: Component, part: Component, side: str = "") -> tuple[str, float]:
        """Return the body on a shaft nearest to a part, and how far ahead of it the part is [m]."""
        at = self.places.along(part, shaft, side) or 0.0
        place, name = min(self.on_shaft(shaft), key=lambda body: abs(body[0] - at))
        return name, at - place

    def middle(self, body: Component) -> Vector | None:
        """Return the middle of a gear, or of the planets of a carrier [m]."""
        if body in self.carriers:
            planets = [g for g in self.gears if self.carrier_of.get(g.id) is body]
            found = [place for g in planets if (place := self.middle(g)) is not None]
            if not found:
                return None
            x, y, z = (sum(parts) / len(found) for parts in zip(*found, strict=True))
            return (x, y, z)
        place, shaft = self.places.of(body), self.shaft_of.get(body.id)
        if place is None and shaft is not None:
            return self.places.on_axis(shaft, self.along(body))
        return place

    def axis(self, body: Component) -> Vector:
        """Return the direction of a body's axis: its shaft's if that gives one; x if nothing does.

        The shaft comes first, as speeds, torques and places along it refer to its axis.
        """
        planets = [self.model.components[g] for g, c in self.carrier_of.items() if c is body]
        return self.places.axis(*self.shafts_of(body), body, *planets)

    def sense(self, shaft: Component, name: str) -> float:
        """Return 1 if a shaft's axis points as that of a body on it, -1 if it is opposite."""
        body = next(b for b in (*self.gears, *self.carriers) if self.names[b.id] == name)
        return math.copysign(1.0, dot(self.places.axis(shaft, body), self.axis(body)))

    def ahead(self, part: Component, shaft: Component, side: str, body: Component) -> float | None:
        """Return how far a part of a shaft lies ahead of the middle of a body, along its axis [m].

        None if the file does not give enough data for that.
        """
        along = self.places.along(part, shaft, side)
        if along is None:
            return None
        if self.shaft_of.get(body.id) is shaft:
            return along - self.along(body)
        there, here = self.places.on_axis(shaft, along), self.middle(body)
        return None if there is None or here is None else ahead(there, here, self.axis(body))

    def shafts_of(self, body: Component) -> list[Component]:
        """Return the shaft of a gear, or the shafts of a carrier."""
        if body.id in self.shaft_of:
            return [self.shaft_of[body.id]]
        return [self.model.components[s] for s, c in self.carrier_shafts.items() if c is body]

    def flanks(self, gear: Component) -> list[Component]:
        """Return the flanks of a gear."""
        related = self.model.related("flank", "gear", "left", "right")
        return [flank for owner, *both in related if owner is gear for flank in both]

    # Couplings ------------------------------------------------------------------------------------

    def joined(self, *types: str) -> list[tuple[Component, Component, Component]]:
        """Return the bearings or couplings of some types, with the inner and outer part of each."""
        related = self.model.related("side", "assembly", "inner_part", "outer_part")
        return [(part, inner, outer) for part, inner, outer in related if part.type in types]

    @cached_property
    def coupled(self) -> list[tuple[Component, Component, Component]]:
        """Couplings that are engaged, and the inner and outer part of each."""
        return [joint for joint in self.joined(*COUPLINGS) if self.is_engaged(joint[0])]

    @cached_property
    def joints(self) -> dict[str, list[Joint]]:
        """Bearings and engaged couplings at every component, by its id."""
        found: dict[str, list[Joint]] = {}
        for part, inner, outer in (*self.joined(*BEARINGS), *self.coupled):
            found.setdefault(inner.id, []).append(Joint(part, "inner", inner, outer))
            found.setdefault(outer.id, []).append(Joint(part, "outer", outer, inner))
        return found

    def is_engaged(self, coupling: Component) -> bool:
        """Return whether a coupling is engaged in the unit's current gear."""
        given = coupling.attributes.get("is_engaged")
        if isinstance(given, tuple):
            number = self.shift if len(given) > 1 else 1
            return bool(given[number - 1]) if 0 < number <= len(given) else False
        return given is not False

    @cached_property
    def shifts(self) -> int:
        """Number of gears, in the sense of gear shifting, for which couplings give their state."""
        given = [c.attributes.get("is_engaged") for c in self.model.of_type(*COUPLINGS)]
        return max((len(each) for each in given if isinstance(each, tuple)), default=1)

    @cached_property
    def shift(self) -> int:
        """The unit's current gear, in the sense of gear shifting, from 1."""
        given = [unit.number("gear_shift_index") for unit in self.model.of_type("gear_unit")]
        return next((round(number) for number in given if number is not None), 1)
