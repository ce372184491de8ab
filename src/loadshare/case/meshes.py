"""Meshes and their deformation laws."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, Strict, Tag

from loadshare.case.element import (
    LIST,
    NESTED,
    TABLE,
    VALUE,
    Element,
    NotNegative,
    PerPosition,
    Rule,
    Text,
    shaped,
    values,
    without_default,
)
from loadshare.case.gears import STEEPEST
from loadshare.case.keys import Path
from loadshare.case.quantity import (
    ANGLE,
    HERTZ_COMPLIANCE,
    LENGTH,
    TORQUE,
    TORSIONAL_COMPLIANCE,
    TORSIONAL_STIFFNESS,
    Angle,
    Distance,
    Quantity,
)
from loadshare.numbers import counted

SOURCES = ("geometry", "law_file")
"""Keys that name a file from which the law follows."""
LAWS = ("stiffness", "law", "table", "law_file", "geometry")

MeshStiffness = Annotated[Quantity, TORSIONAL_STIFFNESS.bounded(above=0)]
Bending = Annotated[Quantity, TORSIONAL_COMPLIANCE.bounded(at_least=0)]
Hertz = Annotated[Quantity, HERTZ_COMPLIANCE.bounded(at_least=0)]
TableTorque = Annotated[Quantity, TORQUE.bounded(at_least=0)]
TableAngle = Annotated[Quantity, ANGLE.bounded(at_least=0)]
FileName = Annotated[str, Field(min_length=1)]


class Law(Element):
    """Loaded deformation of a mesh at the driver: a + b T + c T^(2/3)."""

    a: PerPosition[Angle] = Quantity("0 rad", 0.0)
    """Unloaded gap of either flank [angle], one value or one per position."""

    b: PerPosition[Bending] = Quantity("0 rad/(N*m)", 0.0)
    """Tooth and root bending [angle/torque], one value or one per position."""

    c: PerPosition[Hertz] = Quantity("0 rad/(N*m)^(2/3)", 0.0)
    """Hertz contact [angle/torque^(2/3)], one value or one per position."""

    sampling: Literal["points", "means"] = "points"
    """What a list gives: values at the positions, or means over the parts of the cycle around them.
    """

    basis: Text = Field(default="", exclude=True)
    """Where the law comes from."""

    holds_from: Annotated[Quantity, TORQUE.bounded(at_least=0)] | None = Field(
        default=None, exclude=True
    )
    """Torque at the driver below which its basis does not hold; results then warn [torque]."""

    holds_to: Annotated[Quantity, TORQUE.bounded(above=0)] | None = Field(
        default=None, exclude=True
    )
    """Torque at the driver above which its basis does not hold; results then warn [torque]."""

    misfit: NotNegative | None = Field(default=None, exclude=True)
    """Largest error of the law at loads other than those it was fitted to, relative to the elastic
    angle; results warn from 0.03 on [-]."""

    teeth: Text = Field(default="", exclude=True)
    """Digest of the teeth that the numbers were computed from: with it, they are refused for gears
    with other teeth."""

    def rules(self) -> Iterator[Rule]:
        """Yield a broken rule if the mesh would be rigid at a position."""
        b, c = values(self.b), values(self.c)
        rigid = [k for k in range(max(len(b), len(c))) if b[k % len(b)] == c[k % len(c)] == 0]
        if rigid:
            yield Rule("b and c are both 0: the mesh would be rigid", hint="Give b, c or both.")


IMPLIED = "Leave out the point (0, 0); a gap of the unloaded flanks is the key gap of the mesh."


class Table(Element):
    """Loaded deformation of a mesh at the driver as points; the point (0, 0) is implied."""

    torque: Annotated[tuple[TableTorque, ...], Field(min_length=1)]
    """Torques at the driver, increasing [torque]."""

    deflection: Annotated[
        Annotated[tuple[TableAngle, ...], Field(min_length=1), Tag(LIST)]
        | Annotated[tuple[tuple[TableAngle, ...], ...], Tag(NESTED)],
        shaped("a list of angles, or one such list per position"),
    ]
    """Deflections at the driver, increasing [angle]; one list, or one list per position."""

    def rules(self) -> Iterator[Rule]:
        """Yield the lists that begin at 0, do not increase or differ in length."""
        for path, points in (("torque",), self.torque), *self._curves():
            if points and points[0].si == 0.0:
                yield Rule("begins at 0, which is implied", path, hint=IMPLIED)
        if not _increases(self.torque):
            yield Rule("does not increase", ("torque",))
        for path, points in self._curves():
            if len(points) != len(self.torque):
                number = f"has {counted(len(points))}, but torque has {len(self.torque)}"
                yield Rule(number, path)
            elif not _increases(points):
                yield Rule("does not increase", path)

    @property
    def curves(self) -> tuple[tuple[Quantity, ...], ...]:
        """The deflections [angle]: one curve, or one per position."""
        return tuple(points for _, points in self._curves())

    def _curves(self) -> Iterator[tuple[Path, tuple[Quantity, ...]]]:
        flat = tuple(point for point in self.deflection if isinstance(point, Quantity))
        if flat:
            yield ("deflection",), flat
        for number, points in enumerate(self.deflection):
            if isinstance(points, tuple):
                yield ("deflection", number), points


class Mesh(Element):
    """A pair of gears in mesh; compliance and gap are angles at the driver."""

    driver: str = Field(default="", json_schema_extra=without_default)
    """Gear that drives; the first of the mesh's name when left out."""

    driven: str = Field(default="", json_schema_extra=without_default)
    """Gear that is driven; the second of the mesh's name when left out."""

    pressure_angle: Annotated[Quantity, ANGLE.bounded(above=0, at_most=STEEPEST)] | None = None
    """Transverse working pressure angle, at most 45 deg [angle].

    When left out, it is that of the common tangent of the base circles; a face gear needs it.
    """

    helix_angle: Annotated[Quantity, ANGLE] | None = None
    """Base helix angle, for `normal_backlash` [angle]; by default that of the teeth, or 0 deg."""

    stiffness: PerPosition[MeshStiffness] | None = None
    """Constant stiffness at the driver [torque/angle], one value or one per position."""

    law: (
        Annotated[
            Annotated[Literal["iso", "iso solid", "ltca", "ltca elements"], Tag(VALUE)]
            | Annotated[Law, Tag(TABLE)],
            shaped('"iso", "iso solid", "ltca", "ltca elements", or a table of a, b and c'),
        ]
        | None
    ) = None
    """Deformation law a + b T + c T^(2/3) at the driver [angle], or a word for its source.

    iso: mean stiffness by ISO 6336-1, method B, from the teeth of both gears; iso solid: without
    the factor C_M = 0.8, by which measured teeth are softer than calculated ones. ltca: loaded
    tooth contact analysis of both gears with slices; ltca elements: with finite elements.
    """

    rated_torque: Annotated[Quantity, TORQUE.bounded(above=0)] | None = None
    """Torque at the driver up to which `law = "ltca"` is analysed [torque]; when left out, that of
    50 N per mm of face width and mm of module."""

    table: Table | None = None
    """Deformation at the driver [angle] as a table against torque [torque]."""

    law_file: FileName | None = None
    """Law file, as `loadshare ltca` writes it, relative to this file."""

    geometry: FileName | None = None
    """Pair file from whose teeth the law is computed, relative to this file."""

    gap: PerPosition[Angle] | None = None
    """Unloaded gap at the driver that opens the drive flank [angle], one value or one per position;
    in a mesh without a backlash, the flank that carries."""

    phase: Annotated[float, Strict(), Field(ge=0, lt=1, allow_inf_nan=False)] | None = None
    """Fraction of its cycle that has passed at the first position [-]; set by `operating.phases`
    when left out."""

    backlash: (
        Annotated[Quantity | Literal["teeth"], LENGTH.bounded(at_least=0).or_words("teeth")] | None
    ) = None
    """Circumferential working backlash [length]; if no backlash is given, the coast flank is free.

    teeth: that of the teeth of both gears at their centres, with their `thickness_allowance`.
    """

    normal_backlash: Distance | None = None
    """Backlash at right angles to the flanks, j_bn [length], in place of `backlash`."""

    ALTERNATIVES = (
        (("stiffness",), ("law", "rated_torque"), ("table",), ("law_file",), ("geometry",)),
        (("backlash",), ("normal_backlash",)),
    )

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on laws, gaps, backlashes and the helix angle."""
        laws = self.given(*LAWS)
        if not laws:
            yield Rule("has no deformation law", allowed=f"one of {', '.join(LAWS)}")
        elif len(laws) > 1:
            hint = f"Drop {' or '.join(laws)}; an inherited one with `remove`."
            yield Rule(f"has {len(laws)} deformation laws: {', '.join(laws)}", hint=hint)
        if self.gap is not None and self.power_law is not None and any(values(self.power_law.a)):
            yield Rule.exclusive("gap", "law.a")
        if self.gap is not None and (self.law_file or self.geometry):
            source = "geometry" if self.geometry else "law_file"
            hint = "Leave it out; errors of the gears also open the mesh."
            yield Rule(
                f"cannot be combined with {source}, which gives the gap", ("gap",), hint=hint
            )
        if self.rated_torque is not None and not self.law_is_of_contact:
            yield Rule('applies only to law = "ltca"', ("rated_torque",))
        if self.backlash is not None and self.normal_backlash is not None:
            yield Rule.exclusive("normal_backlash", "backlash")
        if self.helix_angle is not None and abs(self.helix_angle.si) >= math.pi / 2:
            yield Rule("is 90 deg or more", ("helix_angle",), ANGLE.allowed)

    @property
    def ends(self) -> tuple[str, str]:
        """Driver and driven gear."""
        return self.driver, self.driven

    @property
    def power_law(self) -> Law | None:
        """The law a + b T + c T^(2/3), if one is given in numbers."""
        return self.law if isinstance(self.law, Law) else None

    @property
    def law_is_of_contact(self) -> bool:
        """Whether the law comes from a contact analysis of the gears' own teeth."""
        return self.law in ("ltca", "ltca elements")

    @property
    def law_is_computed(self) -> bool:
        """Whether the law comes from a file or a formula, not from numbers in the case."""
        return bool(self.geometry or self.law_file or isinstance(self.law, str))

    @property
    def has_backlash(self) -> bool:
        """Whether there is a backlash above 0, or one that follows from the teeth."""
        known = (self.backlash, self.normal_backlash)
        return any(isinstance(b, str) or (b is not None and b.si > 0.0) for b in known)

    def per_position(self) -> Iterator[tuple[Path, object]]:
        """Yield key and value of everything that may be given once or once per position."""
        yield from (((key,), getattr(self, key)) for key in ("stiffness", "gap"))
        if self.power_law is not None:
            yield from ((("law", key), getattr(self.power_law, key)) for key in "abc")
        if self.table is not None:
            yield ("table", "deflection"), self.table.curves


def _increases(points: tuple[Quantity, ...]) -> bool:
    return all(low.si < high.si for low, high in pairwise(points))
