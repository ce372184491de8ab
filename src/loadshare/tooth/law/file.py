"""Law files: the law of a mesh as computed for a pair, with what it was computed from."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, Strict

from loadshare._version import __version__
from loadshare.case.element import Element, Positions, Rule, written
from loadshare.case.meshes import Bending, Hertz
from loadshare.case.origin import Origin
from loadshare.case.quantity import Angle, Length
from loadshare.case.reader import read_toml
from loadshare.case.translate import validated
from loadshare.errors import CaseError, Refused
from loadshare.numbers import counted
from loadshare.settings import CERTIFY
from loadshare.tooth.analysis.fit import FIT_LOADS
from loadshare.tooth.analysis.result import Ltca
from loadshare.tooth.geometry.body import HALVED, HEIGHTS, RIM
from loadshare.tooth.pair.file import PairFile
from loadshare.tooth.pair.gears import PairGears, gears_of
from loadshare.tooth.pair.model import Load, Number

MISSED = 0.01
"""Part of the mean deflection that positions may miss without a finding."""
UNKNOWN = "its law file does not name its gears, so they are not compared: write it anew"
"""Text that the basis adds if a law file lacks its gears."""
_GEARS = {"driver": "driver", "driven": "driven gear"}
Share = Annotated[float, Strict(), Field(ge=0, allow_inf_nan=False)]


class Rim(Element):
    """Effect of another rim thickness of a gear on the mesh, computed with slices."""

    thickness: tuple[Length, Length, Length]
    """Thickness below the root of a thinner rim, the gear's own and a thicker one [length]."""

    stiffness: tuple[Number, Number, Number]
    """Mean stiffness of the mesh at the rated torque, relative to that with the own rim [-]."""

    assumed: bool
    """Whether the gear's own rim is assumed because the pair file does not give it."""

    def text(self, gear: str, depth: str) -> str:
        """Return a line of text; `depth` is the gear's own, in words, in case it is assumed."""
        low, own, high = (f"{1e3 * value.si:.4g} mm" for value in self.thickness)
        softer, stiffer = (f"{100.0 * (self.stiffness[k] - 1.0):+.1f} %" for k in (0, 2))
        source = f" (assumed, {depth})" if self.assumed else ""
        return (
            f"The rim of the {gear} is {own} thick{source}. With {low} the mean stiffness would "
            f"change by {softer}, with {high} by {stiffer}."
        )


ROUNDED = 1e-3
"""Relative amount by which a depth in a law file may be less than the one assumed."""
SIDEWAYS = 11.4
"""How much more helical teeth yield than slices, over (sin β_b m/b)² (docs/ltca.md)."""
SLICES = 0.05
"""Amount from which that is reported: slices have an error of 2 to 7 % anyway."""


class Stamp(Element):
    """What a law was computed from."""

    version: str
    """Version of loadshare."""

    pair: str
    """Name of the pair file."""

    pair_hash: str
    """SHA-256 of its values in SI units."""

    torque: Load
    """Rated torque on the driver [torque]."""

    loads: tuple[Number, ...]
    """Fractions of the torque at which the contact was solved [-]."""

    positions: Positions
    """Positions of the mesh cycle [-]."""

    points: Positions
    """Points on a contact line [-]."""

    compliance: str
    """Model of the teeth."""

    sampling: Literal["points", "means"] = "points"
    """Whether the law holds at the positions, or is the mean over their parts of the cycle."""

    teeth: int | None = None
    """Teeth in the finite-element model, if the pair file gives them [-]."""

    layers: int | None = None
    """Finite elements over the face width, if the pair file gives them [-]."""

    gears: PairGears | None = None
    """The gears, with which those of a case are compared; older files lack them."""


