"""Law files: the law of a mesh as computed for a pair, with what it was computed from."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, Strict, ValidationError

from loadshare._version import __version__
from loadshare.case.element import Element, Rule, written
from loadshare.case.meshes import Bending, Hertz
from loadshare.case.origin import Origin
from loadshare.case.quantity import Angle
from loadshare.case.reader import read_toml
from loadshare.case.translate import translate
from loadshare.case.words import count
from loadshare.errors import CaseError
from loadshare.tooth.analysis.result import Ltca
from loadshare.tooth.pair.file import PairFile
from loadshare.tooth.pair.model import Load, Number, Positions

Share = Annotated[float, Strict(), Field(ge=0, allow_inf_nan=False)]


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
    """Parts of it at which the contact was solved [-]."""

    positions: Positions
    """Positions of the mesh cycle [-]."""

    points: Positions
    """Points on a contact line [-]."""

    compliance: str
    """Model of the teeth."""

    teeth: int | None = None
    """Teeth in the finite-element model, where the pair file says [-]."""

    layers: int | None = None
    """Finite elements over the face width, where the pair file says [-]."""


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
    """Largest miss of the law at the loads that were solved, over the elastic angle there [-]."""

    computed: Stamp
    """What it was computed from."""

    def rules(self) -> Iterator[Rule]:
        """Yield the lists that are not as long as there are positions."""
        for key in ("a", "b", "c", "misfit"):
            found = len(getattr(self, key))
            if found != self.computed.positions:
                told = f"has {count(found)}, computed.positions is {self.computed.positions}"
                yield Rule(told, (key,))

    @property
    def coefficients(self) -> dict[str, list[str]]:
        """a, b and c as the table `law` of a mesh."""
        return {key: [value.text for value in getattr(self, key)] for key in "abc"}


def law_of(pair: PairFile, found: Ltca) -> MeshLaw:
    """Law of a pair from its analysis.

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
            exclude_none=True, include={"points", "compliance", "teeth", "layers"}
        ),
    }
    return MeshLaw.model_validate(
        {
            "kind": "law",
            "a": [f"{float(value)!r} rad" for value in law.a - pair.offset],
            "b": [f"{float(value)!r} rad/(N*m)" for value in law.b],
            "c": [f"{float(value)!r} rad/(N*m)^(2/3)" for value in law.c],
            "misfit": [float(f"{part:.3g}") for part in np.abs(found.misfit).max(axis=1)],
            "computed": computed,
        }
    )


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


def parsed_law(text: str) -> MeshLaw | None:
    """Return the law of a text, or None where it holds none."""
    try:
        return _law(tomllib.loads(text), Origin("law"))
    except (tomllib.TOMLDecodeError, CaseError):
        return None


def _law(data: dict[str, Any], origin: Origin) -> MeshLaw:
    if data.get("kind") != "law":
        hint = "The command loadshare ltca writes law files."
        raise CaseError([origin.problem(data, ("kind",), "is no law file", "law", hint)])
    try:
        return MeshLaw.model_validate(data)
    except ValidationError as error:
        found = translate(error, MeshLaw)
        problems = [origin.problem(data, f.path, f.message, f.allowed, f.hint) for f in found]
        raise CaseError(problems) from None
