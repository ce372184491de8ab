"""A case from a REXS model: what was taken, what was assumed, what was left out."""

from __future__ import annotations

import math
from collections import Counter, deque
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from loadshare.errors import CaseError, Problem
from loadshare.exchange.imported import Data, Imported, commented
from loadshare.exchange.rexs.checking import unknown_gears, unread_values, unused
from loadshare.exchange.rexs.gearing import BEARINGS, COUPLINGS, READ, Gearing
from loadshare.exchange.rexs.holding import Holding, holding_of
from loadshare.exchange.rexs.links import Links, links_of
from loadshare.exchange.rexs.model import Component
from loadshare.exchange.rexs.places import GEARS, Vector
from loadshare.exchange.rexs.reading import read_model


def import_rexs(path: str | Path) -> Imported:
    """Import a REXS file.

    Parameters
    ----------
    path : str or pathlib.Path
        XML (.rexs), JSON (.rexsj) or an archive with one of them (.rexsz).

    Returns
    -------
    Imported

    Raises
    ------
    CaseError
        If the file cannot be read, or lacks what a case needs: teeth, places, a load.
    """
    path = Path(path)
    return _Importer(path, Gearing(read_model(path))).imported()


@dataclass
class _Importer:
    """A model on its way to a case."""

    path: Path
    of: Gearing
    assumed: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    def imported(self) -> Imported:
        """Return the case."""
        self.assumed += self.of.model.notes
        if problems := unread_values(self.path, self.of) + unknown_gears(self.path, self.of):
            raise CaseError(problems)
        if self.of.shifts > 1:
            self.assumed.append(f"couplings are engaged as in gear {self.of.shift}")
        placed = self.of.model.of_type(*GEARS, *BEARINGS, *COUPLINGS, "planet_carrier", "shaft")
        if any(self.of.places.is_referred(body) for body in placed):
            self.assumed.append("places taken from other components are rotated like these")
        if not self.of.stages:
            self._lacks("", "has no cylindrical stage that joins two gears")
        gears = {self.of.names[g.id]: self._gear(g) for g in self.of.gears}
        gears |= {self.of.names[c.id]: self._carrier(c) for c in self.of.carriers}
        flow = self._flow()
        if self.problems:
            raise CaseError(self.problems)
        assert flow is not None
        first, last, torque, running = flow
        for name in self.links.held:
            gears[name]["held"] = True
        data: Data = {
            "title": f"{self.path.stem}, from REXS {self.of.model.version}",
            "source": f"REXS file {self.path.name}",
            "notes": "; ".join(self._name_notes()),
            "operating": {
                "input": first,
                "output": last,
                "running": running,
                "torque": f"{torque:.12g} N*m",
            },
            "gears": gears,
            "meshes": self._meshes(first),
            "shafts": self.links.shafts,
        }
        if bearings := self._bearings():
            data["bearings"] = bearings
        if errors := self._errors():
            data["errors"] = errors
        data["stages"] = self._stages(data["meshes"])
        data = {key: value for key, value in data.items() if value not in ("", {})}
        self._count_left_out()
        taken = tuple(
            f"{len(part)} {what}"
            for what, part in (
                ("gears", self.of.gears),
                ("carriers", self.of.carriers),
                ("meshes", data["meshes"]),
                ("shafts between gears", data.get("shafts", {})),
                ("bearings with clearance", data.get("bearings", {})),
            )
            if part
        )
        assumed, left = dict.fromkeys(self.assumed), dict.fromkeys(self.left_out)
        text = commented(data, assumed, left)
        return Imported(data, text, taken, tuple(assumed), tuple(left))

    # Bodies ---------------------------------------------------------------------------------------

    def _gear(self, gear: Component) -> Data:
        name = self.of.names[gear.id]
        teeth, module = gear.number("number_of_teeth"), gear.number("normal_module")
        if teeth is None or module is None or not round(abs(teeth)):
            self._lacks(gear, "has no number_of_teeth or normal_module")
            return {}
        made: Data = {"teeth": round(abs(teeth)), "module": _mm(abs(module))}
        if gear.type == "ring_gear" or teeth < 0.0:
            made["type"] = "internal"
        flanks = self.of.flanks(gear)
        shift = _first(
            [gear, *flanks],
            "profile_shift_coefficient",
            "addendum_modification_coefficient",
        )
        if shift is None:
            self.assumed.append(f"{name}: no profile shift is given, 0 is assumed")
        elif shift:
            made["profile_shift"] = shift
        angle = _first([*flanks, gear], "normal_pressure_angle")
        if angle is None:
            self.assumed.append(f"{name}: no pressure angle is given, 20 deg is assumed")
        else:
            made["pressure_angle"] = _deg(angle)
        if helix := gear.number("helix_angle_reference_diameter"):
            made["helix_angle"] = _deg(helix)
        if width := gear.number("face_width"):
            made["face_width"] = _mm(width)
        self.assumed.append("teeth: the rack's addendum is one module, tips are not altered")
        shaft = self.of.shaft_of.get(gear.id)
        if shaft is not None and self.of.places.along(gear, shaft) is None:
            self.assumed.append(f"{name}: at the start of its shaft, no place along it is given")
        made |= self._placed(gear)
        if gear.id in self.of.carrier_of:
            made["carrier"] = self.of.names[self.of.carrier_of[gear.id].id]
        made |= self.holding[gear.id].support
        return made

    def _carrier(self, carrier: Component) -> Data:
        made: Data = {"type": "carrier"}
        bodies = (*self.of.shafts_of(carrier), carrier)
        body = next((b for b in bodies if self.of.places.of(b) is not None), None)
        middle = self.of.middle(carrier)
        planets = [g for g in self.of.gears if self.of.carrier_of.get(g.id) is carrier]
        if body is not None:
            made |= self._placed(body)
        elif middle is not None and len(planets) >= 2:
            made |= {"centre": [_mm(v) for v in middle], "axis": _axis(self.of.axis(planets[0]))}
            self.assumed.append(f"{self.of.names[carrier.id]}: its axis is amid its planets")
        else:
            self._lacks(carrier, "has no place")
        return made | self.holding[carrier.id].support

    def _placed(self, body: Component) -> Data:
        place = self.of.places.of(body)
        if place is None and body in self.of.gears:
            place = self.of.middle(body)
        if place is None:
            self._lacks(body, "has no place: no support_vector of three numbers")
            return {}
        return {"centre": [_mm(v) for v in place], "axis": _axis(self.of.axis(body))}

    @cached_property
    def holding(self) -> dict[str, Holding]:
        """What holds every gear and carrier, by id."""
        return {
            body.id: holding_of(self.of, body, self.assumed)
            for body in (*self.of.gears, *self.of.carriers)
        }

    @cached_property
    def links(self) -> Links:
        """What joins bodies around their axes."""
        return links_of(self.of, self.assumed)

    def _bearings(self) -> Data:
        return {
            self.of.names[id_]: held.clearance
            for id_, held in self.holding.items()
            if held.clearance
        }

    def _errors(self) -> Data:
        return {
            self.of.names[id_]: {"installation": [f"{1e6 * v:.12g} um" for v in held.offset]}
            for id_, held in self.holding.items()
            if any(held.offset)
        }

    # Load and links -----------------------------------------------------------------------------

    def _flow(self) -> tuple[str, str, float, str] | None:
        """Input, output, torque [N·m] and running sense."""
        loads = self.of.loads()
        driving = [(s, e) for s, e in loads if e.number("torque_around_u_axis")]
        driving.sort(key=lambda pair: not pair[1].holds("defines_torque"))
        if not driving:
            self._lacks(
                "", "has no external_load with a torque_around_u_axis on a shaft with gears"
            )
            return None
        shaft, first = driving[0][0], self.of.nearest(*driving[0])[0]
        same = [pair for pair in loads if self._are_one(pair[0], shaft)]
        others = [pair for pair in loads if pair not in same]
        others.sort(key=lambda pair: bool(pair[1].number("torque_around_u_axis")))
        if not others:
            self._lacks("", "has no second shaft with an external_load: the output is not known")
            return None
        torque = sum(
            self.of.places.way(s, shaft) * (e.number("torque_around_u_axis") or 0.0)
            for s, e in same
        )
        if not torque:
            self._lacks(driving[0][1], "is balanced by other loads of its shaft: no torque is left")
            return None
        added = [e for _, e in same if e.number("torque_around_u_axis")]
        if len(added) > 1:
            self.assumed.append(f"{first}: the torques of {len(added)} loads on its shaft, added")
        self.left_out += [
            f"{e.title()}: it is neither on the input nor on the output"
            for s, e in others[1:]
            if not self._are_one(s, others[0][0])
        ]
        speed = shaft.number("rotational_speed") or torque
        running = "counter-clockwise" if speed > 0.0 else "clockwise"
        last = self.of.nearest(*others[0])[0]
        return first, last, torque if speed > 0.0 else -torque, running

    def _are_one(self, shaft: Component, other: Component) -> bool:
        """Whether two shafts are one, or belong to one carrier."""
        carrier = self.of.carrier_shafts.get(shaft.id)
        return shaft is other or (
            carrier is not None and self.of.carrier_shafts.get(other.id) is carrier
        )

    def _meshes(self, first: str) -> Data:
        """Meshes, the driver first as the torque comes from the input."""
        reached = self._reached(first)
        made = {}
        for stage, one, other in self.of.stages:
            names = self.of.names[one.id], self.of.names[other.id]
            forward = reached[names[0]] <= reached[names[1]]
            driver, driven = (one, other) if forward else (other, one)
            law: Data = {"law": "iso"}
            density = stage.number("mesh_stiffness_for_load_distribution_along_face_width")
            width = stage.number("common_face_width") or min(
                one.number("face_width") or 0.0, other.number("face_width") or 0.0
            )
            angle = _first([*self.of.flanks(driver), driver], "normal_pressure_angle")
            radius = _base_radius(driver, angle or math.radians(20.0))
            if density and width and radius:
                law = {"stiffness": f"{density * width * radius**2:.12g} N*m/rad"}
            else:
                self.assumed.append('meshes: their law is "iso", ISO 6336-1 method B')
            made[f"{self.of.names[driver.id]}-{self.of.names[driven.id]}"] = law
        return made

    def _reached(self, first: str) -> dict[str, int]:
        """Steps from the input to every body."""
        links = [[self.of.names[a.id], self.of.names[b.id]] for _, a, b in self.of.stages]
        links += [name.split("-") for name in self.links.shafts]
        steps, queue = {first: 0}, deque([first])
        while queue:
            here = queue.popleft()
            for pair in links:
                if here in pair:
                    other = pair[1] if here == pair[0] else pair[0]
                    if other not in steps:
                        steps[other] = steps[here] + 1
                        queue.append(other)
        return {name: steps.get(name, len(self.of.names)) for name in self.of.names.values()}

    def _stages(self, meshes: Data) -> Data:
        """Where a gear drives, or is driven by, several others: there the load is shared."""
        made = {}
        for side, what in ((0, "from"), (1, "to")):
            ends = Counter(name.split("-")[side] for name in meshes)
            for gear, count in ends.items():
                if count > 1:
                    branches = [name for name in meshes if name.split("-")[side] == gear]
                    made[f"{what}_{gear}"] = {"meshes": branches}
        return made

    # Notes and problems ---------------------------------------------------------------------------

    def _name_notes(self) -> list[str]:
        bodies = [*self.of.gears, *self.of.carriers]
        return [
            f"{self.of.names[b.id]} is {' '.join(b.name.split())[:80]}" for b in bodies if b.name
        ]

    def _count_left_out(self) -> None:
        kinds = Counter(c.type for c in self.of.model.components.values() if c.type not in READ)
        self.left_out += [f"{count} {kind}" for kind, count in sorted(kinds.items())]
        idle = [g for g in self.of.model.of_type(*GEARS) if g.id not in self.of.names]
        self.left_out += [f"gear {g.name or g.id}: it meshes with nothing" for g in idle]
        holding = [id_ for held in self.holding.values() for id_ in held.parts]
        self.left_out += unused(self.of, {*holding, *self.links.used})
        self.left_out.append("axial forces, tilting and bending of shafts: the model is plane")

    def _lacks(self, what: Component | str, message: str) -> None:
        where = what if isinstance(what, str) else f"{what.type} {what.id}"
        self.problems.append(Problem(str(self.path), where, "", message))


def _first(components: list[Component], *names: str) -> float | None:
    found = (component.number(*names) for component in components)
    return next((value for value in found if value is not None), None)


def _base_radius(gear: Component, angle: float) -> float | None:
    """Base radius [m] from teeth."""
    teeth, module = gear.number("number_of_teeth"), gear.number("normal_module")
    helix = gear.number("helix_angle_reference_diameter") or 0.0
    if not teeth or not module or abs(helix) >= 0.5 * math.pi:
        return None
    transverse = math.atan(math.tan(angle) / math.cos(helix))
    return abs(teeth) * abs(module) / (2.0 * math.cos(helix)) * math.cos(transverse)


def _mm(length: float) -> str:
    return f"{1e3 * length:.12g} mm"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.12g} deg"


def _axis(axis: Vector) -> Any:
    for name, unit in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)), ("z", (0.0, 0.0, 1.0))):
        if max(abs(a - b) for a, b in zip(axis, unit, strict=True)) < 1e-12:
            return name
    return list(axis)