class MeshLaw(Element):
    """Loaded deformation of a mesh at the driver, a + b T + c T^(2/3), by position."""

    kind: Literal["law"] = "law"
    """law: the law of a mesh."""

    a: tuple[Angle, ...]
    """Unloaded gap [angle]."""

    b: tuple[Bending, ...]
    """Tooth and root bending [angle/torque]."""

    c: tuple[Hertz, ...]
    """Hertz contact [angle/torque^(2/3)]."""

    misfit: tuple[Share, ...]
    """Largest error of the law at the loads solved, relative to the elastic angle there [-]."""

    rim: dict[Literal["driver", "driven"], Rim] = Field(default_factory=dict)
    """Effect of other rim thicknesses of either gear."""

    sampled: Number | None = None
    """Mean deflection at the positions, relative to that of the whole cycle, with slices [-]."""

    carried: dict[str, tuple[Share, ...]] = Field(default_factory=dict)
    """With pitch deviations, fraction of T on each pair of teeth by position, named by its numbers,
    "driver tooth-driven tooth" [-]."""

    computed: Stamp
    """What the law was computed from."""

    def rules(self) -> Iterator[Rule]:
        """Yield lists whose length is not the number of positions, and where the mesh is rigid."""
        for key in ("a", "b", "c", "misfit"):
            found = len(getattr(self, key))
            if found != self.computed.positions:
                message = (
                    f"has {counted(found)}, but computed.positions is {self.computed.positions}"
                )
                yield Rule(message, (key,))
        for k, (b, c) in enumerate(zip(self.b, self.c, strict=False)):
            if b.si == c.si == 0.0:
                hint = "Write the file anew: loadshare ltca."
                yield Rule("and c are both 0 here: the mesh would be rigid", ("b", k), hint=hint)

    @property
    def findings(self) -> tuple[str, ...]:
        """How the law depends on rims and positions, and what it leaves out, a line each."""
        lines = [rim.text(_GEARS[name], self._assumed(name)) for name, rim in self.rim.items()]
        missed = 0.0 if self.sampled is None else self.sampled - 1.0
        if abs(missed) > MISSED:
            lines.append(
                f"Sampled at {counted(self.computed.positions, 'position')}, the mean deflection "
                f"is {100.0 * missed:+.1f} % off that of the whole cycle; analysis.sampling = "
                '"means" gives it correctly.'
            )
        if self.sideways > SLICES:
            lines.append(
                "Slices neglect the sideways bending of helical teeth on so narrow a face: the "
                f"mesh yields about {100.0 * self.sideways:.0f} % more. Finite elements include it."
            )
        if self.yielding > CERTIFY.compressed:
            lines.append(
                f"Under T the teeth yield by {100.0 * self.yielding:.0f} % of their height, too "
                "much for linear elasticity to apply."
            )
        return (*lines, *self._most_loaded())

    def _assumed(self, name: Literal["driver", "driven"]) -> str:
        """Return, in words, how deep the body of a gear is whose rim the pair does not give."""
        gear = getattr(self.computed.gears, name, None)
        if gear is None or None in (gear.module, gear.addendum, gear.dedendum):
            return RIM
        depth = self.rim[name].thickness[1].si / gear.module.si
        heights = depth / (gear.addendum + gear.dedendum)
        return RIM if heights > (1.0 - ROUNDED) * HEIGHTS else HALVED

    @property
    def yielding(self) -> float:
        """Largest deflection of the teeth under T, over their height [-]; 0 if it is not known."""
        gears, torque = self.computed.gears, self.computed.torque.si
        if gears is None or gears.driver.module is None:
            return 0.0
        turned = (
            b.si * torque + c.si * torque ** (2 / 3) for b, c in zip(self.b, self.c, strict=True)
        )
        height = CERTIFY.height * gears.driver.module.si
        return float(max(turned) * gears.driver.base_radius.si / height)

    @property
    def sideways(self) -> float:
        """Part by which slices yield too little, because helical teeth bend sideways too [-]."""
        gears = self.computed.gears
        if self.computed.compliance != "slices" or gears is None or gears.driver.module is None:
            return 0.0
        widths = [g.face_width.si for g in (gears.driver, gears.driven) if g.face_width]
        width = min(widths, default=math.inf) / gears.helices
        return (
            SIDEWAYS * (math.sin(gears.base_helix_angle.si) * gears.driver.module.si / width) ** 2
        )

    def _most_loaded(self) -> Iterator[str]:
        """Yield which teeth are in contact under T, and which carry most."""
        if not self.carried:
            return
        teeth, shares = max(self.carried.items(), key=lambda one: max(one[1]))
        most = max(shares)
        where = ", ".join(str(k + 1) for k, share in enumerate(shares) if share == most)
        yield (
            f"The teeth in contact under T are {', '.join(self.carried)} (driver's and driven "
            f"gear's); {teeth} carries most, {100.0 * most:.0f} % at position {where}."
        )

    def as_law(self, assumed: Sequence[str] = ()) -> dict[str, Any]:
        """Return the table `law` of a mesh: a, b and c, their basis, and the loads they hold for.

        Parameters
        ----------
        assumed : sequence of str
            What was assumed for the analysis.
        """
        made = self.computed
        means = ", means over the cycle" if made.sampling == "means" else ""
        taken = f"; assumed: {', '.join(assumed)}" if assumed else ""
        unknown = "" if made.gears else f"; {UNKNOWN}"
        more = f"; yields about {100.0 * self.sideways:.0f} % more by sideways bending"
        left = more if self.sideways > SLICES else ""
        return {key: [value.text for value in getattr(self, key)] for key in "abc"} | {
            "sampling": made.sampling,
            "basis": f"LTCA, {made.compliance}{means}{taken}{left}{unknown}",
            "misfit": max(self.misfit),
            "holds_from": f"{min(FIT_LOADS) * made.torque.si:.9g} N*m",
            "holds_to": f"{made.torque.si:.9g} N*m",
        }


