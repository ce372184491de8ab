"""Pair files: two gears in mesh and their load, read, checked and built."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from loadshare.case.keys import parse, unmatched, walk
from loadshare.case.origin import Origin
from loadshare.case.quantity import ANGLE, LENGTH
from loadshare.case.reader import read_toml
from loadshare.case.recent import Recent
from loadshare.case.recognise import TAKEN_BY, is_case
from loadshare.case.translate import validated
from loadshare.case.words import as_given, choices, did_you_mean
from loadshare.errors import CaseError, Problem, Refused
from loadshare.input import stem
from loadshare.one_thread import one_thread
from loadshare.progress import Progress
from loadshare.settings import CERTIFY
from loadshare.tooth.analysis.ltca import LOADS, POINTS, Model, ltca, pair_compliance
from loadshare.tooth.analysis.result import Ltca
from loadshare.tooth.analysis.sampling import at_each, cells
from loadshare.tooth.cylindrical.build import helicoid_pair, overlap_problems
from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification
from loadshare.tooth.cylindrical.pair import HelicoidPair, Misalignment
from loadshare.tooth.face.build import face_gear_pair
from loadshare.tooth.face.gear import FaceGear, Shaper
from loadshare.tooth.face.pair import FaceGearPair, FaceMisalignment
from loadshare.tooth.geometry.body import PitchDeviations
from loadshare.tooth.pair.findings import thin_tips
from loadshare.tooth.pair.model import (
    ABOUT,
    CONTENTS,
    Analysis,
    Cylindrical,
    FaceGearContent,
    HelicoidContent,
)
from loadshare.tooth.problems import refuse
from loadshare.tooth.unloaded.positions import touching


@dataclass(frozen=True, eq=False)
class PairFile:
    """A pair of gears with its rated torque and the way it is analysed.

    Attributes
    ----------
    name : str
        Name of the file, without its extension.
    content : HelicoidContent or FaceGearContent
        Content of the file.
    geometry : HelicoidPair or FaceGearPair
        The two gears in mesh, without undercut, pointed teeth or interference.
    """

    name: str
    content: HelicoidContent | FaceGearContent
    geometry: HelicoidPair | FaceGearPair

    @property
    def title(self) -> str:
        """One line that says what the pair is; its name if the file has none."""
        return self.content.title or self.name

    @property
    def torque(self) -> float:
        """Rated torque on the driver [N·m]."""
        return self.content.torque.si

    @property
    def analysis(self) -> Analysis:
        """How the pair is analysed."""
        return self.content.analysis

    @cached_property
    def hash(self) -> str:
        """SHA-256 of what affects the law: all values in SI units, no titles and notes."""
        values = self.content.model_dump(mode="json", exclude=set(ABOUT), context="SI")
        text = json.dumps(values, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
        return hashlib.sha256(text.encode()).hexdigest()

    @cached_property
    def offset(self) -> float:
        """Mean lead of the driver from the `offset` and `gear_shift` of a face gear [rad].

        They turn the pair by a constant angle. In a train they are installation errors of the face
        gear, which the case states; the law leaves the angle out, so that it is not counted twice.
        A case cannot state a tilt of the axes as an error, so its lead stays in the law. The ideal
        pair follows the centre distance and axial shift of cylindrical gears.
        """
        geometry = self.geometry
        if isinstance(geometry, HelicoidPair):
            return 0.0
        kept = replace(geometry.misalignment, offset=0.0, gear_shift=0.0)
        if geometry.misalignment == kept:
            return 0.0
        placed = replace(geometry, misalignment=kept)
        count = self.analysis.positions
        means = self.analysis.sampling == "means"
        parts = cells(count, geometry.changes) if means else at_each(np.arange(count) / count)
        leads, without = (touching(pair, parts.phase)[0] for pair in (geometry, placed))
        return float(parts.mean(leads - without).mean())

    def revised(
        self,
        *,
        torque: float | None = None,
        positions: int | None = None,
        compliance: Model | None = None,
    ) -> PairFile:
        """Return the pair under another torque [N·m], or analysed in another way."""
        content, follows = self.content, "points" not in self.analysis.model_fields_set
        asked = {"positions": positions, "compliance": compliance}
        analysis: dict[str, Any] = {key: value for key, value in asked.items() if value is not None}
        if compliance == "slices":
            analysis |= {"teeth": None, "layers": None}
        if compliance is not None and follows:
            analysis["points"] = POINTS[compliance]
        changed = self.analysis.model_copy(update=analysis)
        if follows:
            changed.model_fields_set.discard("points")
        update: dict[str, Any] = {"analysis": changed}
        if torque is not None:
            update["torque"] = type(content.torque)(f"{torque!r} N*m", torque)
        return replace(self, content=content.model_copy(update=update))

    @one_thread()
    def analyse(self, progress: Progress | None = None) -> Ltca:
        """Analyse the loaded contact at all positions.

        Parameters
        ----------
        progress : callable, optional
            Called after each position with the number done and the total.

        Raises
        ------
        Refused
            If a position has no contact, or one that fails its certificate, or the face is wider
            than the model can follow, or the teeth yield by their whole height.
        """
        chosen = self.analysis
        try:
            compliance = pair_compliance(
                self.geometry, chosen.compliance, teeth=chosen.teeth, layers=chosen.layers
            )
            found = ltca(
                self.geometry,
                self.torque,
                chosen.positions,
                LOADS,
                compliance,
                chosen.points,
                progress,
                means=chosen.sampling == "means",
            )
            self._refuse_crushed(found)
        except Refused as refusal:
            thin = "".join(f"; {tip.key}: {tip.message}" for tip in thin_tips(self.geometry))
            raise Refused(f"{self.name}: {refusal}{thin}", refusal.figures) from refusal
        return found

    def _refuse_crushed(self, found: Ltca) -> None:
        """Refuse an analysis to which linear elasticity does not apply.

        Raises
        ------
        Refused
            If the teeth yield by their whole height, a limit that holds for trains too.
        """
        module = self.geometry.driver.gear.module
        part = float(found.approach.max()) / (CERTIFY.height * module)
        if part >= CERTIFY.meaningless:
            raise Refused(
                f"under {self.torque:.4g} N·m the teeth yield by {part:.3g} times their height, "
                "to which linear elasticity does not apply; check torque, width, rim and elasticity"
            )


def load_pair(path: str | Path) -> PairFile:
    """Read a pair file.

    Parameters
    ----------
    path : str or pathlib.Path
        The file.

    Returns
    -------
    PairFile
        The pair, named after the file.

    Raises
    ------
    CaseError
        With all problems of the file at once; those of the geometry are reported once every value
        can be read.
    """
    path = Path(path)
    data = read_toml(path)
    which = path, data
    return _recent.of(None, which) or _recent.keep(None, _pair_of(path, data), which)


_recent: Recent[PairFile] = Recent()


def _pair_of(path: Path, data: dict[str, Any]) -> PairFile:
    origin = Origin(str(path))
    problems = [*_unmatched(data, origin), *_missing(data, origin)]
    try:
        content = _content(data, origin)
    except CaseError as error:
        raise CaseError([*error.problems, *problems]) from None
    if problems:
        raise CaseError(problems)
    try:
        geometry = built(content)
        if isinstance(geometry, HelicoidPair):
            refuse(overlap_problems(geometry))
    except CaseError as error:
        raise CaseError([_placed(problem, data, origin) for problem in error.problems]) from None
    return PairFile(stem(path), content, geometry)


def _content(data: dict[str, Any], origin: Origin) -> HelicoidContent | FaceGearContent:
    kind = data.get("kind")
    model = CONTENTS.get(kind) if isinstance(kind, str) else None
    if kind is None and is_case(data):
        raise CaseError([Problem(origin.file, "", "", TAKEN_BY["case"])])
    if model is None:
        what = "is missing" if kind is None else "is not a kind of pair"
        hint = did_you_mean(kind, CONTENTS)
        raise CaseError([origin.problem(data, ("kind",), what, choices(CONTENTS), hint)])
    return validated(model, data, origin)


def _missing(data: Mapping[str, Any], origin: Origin) -> Iterator[Problem]:
    """Yield keys that the driver must give for both gears and does not."""
    driver = data.get("driver")
    for key, allowed in (("module", LENGTH.allowed), ("pressure_angle", ANGLE.allowed)):
        if isinstance(driver, dict) and key not in driver:
            yield origin.problem(data, ("driver", key), "is missing", allowed, "")


def _unmatched(data: Mapping[str, Any], origin: Origin) -> list[Problem]:
    """Return problems of patterns of `assumed` that match no key of the file."""
    assumed = data.get("assumed")
    patterns = tuple(map(str, assumed)) if isinstance(assumed, list) else ()
    known = tuple(path for path in walk(data) if path[0] not in ABOUT)
    what, allowed = "matches no key of the file", 'a key path such as "driver.module"'
    return [
        origin.problem(data, ("assumed", number), what, allowed, "")
        for number, _ in unmatched(patterns, known)
    ]


def _placed(problem: Problem, data: Mapping[str, Any], origin: Origin) -> Problem:
    """Return a problem of the geometry with its file and what was written there."""
    here = origin.problem(data, parse(problem.key), problem.message, problem.allowed, problem.hint)
    return here if here.given else replace(here, given=as_given(problem.given).strip('"'))


def built(content: HelicoidContent | FaceGearContent) -> HelicoidPair | FaceGearPair:
    """Put the two gears of a pair file in mesh.

    Parameters
    ----------
    content : HelicoidContent or FaceGearContent

    Raises
    ------
    CaseError
        If the gears or their mesh have problems; it lists all of them.
    """
    return _helicoid(content) if isinstance(content, HelicoidContent) else _face(content)


def _helicoid(content: HelicoidContent) -> HelicoidPair:
    helices: dict[str, Any] = {
        "helices": content.helices,
        "helix_gap": content.helix_gap.si,
    }
    driver = _gear(content.driver, helices)
    kind = -1 if content.driver.internal != content.driven.internal else 1
    # What the driven gear leaves out is chosen to fit its driver.
    fitting = {
        "module": driver.module,
        "pressure_angle": driver.pressure_angle,
        "helix_angle": -kind * driver.helix_angle,
    }
    driven = _gear(content.driven, fitting | helices)
    distance = content.centre_distance
    return helicoid_pair(
        driver, driven, distance.si if distance else None, Misalignment(**_si(content.misalignment))
    )


def _face(content: FaceGearContent) -> FaceGearPair:
    pinion, driven = _gear(content.driver, {}), content.driven
    cutter = driven.shaper
    shift = pinion.profile_shift if cutter.profile_shift is None else cutter.profile_shift
    shaper = Shaper(pinion.module, cutter.teeth, pinion.pressure_angle, shift, cutter.addendum)
    gear = FaceGear(**(_si(driven) | {"shaper": shaper}))
    return face_gear_pair(pinion, gear, FaceMisalignment(**_si(content.misalignment)))


def _gear(element: Cylindrical, fitting: dict[str, Any]) -> HelicoidGear:
    """Return a gear; `fitting` gives what it leaves out."""
    values = _si(element)
    values["modification"] = Modification(**values["modification"])
    return HelicoidGear(**(fitting | values))


def _si(element: Any) -> dict[str, Any]:
    """Return the values of an element in SI units, without what it leaves out."""
    found: dict[str, Any] = element.model_dump(mode="json", exclude_none=True, context="SI")
    if "pitch" in found:
        found["pitch"] = PitchDeviations(element.pitch.ahead, element.pitch.first_tooth)
    return found
