"""A REXS model: components with attributes in SI units, their types, and relations between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from loadshare.settings import ALLOWED


@dataclass(frozen=True)
class Unread:
    """A value that a case needs as a number but that cannot be read as one.

    Attributes
    ----------
    given : str
        The value as in the file, with its unit.
    message : str
        What is wrong with it.
    allowed : str
        What it may be instead.
    """

    given: str
    message: str
    allowed: str = ""


Value = float | bool | str | tuple[float, ...] | Unread


@dataclass(frozen=True)
class Component:
    """A component.

    Attributes
    ----------
    id : str
    type, name : str
    attributes : mapping of str to float, bool, str, tuple of float or bool, or Unread
        In SI units.
    """

    id: str
    type: str
    name: str
    attributes: Mapping[str, Value]

    def number(self, *names: str) -> float | None:
        """Return the first of some attributes that is a number of a size allowed in a case."""
        for name in names:
            value = self.attributes.get(name)
            if isinstance(value, float) and abs(value) <= ALLOWED.largest:
                return value
        return None

    def vector(self, name: str) -> tuple[float, float, float] | None:
        """Return an attribute of three numbers, if each is of a size allowed in a case."""
        value = self.attributes.get(name)
        if isinstance(value, tuple) and len(value) == 3:
            return value if all(abs(v) <= ALLOWED.largest for v in value) else None
        return None

    def holds(self, name: str) -> bool:
        """Return whether an attribute is true."""
        return self.attributes.get(name) is True

    def title(self) -> str:
        """Return type, id and name, for messages."""
        return " ".join(filter(None, (self.type, self.id, f"({self.name})" if self.name else "")))


@dataclass(frozen=True)
class Relation:
    """A relation: ids of components by their roles."""

    type: str
    roles: Mapping[str, str]


@dataclass(frozen=True)
class Model:
    """A REXS model.

    Attributes
    ----------
    version : str
    components : mapping of id to Component
    relations : tuple of Relation
    notes : tuple of str
        What was assumed in reading it.
    dangling_relations : tuple of str
        Remarks on relations that are left out because they name components that are not there.
    """

    version: str
    components: Mapping[str, Component]
    relations: tuple[Relation, ...]
    notes: tuple[str, ...] = field(default=())
    dangling_relations: tuple[str, ...] = field(default=())

    def of_type(self, *types: str) -> list[Component]:
        """Return the components of some types."""
        return [c for c in self.components.values() if c.type in types]

    def related(self, kind: str, *roles: str) -> Iterator[tuple[Component, ...]]:
        """Yield the components of every relation of a kind, in the order of some roles."""
        for relation in self._by_kind.get(kind, ()):
            ids = [relation.roles.get(role, "") for role in roles]
            if all(id_ in self.components for id_ in ids):
                yield tuple(self.components[id_] for id_ in ids)

    @cached_property
    def parts(self) -> list[tuple[Component, ...]]:
        """Assemblies, each with one of its parts."""
        return list(self.related("assembly", "assembly", "part"))

    @cached_property
    def _by_kind(self) -> dict[str, list[Relation]]:
        found: dict[str, list[Relation]] = {}
        for relation in self.relations:
            found.setdefault(relation.type, []).append(relation)
        return found


GEARS = ("cylindrical_gear", "ring_gear")
COUPLINGS = (
    "coupling",
    "fixed_coupling",
    "switchable_coupling",
    "rigid_connection",
    "involute_spline_connection",
)
FIXED = ("gear_casing", "gear_unit")
BEARINGS = (
    "concept_bearing",
    "rolling_bearing_with_catalog_geometry",
    "rolling_bearing_with_detailed_geometry",
    "plain_bearing",
    "slide_bearing",
    "radial_plain_bearing",
)
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
    "material",
}
"""Types of components that are read, or that have no content of their own."""


def may_turn(load: Component) -> bool:
    """Return whether a component is a load that may exert torque."""
    return load.type == "external_load" and load.attributes.get("transmits_torque") is not False


def transmits(coupling: Component) -> bool:
    """Return whether a coupling transmits torque: not with a torsional stiffness of zero."""
    return coupling.number("rotational_stiffness") != 0.0