def law_of(pair: PairFile, found: Ltca) -> MeshLaw:
    """Return the law of a pair from its analysis.

    Parameters
    ----------
    pair : PairFile
    found : Ltca
        Its analysis.
    """
    law, settings = found.law, pair.analysis
    computed = {
        "version": __version__,
        "pair": pair.name,
        "pair_hash": pair.hash,
        "torque": pair.content.torque.text,
        "loads": [float(f"{part:.9g}") for part in found.torque / found.rated],
        "positions": len(found.positions),
        **settings.model_dump(
            exclude_none=True, include={"points", "compliance", "sampling", "teeth", "layers"}
        ),
        "gears": written(gears_of(pair.geometry)),
    }
    return MeshLaw.model_validate(
        {
            "kind": "law",
            "a": [f"{float(value)!r} rad" for value in law.a - pair.offset],
            "b": [f"{float(value)!r} rad/(N*m)" for value in law.b],
            "c": [f"{float(value)!r} rad/(N*m)^(2/3)" for value in law.c],
            "misfit": [float(f"{part:.3g}") for part in np.abs(found.misfit).max(axis=1)],
            **_sureness(pair),
            **_carried(pair, found),
            "computed": computed,
        }
    )


def _sureness(pair: PairFile) -> dict[str, Any]:
    """Return how the law depends on its rims and positions, if slices can solve the contact."""
    from loadshare.tooth.pair.sensitivity import rim_effects, sampled_deflection

    found: dict[str, Any] = {}
    with suppress(Refused):
        found["rim"] = {
            name: {
                "thickness": [f"{1e3 * t:.6g} mm" for t in effect.thickness],
                "stiffness": [float(f"{part:.4g}") for part in effect.stiffness],
                "assumed": getattr(pair.content, name).rim is None,
            }
            for name, effect in rim_effects(pair).items()
        }
        if pair.analysis.sampling == "points":
            found["sampled"] = float(f"{sampled_deflection(pair):.4g}")
    return found


def _carried(pair: PairFile, found: Ltca) -> dict[str, Any]:
    """Return the load on the pairs of teeth, if pitch deviations make the teeth differ."""
    one, two = pair.geometry.driver.gear, pair.geometry.driven.gear
    if one.pitch is None and two.pitch is None:
        return {}
    shares = found.shares()
    pairs = sorted({number for own in shares for number in own}, reverse=True)
    return {
        "carried": {
            f"{one.tooth_of(k)}-{two.tooth_of(k)}": [float(f"{s.get(k, 0.0):.4g}") for s in shares]
            for k in pairs
        }
    }


def law_text(law: MeshLaw) -> str:
    """Return a law as the text of a law file."""
    import tomlkit
    from tomlkit.items import Array

    document = tomlkit.document()
    document.add(tomlkit.comment("Law of a mesh at the driver, a + b T + c T^(2/3), by position."))
    for key, value in written(law).items():
        item = tomlkit.item(value)
        if isinstance(item, Array) and key in "abc":
            item.multiline(True)
        document.add(key, item)
    return tomlkit.dumps(document)


def load_law(path: str | Path) -> MeshLaw:
    """Read a law file.

    Parameters
    ----------
    path : str or pathlib.Path
        The file.

    Raises
    ------
    CaseError
        With all problems of the file at once.
    """
    path = Path(path)
    return _law(read_toml(path), Origin(str(path)))


@lru_cache(maxsize=8)
def parsed_law(text: str) -> MeshLaw | None:
    """Return the law that a text holds, or None if it holds none."""
    try:
        return _law(tomllib.loads(text), Origin("law"))
    except (tomllib.TOMLDecodeError, CaseError):
        return None


def _law(data: dict[str, Any], origin: Origin) -> MeshLaw:
    if data.get("kind") != "law":
        hint = "The command loadshare ltca writes law files."
        raise CaseError([origin.problem(data, ("kind",), "is no law file", "law", hint)])
    return validated(MeshLaw, data, origin)
