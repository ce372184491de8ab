"""A result read back: what it claims is certified again, the rest is computed and compared."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from itertools import islice
from typing import Annotated, Any, NoReturn

import numpy as np
from pydantic import FailFast, TypeAdapter, ValidationError

from loadshare._version import __version__
from loadshare.case import Case
from loadshare.case.keys import Path, dotted
from loadshare.case.origin import Origin
from loadshare.case.words import as_given
from loadshare.certify import Certificate
from loadshare.certify.certificate import certify_all
from loadshare.certify.tolerance import checked_tolerance
from loadshare.certify.validity import refusal_text
from loadshare.errors import CaseError, Problem, ResultError
from loadshare.later import known
from loadshare.results.claim import Claim, misnamed, oversized
from loadshare.results.derive import positions_of, result_from
from loadshare.results.differences import DIGITS, ROUND_OFF, differences
from loadshare.results.digest import DIGEST, digest_of
from loadshare.results.document import FORMAT, OLDER, as_data, to_document
from loadshare.results.result import Effort, Position, Result, Stamp
from loadshare.scene import Scene, assemble
from loadshare.settings import ALLOWED
from loadshare.solver.position import coordinates_of, ranges_of
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium, Range
from loadshare.train.memory import slip_of
from loadshare.train.placed import train_at

AGAIN = "Solve the case again: loadshare run CASE.toml -o FILE.json."


@dataclass(frozen=True, slots=True)
class _Position:
    """The part of a position that is read; all else in it is computed again and compared."""

    position: int
    claim: Claim
    undetermined: dict[str, tuple[float | None, float | None]]
    effort: Effort

    @property
    def ranges(self) -> dict[str, Range]:
        """Ranges of undetermined coordinates, with infinite ends where there is no limit."""
        return {
            name: (-math.inf if low is None else low, math.inf if high is None else high)
            for name, (low, high) in self.undetermined.items()
        }


@dataclass(frozen=True, slots=True, eq=False)
class _Claimed:
    """The claim of a file about a position, with its certificate."""

    equilibrium: Equilibrium
    certificate: Certificate
    effort: Effort


@dataclass(frozen=True, slots=True)
class _File:
    """The part of a file that is read."""

    stamp: Stamp
    input: dict[str, Any]
    positions: Annotated[list[_Position], FailFast()]


def read_document(text: str, file: str) -> tuple[Result, dict[str, Any]]:
    """Rebuild a result from its JSON text: certify its claims, compute all else and compare.

    Parameters
    ----------
    text : str
    file : str
        Name of the file, for messages.

    Returns
    -------
    Result
    dict
        The text as plain data.

    Raises
    ------
    ResultError
        If the text is not what :func:`to_document` returns for a result that passes.
    """
    document = _parsed(text, file)
    given = _read(text, file)
    case, train = _machine(given, file)
    problems = [*_wrong_positions(given, train), *_wrong_claims(given, train)]
    _raise(problems, file)
    tolerance = _tolerance(given, file)
    positions = _positions(train, given.positions, tolerance)
    _raise(_uncertified(positions), file)
    _raise(_wrong_slips(train, positions), file)
    _raise(_wrong_ranges(positions, train), file)
    stamp = replace(given.stamp, title=case.title, case_hash=case.hash)
    result = result_from(case, case, train, positions, known(stamp))
    # The digest is that of the digits in the file, whichever processor computed them.
    expected = to_document(result, document.get("format", 1)) | {DIGEST: document.get(DIGEST)}
    _raise(differences(expected, document, names=_elements(given, train)), file)
    _raise(_altered(document), file)
    return result, document


Wrong = tuple[Path, str, str, str]
"""Key path, the value found there, what is wrong with it, and what was expected."""


def _raise(wrong: Iterable[Wrong], file: str) -> None:
    problems = [
        Problem(file, dotted(path), *words) for path, *words in islice(wrong, ALLOWED.problems)
    ]
    if problems:
        raise ResultError([*problems[:-1], replace(problems[-1], hint=AGAIN)])


def _fail(file: str, message: str, hint: str = AGAIN, key: Path = (), given: str = "") -> NoReturn:
    raise ResultError([Problem(file, dotted(key), given, message, "", hint)])


def _altered(document: dict[str, Any]) -> Iterator[Wrong]:
    """Yield a problem if a digit or word was changed on which no figure depends."""
    if document.get(DIGEST) != digest_of(document):
        message = "does not match the content of this file, which was changed after it was written"
        yield (DIGEST,), as_given(document.get(DIGEST)), message, ""


def _parsed(text: str, file: str) -> dict[str, Any]:
    """Parse JSON in which every number is finite and no key appears twice; check its format."""

    def number(written: str) -> float:
        value = float(written)
        if not math.isfinite(value):
            raise ValueError(f"{written} is not a finite number")
        return value

    def table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
            raise ValueError(f"the key {twice} appears twice in one table")
        return found

    try:
        document = json.loads(
            text, parse_float=number, parse_constant=number, object_pairs_hook=table
        )
    except RecursionError:
        _fail(file, "contains no loadshare result: its tables are nested too deeply")
    except ValueError as error:
        _fail(file, f"contains no loadshare result: {error}")
    if not isinstance(document, dict) or "positions" not in document:
        _fail(file, "contains no loadshare result")
    if "refused" in document:
        message, hint = "contains a refusal, not a result", "The reason is under refused.message."
        raise ResultError([Problem(file, "", "", message, "", hint)], refusal=True)
    found = document.get("format", 1)
    if found not in (FORMAT, *OLDER) or isinstance(found, bool):
        writer = as_given(document.get("version"))
        newer = isinstance(found, int) and found > FORMAT
        hint = "Load it with that version, or a newer one." if newer else AGAIN
        forms = " and ".join(map(str, (*OLDER, FORMAT)))
        message = f"was written by loadshare {writer}; this is {__version__}, which reads {forms}"
        _fail(file, message, hint, ("format",), as_given(found))
    return document


@cache
def _reader() -> TypeAdapter[_File]:
    return TypeAdapter(_File)


def _read(text: str, file: str) -> _File:
    try:
        return _reader().validate_json(text, strict=True)
    except ValidationError as error:
        if error.error_count() > ALLOWED.problems:
            # A report of each would take a thousand times its room in the file.
            _fail(file, f"contains {error.error_count()} values that are not allowed there")
        raise ResultError(
            Problem(
                file,
                dotted(details["loc"]),
                "" if details["type"] == "missing" else as_given(details["input"]),
                f"{details['msg'][0].lower()}{details['msg'][1:]}",
                hint=AGAIN,
            )
            for details in error.errors(include_url=False)
        ) from None


def _machine(given: _File, file: str) -> tuple[Case, Train]:
    """Build the case of a file, and its train."""
    try:
        case = Case(given.input, name=given.stamp.case, origin=Origin(f"{file}: input"))
        if any(mesh.geometry or mesh.law_file for mesh in case.meshes.values()):
            _fail(file, "its meshes refer to other files", key=("input", "meshes"))
        train = build_train(case)
    except CaseError as error:
        raise ResultError(error.problems) from None
    if case.hash != given.stamp.case_hash:
        message = f"is not that of the case under input, {case.hash}"
        if given.stamp.version != __version__:
            message += f"; loadshare {given.stamp.version} wrote it, this is {__version__}"
        _fail(file, message, key=("stamp", "case_hash"), given=given.stamp.case_hash)
    return case, train


def _tolerance(given: _File, file: str) -> float:
    try:
        return checked_tolerance(given.stamp.tolerance)
    except ValueError as error:
        _fail(file, str(error), key=("stamp", "tolerance"))


def _wrong_positions(given: _File, train: Train) -> Iterator[Wrong]:
    """Yield positions that are missing, repeated, not requested, or not positions of the case."""
    requested, there = given.stamp.positions, [p.position for p in given.positions]
    if not requested:
        yield ("stamp", "positions"), "[]", "is empty", "the positions that were requested"
    wanted: set[int] = set()
    for at, index in enumerate(requested):
        if index in wanted:
            yield ("stamp", "positions", at), f"{index}", "appears twice", ""
        wanted.add(index)
    found: set[int] = set()
    for at, index in enumerate(there):
        path: Path = ("positions", at, "position")
        if not 1 <= index <= train.count:
            yield path, f"{index}", "is not a position of the case", f"1 to {train.count}"
        elif index in found:
            yield path, f"{index}", "appears twice", ""
        found.add(index)
    for what, some in (
        ("is missing", [k for k in requested if k not in found]),
        ("was not requested", [k for k in dict.fromkeys(there) if k not in wanted]),
    ):
        yield from ((("positions",), "", f"position {k} {what}", "") for k in some)


def _wrong_claims(given: _File, train: Train) -> Iterator[Wrong]:
    for at, p in enumerate(given.positions):
        for field, name, message in misnamed(train, p.claim):
            path: Path = ("positions", at, "claim", field, name)
            yield path if name else path[:-1], "", message, ""
        for field, name, value in oversized(p.claim):
            largest = f"numbers up to {ALLOWED.largest:g}"
            yield ("positions", at, "claim", field, name), f"{value:g}", "is too large", largest


def _positions(train: Train, given: Sequence[_Position], tolerance: float) -> list[Position]:
    """Certify the claims about positions, and return the positions that follow from them."""
    trains = [train_at(p.claim.train(train), p.position) for p in given]
    found = [p.claim.equilibrium(p.position, p.ranges) for p in given]
    positions = []
    for p, here, answer, certificate in zip(
        given, trains, found, certify_all(trains, found, tolerance), strict=True
    ):
        claimed = _Claimed(answer, certificate, p.effort)
        positions.append((here, p.position, p.claim.flank_force, claimed))
    return positions_of(positions)


def _uncertified(positions: Iterable[Position]) -> Iterator[Wrong]:
    """Yield positions whose claims are no equilibrium of the case, or too large to be valid."""
    for at, p in enumerate(positions):
        path: Path = ("positions", at, "claim")
        if not p.certificate.passed:
            failing = p.certificate.shortfall or "its torques are not bounded closely enough"
            message = (
                f"position {p.position} is not an equilibrium of the case under input: {failing}"
            )
            yield path, "", message, ""
        elif p.validity.refused:
            yield path, "", f"position {p.position}: {refusal_text(p.validity.refused)}", ""


def _wrong_slips(train: Train, positions: Iterable[Position]) -> Iterator[Wrong]:
    """Yield positions of a march that do not start from the slip at the end of the previous one."""
    after = {gear: np.zeros(3) for gear in train.splines}
    remembered = False
    for at, p in enumerate(positions):
        before = p.claim.slip
        path: Path = ("positions", at, "claim", "slip")
        if at > 0 and remembered != (before is not None):
            yield path, "", "some positions have a slip from before and some do not", ""
        if before is None:
            continue
        remembered = True
        if p.position != at + 1:
            yield path, "", f"a march does not begin at its step {p.position}", ""
        size = max((abs(u) for q in p.claim.displacement.values() for u in q), default=0.0)
        for gear, slip in before.items():
            off = float(np.abs(np.array(slip) - after[gear]).max())
            if off > ROUND_OFF * size + DIGITS * float(np.abs(after[gear]).max()):
                message = "is not the slip at the end of the previous step"
                yield (*path, gear), as_given(list(slip)), message, as_given(after[gear].tolist())
        after = {
            gear: train.slip_seen_next(gear, slip_of(spline, p.equilibrium), p.position)
            for gear, spline in train.splines.items()
        }


def _wrong_ranges(positions: Iterable[Position], train: Train) -> Iterator[Wrong]:
    """Yield ranges of undetermined coordinates that do not follow from the claim."""
    for at, p in enumerate(positions):
        scene = assemble(p.claim.train(train), p.position)
        ranges = ranges_of(p.equilibrium, scene)
        given, found, sizes = as_data(p.undetermined), as_data(ranges), _sizes(scene, p.equilibrium)
        for path, was, wrong, expected in differences(found, given, least=sizes):
            yield ("positions", at, "undetermined", *path), was, wrong, expected


def _sizes(scene: Scene, found: Equilibrium) -> dict[Path, float]:
    """Return the sizes of the terms from which ends of open coordinates are found by difference."""
    lengths = [*coordinates_of(scene, found), *(row.gap for row in scene.rows)]
    size = float(np.abs(lengths).max(initial=0.0))
    rates = {f"gear {gear} rotation": abs(r.rate) for gear, r in scene.rotation.items()}
    return {(name,): size * rates.get(name, 1.0) for name in found.undetermined}


def _elements(given: _File, train: Train) -> frozenset[str]:
    """Return names of elements, which are keys of tables in which all figures are of one kind."""
    found = {*train.gears, *train.meshes, *(s.name for s in train.stages)}
    for p in given.positions[:1]:
        found |= {key for f in fields(Claim) for key in getattr(p.claim, f.name) or ()}
    return frozenset(found)
