"""Names must lead somewhere, and pairs must be two."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.gears import Polar
from loadshare.case.keys import Path, look_up
from loadshare.case.links import Backlashes
from loadshare.case.words import choices, did_you_mean
from loadshare.errors import Problem

GEAR_KEYS: tuple[Path, ...] = (
    ("gears", "centre", "about"),
    ("meshes", "driver"),
    ("meshes", "driven"),
    ("shafts", "ends"),
    ("rings", "neighbours"),
    ("operating", "input"),
    ("operating", "output"),
    ("march", "gear"),
)
MESH_KEYS: tuple[Path, ...] = (
    ("rings", "float", "upward"),
    ("rings", "float", "downward"),
    ("stages", "meshes"),
)


def check_gear_names(draft: Draft) -> Iterator[Problem]:
    """Yield every mention of a gear that does not exist."""
    gears = draft.names("gears")
    for path, name in _gears_named(draft):
        if gears and name and name not in gears:
            hint = did_you_mean(name, gears)
            yield draft.problem(path, f'"{name}" is not a gear', choices(gears), hint)


def check_mesh_names(draft: Draft) -> Iterator[Problem]:
    """Yield every mention of a mesh that does not exist."""
    meshes = draft.names("meshes")
    for path, name in _meshes_named(draft):
        if meshes and name not in meshes:
            hint = did_you_mean(name, meshes)
            yield draft.problem(path, f'"{name}" is not a mesh', choices(meshes), hint)


def check_about_circles(draft: Draft) -> Iterator[Problem]:
    """Yield centres that are given, over others, from themselves."""
    about = {
        name: gear.centre.about
        for name, gear in draft.gears.items()
        if isinstance(gear.centre, Polar) and gear.centre.about is not None
    }
    told: set[str] = set()
    for name in about:
        chain = [name]
        while (pole := about.get(chain[-1])) is not None and pole not in chain:
            chain.append(pole)
        if pole == name and name not in told:
            told.update(chain)
            circle = " → ".join((*chain, name))
            yield draft.problem(("gears", name, "centre", "about"), f"closes a circle: {circle}")


def check_pairs(draft: Draft) -> Iterator[Problem]:
    """Yield meshes and shafts of a gear with itself, and pairs that mesh twice."""
    seen: dict[frozenset[str], str] = {}
    for name, mesh in draft.meshes.items():
        pair = frozenset((mesh.driver, mesh.driven))
        if mesh.driver and len(pair) == 1:
            yield draft.problem(("meshes", name), "a gear cannot mesh with itself")
        elif pair in seen:
            message = f'joins the same gears as "{seen[pair]}"'
            yield draft.problem(("meshes", name), message, hint="Drop one of the two.")
        elif mesh.driver:
            seen[pair] = name
    for name, shaft in draft.shafts.items():
        if shaft.ends[0] and shaft.ends[0] == shaft.ends[1]:
            yield draft.problem(("shafts", name), "a shaft cannot join a gear to itself")


def _gears_named(draft: Draft) -> Iterator[tuple[Path, str]]:
    for name, gear in draft.gears.items():
        if isinstance(gear.centre, Polar) and gear.centre.about is not None:
            yield ("gears", name, "centre", "about"), gear.centre.about
    for name, mesh in draft.meshes.items():
        yield _told(draft, ("meshes", name), "driver"), mesh.driver
        yield _told(draft, ("meshes", name), "driven"), mesh.driven
    for name, shaft in draft.shafts.items():
        for end in shaft.ends:
            yield _told(draft, ("shafts", name), "ends"), end
    for section in ("splines", "rings", "errors"):
        for name in draft.names(section):
            yield (section, name), name
    for name, ring in draft.rings.items():
        for number, neighbour in enumerate(ring.neighbours or ()):
            yield ("rings", name, "neighbours", number), neighbour
    if draft.operating is not None:
        yield ("operating", "input"), draft.operating.input
        yield ("operating", "output"), draft.operating.output
        for name in draft.operating.external:
            yield ("operating", "external", name), name
    if draft.march is not None:
        yield ("march", "gear"), draft.march.gear
    for path in _unread(draft, GEAR_KEYS):
        yield from _texts(draft, path)


def _told(draft: Draft, path: Path, key: str) -> Path:
    """Return where a gear was told: in a key, or else in the element's name."""
    return (*path, key) if draft.has((*path, key)) else path


def _meshes_named(draft: Draft) -> Iterator[tuple[Path, str]]:
    for name, ring in draft.rings.items():
        if isinstance(ring.float_, Backlashes):
            for side in ("upward", "downward"):
                for number, mesh in enumerate(getattr(ring.float_, side)):
                    yield ("rings", name, "float", side, number), mesh
    for name, stage in draft.stages.items():
        for number, mesh in enumerate(stage.meshes):
            yield ("stages", name, "meshes", number), mesh
    for path in _unread(draft, MESH_KEYS):
        yield from _texts(draft, path)


def _unread(draft: Draft, keys: tuple[Path, ...]) -> Iterator[Path]:
    """Yield the keys that name others in elements with a problem, which must not hide theirs."""
    for section, *rest in keys:
        section = str(section)
        valid = getattr(draft, section)
        if section in ("operating", "march"):
            if valid is None and section in draft.data:
                yield (section, *rest)
            continue
        for name in draft.names(section):
            if name not in valid:
                yield (section, name, *rest)


def _texts(draft: Draft, path: Path) -> Iterator[tuple[Path, str]]:
    """Yield a text, or the texts of a list, with their places; nothing for what is neither."""
    value = look_up(draft.data, path)
    if isinstance(value, str):
        yield path, value
    elif isinstance(value, list):
        yield from (((*path, k), v) for k, v in enumerate(value) if isinstance(v, str))
