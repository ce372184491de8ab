"""Import of a case from a REXS model, with what was taken, assumed and left out."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from loadshare.case.place import Vector
from loadshare.errors import CaseError, Problem
from loadshare.exchange.imported import Data, Imported, commented
from loadshare.exchange.rexs.balance import balanced
from loadshare.exchange.rexs.checking import (
    ON_AXIS,
    beside_axes,
    circular_places,
    contradictions,
    placed,
    shared,
    unclear_couplings,
    unknown_references,
    unplaced,
    unread_values,
    unused,
)
from loadshare.exchange.rexs.flow import flow_of
from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.holding import Holding, holding_of
from loadshare.exchange.rexs.links import Links, links_of
from loadshare.exchange.rexs.meshing import first_number, meshes_of, stages_of
from loadshare.exchange.rexs.model import GEARS, READ, Component
from loadshare.exchange.rexs.quantities import torque_of
from loadshare.exchange.rexs.reading import read_model
from loadshare.input import stem
from loadshare.readable import readable

SHIFTS = ("profile_shift_coefficient", "addendum_modification_coefficient")


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
    """Conversion of a model to a case."""

    path: Path
    of: Gearing
    assumed: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    def imported(self) -> Imported:
        """Return the case."""
        self.assumed += self.of.model.notes
        checks = (unread_values, unclear_couplings, shared, circular_places, contradictions)
        if problems := [each for check in checks for each in check(self.path, self.of)]:
            raise CaseError(problems)
        self.assumed += [*unplaced(self.of), *beside_axes(self.of)]
        if self.of.shifts > 1:
            self.assumed.append(f"couplings are engaged as in gear {self.of.shift}")
        self.assumed += unknown_references(self.of)
        if any(self.of.places.is_referred(body) for body in placed(self.of)):
            self.assumed.append("places taken from other components are rotated like these")
        if not self.of.stages:
            why = "whose gears are engaged" if self.of.loose else "that joins two gears"
            self._lacks("", f"has no cylindrical stage {why}")
        gears = {self.of.names[g.id]: self._gear(g) for g in self.of.gears}
        gears |= {self.of.names[c.id]: self._carrier(c) for c in self.of.carriers}
        flow = flow_of(self.of, self.assumed, self._lacks)
        if self.problems:
            # These relations, which name unknown components, may be why data are missing.
            also = [
                Problem(str(self.path), "", "", note) for note in self.of.model.dangling_relations
            ]
            raise CaseError([*self.problems, *also])
        assert flow is not None
        self.left_out += flow.left_out
        for name in self.links.held:
            gears[name]["held"] = True
        data: Data = {
            "title": f"{stem(self.path)}, from REXS {self.of.model.version}",
            "source": readable(f"REXS file {self.path.name}"),
            "notes": readable("; ".join(self._name_notes())),
            "operating": {
                "input": flow.first,
                "output": flow.last,
                "running": flow.running,
                "torque": torque_of(flow.torque),
            },
            "gears": gears,
            "meshes": meshes_of(self.of, flow.first, self.links, self.assumed),
            "shafts": self.links.shafts,
        }
        if bearings := self._bearings():
            data["bearings"] = bearings
        if errors := self._errors():
            data["errors"] = errors
        data["stages"] = stages_of(self.of, data["meshes"])
        data = {key: value for key, value in data.items() if value not in ("", {})}
        data = balanced(self.of, data, flow, self.assumed, self.left_out)
        self._count_left_out()
        taken = tuple(
            f"{what} ({len(part)})"
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
        made: Data = {"teeth": round(abs(teeth)), "module": _mm(module)}
        if gear.type == "ring_gear" or teeth < 0.0:
            made["type"] = "internal"
        flanks = self.of.flanks(gear)
        shift = self._first_of(gear, [gear, *flanks], *SHIFTS)
        if shift is None:
            self.assumed.append(f"{name}: no profile shift is given; 0 is assumed")
        elif shift:
            made["profile_shift"] = shift
        angle = self._first_of(gear, [*flanks, gear], "normal_pressure_angle")
        if angle is None:
            self.assumed.append(f"{name}: no pressure angle is given; 20 deg is assumed")
        else:
            made["pressure_angle"] = _deg(angle)
        helix = gear.number("helix_angle_reference_diameter")
        if helix is None:
            self.assumed.append(f"{name}: no helix angle is given; 0 is assumed")
        elif helix:
            made["helix_angle"] = _deg(helix)
        if width := gear.number("face_width"):
            made["face_width"] = _mm(width)
        self.assumed.append("teeth: the rack's addendum is one module, and tips are not altered")
        shaft = self.of.shaft_of.get(gear.id)
        if shaft is not None and self.of.places.along(gear, shaft) is None:
            self.assumed.append(f"{name}: at the start of its shaft, as no place along it is given")
        if all(b is None or b.vector("u_axis_vector") is None for b in (shaft, gear)):
            self.assumed.append(f"{name}: no direction of its axis is given; x is assumed")
        if shaft is not None and not self.of.places.are_parallel(gear, shaft):
            self.assumed.append(f"{name}: its axis is that of its shaft, not its own")
        if shaft is not None and (off := self.of.places.off_axis(gear, shaft)) > ON_AXIS:
            self.assumed.append(f"{name}: at its own place, {_mm(off)} off the axis of its shaft")
        made |= self._placed(gear, self.of.middle(gear))
        if gear.id in self.of.carrier_of:
            made["carrier"] = self.of.names[self.of.carrier_of[gear.id].id]
        made |= self.holding[gear.id].support
        return made

    def _first_of(self, gear: Component, given: list[Component], *names: str) -> float | None:
        """Return the first of some numbers of a gear and its flanks; report others that differ."""
        first = first_number(given, *names)
        values = [value for part in given if (value := part.number(*names)) is not None]
        if any(abs(value - values[0]) > 1e-9 for value in values):
            self.assumed.append(
                f"{self.of.names[gear.id]}: {names[0]} has several values; the first is used"
            )
        return first

    def _carrier(self, carrier: Component) -> Data:
        made: Data = {"type": "carrier"}
        bodies = (*self.of.shafts_of(carrier), carrier)
        places = [place for b in bodies if (place := self.of.places.of(b)) is not None]
        middle = self.of.middle(carrier)
        planets = [g for g in self.of.gears if self.of.carrier_of.get(g.id) is carrier]
        if places:
            made |= self._placed(carrier, places[0])
        elif middle is not None and len(planets) >= 2:
            made |= self._placed(carrier, middle)
            self.assumed.append(
                f"{self.of.names[carrier.id]}: its axis is in the middle of its planets"
            )
        else:
            self._lacks(carrier, "has no place")
        return made | self.holding[carrier.id].support

    def _placed(self, body: Component, place: Vector | None) -> Data:
        if place is None:
            self._lacks(body, "has no place: no support_vector of three numbers")
            return {}
        return {"centre": [_mm(v) for v in place], "axis": _axis(self.of.axis(body))}

    @cached_property
    def holding(self) -> dict[str, Holding]:
        """Support of every gear and carrier, by id."""
        return {
            body.id: holding_of(self.of, body, self.assumed)
            for body in (*self.of.gears, *self.of.carriers)
        }

    @cached_property
    def links(self) -> Links:
        """Torsional links between bodies."""
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

    # Notes and problems ---------------------------------------------------------------------------

    def _name_notes(self) -> list[str]:
        bodies = [*self.of.gears, *self.of.carriers]
        return [
            f"{self.of.names[b.id]} is {' '.join(b.name.split())[:80]}" for b in bodies if b.name
        ]

    def _count_left_out(self) -> None:
        kinds = Counter(c.type for c in self.of.model.components.values() if c.type not in READ)
        self.left_out += [f"{count} {kind}" for kind, count in sorted(kinds.items())]
        self.left_out += self.of.model.dangling_relations
        idle = [g for g in self.of.model.of_type(*GEARS) if g.id not in self.of.names]
        self.left_out += [f"gear {g.name or g.id}: none of its meshes carries load" for g in idle]
        holding = [id_ for held in self.holding.values() for id_ in held.parts]
        self.left_out += unused(self.of, {*holding, *self.links.used})
        self.left_out.append("axial forces, tilting and bending of shafts: the model is plane")

    def _lacks(self, what: Component | str, message: str) -> None:
        where = what if isinstance(what, str) else f"{what.type} {what.id}"
        self.problems.append(Problem(str(self.path), where, "", message))


def _mm(length: float) -> str:
    return f"{1e3 * length:.12g} mm"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.12g} deg"


def _axis(axis: Vector) -> Any:
    for name, unit in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)), ("z", (0.0, 0.0, 1.0))):
        if max(abs(a - b) for a, b in zip(axis, unit, strict=True)) < 1e-12:
            return name
    return list(axis)
