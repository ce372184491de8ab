"""Meshes that name a pair file, a law file or a method, turned into meshes with their law."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from contextlib import suppress
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.case.checks.fit import mm
from loadshare.case.checks.law_origin import teeth_digest
from loadshare.case.content import ABOUT
from loadshare.case.keys import Path as KeyPath
from loadshare.case.keys import covers, dotted, parse
from loadshare.case.line_of_action import facing, mesh_distance
from loadshare.case.meshes import SOURCES
from loadshare.case.recent import Recent
from loadshare.errors import CaseError, Problem
from loadshare.input import Unreadable, read_file, real
from loadshare.involute import distance_without_backlash
from loadshare.numbers import counted
from loadshare.progress import Progress
from loadshare.settings import ALLOWED

if TYPE_CHECKING:
    from loadshare.case import Case, Gear
    from loadshare.tooth.law.file import MeshLaw
    from loadshare.tooth.pair.file import PairFile

Problems = dict[Problem, None]
"""Problems, as keys: one that several meshes share is reported once."""

APART = 0.1
"""Difference from the centre distance without backlash that needs no hint, in modules."""
OF_A_MESH = ("rated_torque", "pressure_angle", "helix_angle")
"""Keys of a mesh that affect its law."""


def affects_laws(path: KeyPath) -> bool:
    """Return whether computed laws may depend on what is at a key path, or a pattern.

    It is true as well if a file that a law comes from must agree with that.
    """
    section, key = (str(path[k]) if k < len(path) else "" for k in (0, 2))
    if fnmatchcase("meshes", section):
        return any(fnmatchcase(known, key) for known in OF_A_MESH)
    return fnmatchcase("gears", section) or path == ("operating", "positions")


def resolve(case: Case, progress: Progress | None = None, leave: Collection[str] = ()) -> Case:
    """Replace `geometry`, `law_file` and keywords for `law` of the meshes of a case by numbers.

    Laws of pairs are computed at the positions of the case, once for each pair file, and kept on
    disk (:mod:`loadshare.tooth.law.folder`). File names are relative to the file that gives them.

    Parameters
    ----------
    case : Case
    progress : callable, optional
        Called after each computed position with the number done and the total.
    leave : collection of str
        Meshes whose keyword for `law`, or file name, stays as it is.

    Returns
    -------
    Case
        The same object if all laws are numbers.

    Raises
    ------
    CaseError
        With all problems of the files, and everything in which the case differs from their gears.
    Refused
        If a position of a pair has no certified contact.
    """
    sources = {
        name: source
        for name, mesh in case.meshes.items()
        for source in mesh.given(*SOURCES)
        if name not in leave
    }
    words = [n for n, m in case.meshes.items() if isinstance(m.law, str) and n not in leave]
    if not sources and not words:
        return case
    contents = tuple(map(_content, case.law_files))
    known = None if leave else _with_known_laws(case, contents)
    if known is not None:
        return known
    problems: Problems = {}
    laws, pairs = _read(case, sources, problems)
    of_contact = [name for name in words if case.meshes[name].law_is_of_contact]
    inline, taken = _inline(case, of_contact, problems)
    formulas = _by_formula(case, [name for name in words if name not in taken], problems)
    if problems:
        raise CaseError(list(problems))
    pairs |= inline
    by_hash = _laws({pair.hash: pair for pair in pairs.values()}, progress)
    laws |= {name: by_hash[pair.hash] for name, pair in pairs.items()}
    found = {name: law.as_law(taken.get(name, ())) for name, law in laws.items()} | formulas
    centres = case.centres()
    for name, law in found.items():
        law["teeth"] = teeth_digest(case.meshes[name], case.gears, centres)
    changes: dict[str, object] = {
        **{dotted(("meshes", name, source)): None for name, source in sources.items()},
        **{dotted(("meshes", name, "law")): law for name, law in found.items()},
    }
    for name in inline:
        if case.meshes[name].rated_torque is not None:
            changes[dotted(("meshes", name, "rated_torque"))] = None
    assumed = _still_assumed([*case.assumed, *(dotted(("meshes", name, "law")) for name in inline)])
    if assumed:
        changes["assumed"] = assumed
    solved = case.replace(changes)
    return solved if leave else _recent.keep(case, (case, contents, solved))[2]


_recent: Recent[tuple[Case, tuple[bytes | None, ...], Case]] = Recent()
"""Cases, the content of the files that their laws come from, and the same with laws as numbers."""


def _with_known_laws(case: Case, contents: tuple[bytes | None, ...]) -> Case | None:
    """Return a case with the laws of a recent one that differs in nothing which affects them."""
    for before, known, solved in _recent:
        changes = case.changes_since(before) if known == contents else None
        if changes is not None and not any(map(_may_affect_laws, changes)):
            return solved.replace({dotted(path): value for path, value in changes.items()})
    return None


def _may_affect_laws(path: KeyPath) -> bool:
    return path[0] in (*ABOUT, "gears", "meshes") or affects_laws(path)


def _content(file: Path) -> bytes | None:
    """Return the content of a file; None if it cannot be read."""
    try:
        return read_file(file, ALLOWED.bytes)
    except (OSError, Unreadable):
        return None


def with_own_laws(case: Case, varied: Iterable[KeyPath]) -> Case:
    """Return a case in which laws with a varied number are numbers, detached from the teeth.

    Parameters
    ----------
    case : Case
    varied : iterable of tuple of str or int
        Paths and patterns of what varies.
    """
    numbers = [path[:3] for path in varied if len(path) > 3 and covers(path[:1], ("meshes",))]
    own = {m for m in case.meshes if any(covers(p, ("meshes", m, "law")) for p in numbers)}
    solved = resolve(case, leave=case.meshes.keys() - own)
    laws = {name: solved.meshes[name].power_law for name in own}
    origin = {
        dotted(("meshes", name, "law", key)): None
        for name, law in laws.items()
        for key in ("basis", "teeth")
        if law and getattr(law, key)
    }
    return solved.replace(origin) if origin else solved


def written_in(case: Case, folders: Iterable[Path] | None = None) -> Case:
    """Return a case in a form that can be written into any of some folders, or anywhere.

    A law whose file would not be found from there becomes numbers; every other stays as it is, so
    that it follows the next change of teeth.

    Parameters
    ----------
    case : Case
    folders : iterable of Path, optional
        By default it may be written anywhere, and no file is found from there.

    Raises
    ------
    CaseError, Refused
        As in `resolve`.
    """
    places = None if folders is None else list(folders)

    def lost(name: str) -> bool:
        for source in case.meshes[name].given(*SOURCES):
            own = Path(case.problem(("meshes", name, source), "").file).parent
            named = getattr(case.meshes[name], source)
            files = {real(place / named) for place in places or ()}
            return places is None or files != {real(own / named)}
        return False

    return resolve(case, leave={name for name in case.meshes if not lost(name)})


def _inline(
    case: Case, names: Sequence[str], problems: Problems
) -> tuple[dict[str, PairFile], dict[str, tuple[str, ...]]]:
    """Return the pairs of meshes whose law is computed from their gears, and what they assume.

    What an analysis assumes marks the law as assumed.
    """
    if not names:
        return {}, {}
    from loadshare.tooth.law.inline import assumed_of, inline_pair

    pairs: dict[str, PairFile] = {}
    for name in names:
        try:
            pairs[name] = inline_pair(case, name)
        except CaseError as error:
            problems |= dict.fromkeys(error.problems)
    return pairs, {n: assumed_of(case, n, pairs[n]) if n in pairs else () for n in names}


def _read(
    case: Case, sources: dict[str, str], problems: Problems
) -> tuple[dict[str, MeshLaw], dict[str, PairFile]]:
    """Return laws and pairs by mesh; add problems of their files, and where these differ."""
    from loadshare.tooth.law.file import load_law
    from loadshare.tooth.pair.agree import disagreements
    from loadshare.tooth.pair.file import load_pair
    from loadshare.tooth.pair.gears import gears_of

    laws: dict[str, MeshLaw] = {}
    pairs: dict[str, PairFile] = {}
    positions = case.operating.positions
    known: dict[Path, PairFile] = {}
    for name, source in sources.items():
        key = dotted(("meshes", name, source))
        place = case.problem(key, "there is no such file")
        file = Path(place.file).parent / getattr(case.meshes[name], source)
        outside = case.outside_problem(key, file)
        if outside is not None or not file.is_file():
            problems[outside or place] = None
            continue
        try:
            if source == "law_file":
                laws[name] = load_law(file)
                gears, found = laws[name].computed.gears, laws[name].computed.positions
                if gears is not None:
                    problems |= dict.fromkeys(disagreements(case, name, gears, file.name))
                if found != positions:
                    message = (
                        f"has {counted(found, 'position')}, but operating.positions is {positions}"
                    )
                    hint = f"Write it again: loadshare ltca PAIR.toml --positions {positions}."
                    problems[case.problem(key, message, "", hint)] = None
            else:
                if file not in known:
                    known[file] = load_pair(file).revised(positions=positions)
                pairs[name] = known[file]
                gears = gears_of(pairs[name].geometry)
                problems |= dict.fromkeys(disagreements(case, name, gears, pairs[name].name))
        except CaseError as error:
            problems |= dict.fromkeys(error.problems)
    return laws, pairs


def _by_formula(case: Case, names: Iterable[str], problems: Problems) -> dict[str, dict[str, Any]]:
    """Return laws by formula, at the driver, by mesh."""
    from loadshare.tooth.law.iso6336 import basis_of, least_torque, mesh_stiffness

    centres = case.centres()
    found: dict[str, dict[str, Any]] = {}
    for name in names:
        mesh = case.meshes[name]
        measured = mesh.law == "iso"
        pair = facing(mesh, case.gears, centres)
        distance = mesh_distance(mesh, case.gears, centres)
        try:
            stiffness = mesh_stiffness(pair, distance, measured=measured)
        except ValueError as error:
            path, hint = ("meshes", name, "law"), _distance_hint(pair, distance)
            problems[case.problem(path, str(error), hint=hint)] = None
            continue
        compliance = 1.0 / (stiffness * pair[0].acting_radius ** 2)
        found[name] = {
            "b": f"{compliance!r} rad/(N*m)",
            "basis": basis_of(pair, distance, measured=measured),
            "holds_from": f"{least_torque(pair)!r} N*m",
        }
    return found


def _distance_hint(pair: tuple[Gear, Gear], distance: float) -> str:
    """Say which centre distance [m] has no backlash, if that of two gears is far from it."""
    one, two = pair[0].tooth, pair[1].tooth
    if one is None or two is None:
        return ""
    with suppress(ValueError):
        fits = distance_without_backlash(one, two)
        if abs(fits - distance) > APART * one.module:
            return f"The centres are {mm(distance)} apart; without backlash it would be {mm(fits)}."
    return ""


def _laws(pairs: dict[str, PairFile], progress: Progress | None) -> dict[str, MeshLaw]:
    """Return laws by the hash of their pair: from the cache or, if not there, computed."""
    from loadshare.tooth.law.folder import computed_law, known_law

    laws = {key: law for key, pair in pairs.items() if (law := known_law(pair)) is not None}
    missing = {key: pair for key, pair in pairs.items() if key not in laws}
    before, total = 0, sum(pair.analysis.positions for pair in missing.values())
    for key, pair in missing.items():
        laws[key] = computed_law(pair, _from(progress, before, total))
        before += pair.analysis.positions
    return laws


def _from(progress: Progress | None, before: int, total: int) -> Progress | None:
    """Return a callback that counts the progress of one pair as that of all."""
    if progress is None:
        return None
    tell = progress
    return lambda done, _: tell(before + done, total)


def _still_assumed(patterns: Iterable[str]) -> list[str]:
    """Return the patterns of `assumed`, with those of files moved to the laws that replace them."""
    found: dict[str, None] = {}
    for pattern in patterns:
        last = parse(pattern)[-1]
        moved = last in SOURCES
        found[pattern.removesuffix(str(last)) + "law" if moved else pattern] = None
    return list(found)
