"""Generated trains: cases of one structure and any number of branches.

``python -m benchmarks.families cases`` writes the ones that are shipped.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from loadshare.case.model import Case

SHIPPED: dict[str, Callable[[], Case]] = {
    "branches/split_torque_2": lambda: split_torque(2),
    "branches/split_torque_6": lambda: split_torque(6),
    "branches/split_torque_8": lambda: split_torque(8),
    "star/floating_sun_3": lambda: star(3),
    "star/floating_sun_4": lambda: star(4),
    "star/floating_sun_5": lambda: star(5),
    "star/floating_sun_6": lambda: star(6),
    "two_path/clocking_error": lambda: two_path("0.0012 rad"),
}
"""The generated cases in the repository, by path below its folder of cases."""


def split_torque(branches: int) -> Case:
    """Return a split-torque train with face gears, like the seed's but with any number of branches.

    A pinion drives half as many face gears as there are branches; from each, a shaft drives a
    pinion, which drives two idlers of the output gear. The radii are those of the four-branch case;
    the output gear is larger if its idlers would not fit around it.

    Parameters
    ----------
    branches : int
        Number of branches, even.

    Returns
    -------
    Case
        The train, without errors and floats.

    Raises
    ------
    ValueError
        If the number is not even and positive.
    """
    if branches < 2 or branches % 2:
        raise ValueError(f"branches = {branches}: an even number of at least 2 is needed")
    input_, face, pinion, idler = 0.040, 0.2227792, 0.0459, 0.11475
    face_angle, angle = math.radians(20.0), math.radians(18.75)
    pairs = branches // 2
    circle = _idler_circle(pairs, 0.3829862 + idler, pinion + idler, idler) / math.cos(angle)
    half = math.asin((pinion + idler) / math.cos(angle) / circle)
    radial, along = input_ / math.cos(face_angle), 0.430847
    depth = 1.0

    gears: dict[str, Any] = {
        "in": {"centre": ["0 mm", "0 mm", _mm(-depth)], "base_radius": _mm(input_)},
    }
    meshes: dict[str, Any] = {}
    shafts: dict[str, Any] = {}
    for number in range(1, pairs + 1):
        turn = math.tau * (number - 1) / pairs
        way = (math.cos(turn), math.sin(turn))
        gears[f"face{number}"] = {
            "type": "face",
            "centre": [_mm(radial * way[0]), _mm(radial * way[1]), _mm(along - depth)],
            "axis": [round(way[0], 12) + 0.0, round(way[1], 12) + 0.0, 0.0],
            "base_radius": _mm(face),
        }
        gears[f"pinion{number}"] = {
            "centre": _polar(circle * math.cos(half), turn),
            "base_radius": _mm(pinion),
        }
        meshes[f"in-face{number}"] = _mesh(face_angle, "8.365e5 N*m/rad")
        shafts[f"face{number}-pinion{number}"] = {"stiffness": "5e5 N*m/rad"}
        for side, offset in (("a", -half), ("b", half)):
            name = f"idler{number}{side}"
            gears[name] = {"centre": _polar(circle, turn + offset), "base_radius": _mm(idler)}
            meshes[f"pinion{number}-{name}"] = _mesh(angle, "4.275e6 N*m/rad")
            meshes[f"{name}-out"] = _mesh(angle, "6.425e6 N*m/rad")
    gears["out"] = {
        "centre": ["0 mm", "0 mm"],
        "base_radius": _mm(circle * math.cos(angle) - idler),
    }
    groups = [[f"idler{n}a-out", f"idler{n}b-out"] for n in range(1, pairs + 1)]
    return Case(
        name=f"split_torque_{branches}",
        title=f"Split-torque train with face gears and {branches} branches",
        source="Generated; radii and stiffnesses as in the four-branch case",
        notes=(
            "A test of generality, not hardware: the shafts are not coaxial with the gears they "
            "join, so each would need a constant-velocity joint, and the discs of the face gears "
            "would cross."
        ),
        assumed=[
            "gears.*.base_radius",
            "gears.*.centre",
            "meshes.*.pressure_angle",
            "meshes.*.stiffness",
            "shafts.*.stiffness",
        ],
        operating={
            "input": "in",
            "output": "out",
            "power": f"{500 * branches} kW",
            "speed": "8780 rpm",
        },
        gears=gears,
        meshes=meshes,
        shafts=shafts,
        stages={
            "I": {"meshes": [f"in-face{n}" for n in range(1, pairs + 1)]},
            "II": {"meshes": [mesh for group in groups for mesh in group], "groups": groups},
        },
    )


def star(planets: int, floating: bool = True) -> Case:
    """Return a star: a sun, planets on fixed centres, and an internal gear as the output.

    Parameters
    ----------
    planets : int
        Number of planets, from 2 to 6.
    floating : bool
        Whether the sun floats freely.

    Returns
    -------
    Case
        The train, with a gap on the mesh of the sun with the first planet.

    Raises
    ------
    ValueError
        If the planets do not fit.
    """
    if not 2 <= planets <= 6:
        raise ValueError(f"planets = {planets}: between 2 and 6 fit around the sun")
    module, angle = 0.003, math.radians(20.0)
    teeth = {"sun": 36, "planet": 24, "ring": 84}
    radius = {name: count * module / 2 * math.cos(angle) for name, count in teeth.items()}
    centre = (teeth["sun"] + teeth["planet"]) * module / 2
    numbers = range(1, planets + 1)

    def gear(kind: str, **more: Any) -> dict[str, Any]:
        return {"base_radius": _mm(radius[kind]), "teeth": teeth[kind], **more}

    middle = ["0 mm", "0 mm"]
    gears = {"sun": gear("sun", centre=middle, support="free" if floating else "rigid")}
    for number in numbers:
        place = _polar(centre, math.tau * (number - 1) / planets)
        gears[f"planet{number}"] = gear("planet", centre=place)
    gears["ring"] = gear("ring", centre=middle, type="internal")
    sun_meshes = [f"sun-planet{number}" for number in numbers]
    ring_meshes = [f"planet{number}-ring" for number in numbers]
    meshes = {name: _mesh(angle, "1.4e6 N*m/rad") for name in sun_meshes}
    meshes |= {name: _mesh(angle, "7.5e5 N*m/rad") for name in ring_meshes}
    meshes["sun-planet1"]["gap"] = "0.4 mrad"
    kind = "floating" if floating else "fixed"
    return Case(
        name=f"{kind}_sun_{planets}",
        title=f"Star with {planets} planets and a {kind} sun",
        source="Generated; for the closed form of the load sharing of equally spaced planets",
        assumed=["gears", "meshes", "operating"],
        operating={"input": "sun", "output": "ring", "torque": "1000 N*m"},
        gears=gears,
        meshes=meshes,
        stages={"I": {"meshes": sun_meshes}, "II": {"meshes": ring_meshes}},
    )


def two_path(clocking: Any) -> Case:
    """Return a split-path box: one input pinion, two compound shafts, one output gear.

    Parameters
    ----------
    clocking : str or Quantity
        Clocking error of path A [angle]; a positive one reduces the torque of this path.

    Returns
    -------
    Case
        The train.
    """
    angle = math.radians(20.0)
    first, wheel, second, output = 0.0256, 0.0992, 0.03375, 0.22
    # The compound shafts are as far apart as their wheels require.
    half = 1.06 * wheel
    along = math.sqrt((first + wheel) ** 2 - half**2)
    beyond = along + math.sqrt((second + output) ** 2 - half**2)

    def gear(radius: float, x: float, y: float, z: float) -> dict[str, Any]:
        return {"centre": [_mm(x), _mm(y), _mm(z)], "base_radius": _mm(radius * math.cos(angle))}

    gears = {"in": gear(first, 0.0, 0.0, 0.0)}
    meshes: dict[str, Any] = {}
    for path, side in (("A", half), ("B", -half)):
        gears[f"wheel{path}"] = gear(wheel, along, side, 0.0)
        gears[f"pinion{path}"] = gear(second, along, side, 0.1)
        meshes[f"in-wheel{path}"] = _mesh(angle, "1.7e5 N*m/rad")
        meshes[f"pinion{path}-out"] = _mesh(angle, "4e5 N*m/rad")
    gears["out"] = gear(output, beyond, 0.0, 0.1)
    stiffness = {"stiffness": "8e4 N*m/rad"}
    return Case(
        name="clocking_error",
        title="Split-path box with a clocking error",
        source="Generated; torque and clocking as in the NASA split-path tests, ADA314767",
        notes="The geometry and the stiffnesses are not those of the tested box.",
        assumed=["gears", "meshes", "shafts.*.stiffness"],
        operating={"input": "in", "output": "out", "torque": "367 N*m"},
        gears=gears,
        meshes=meshes,
        shafts={"wheelA-pinionA": {**stiffness, "clocking": clocking}, "wheelB-pinionB": stiffness},
        stages={
            "I": {"meshes": ["in-wheelA", "in-wheelB"]},
            "II": {"meshes": ["pinionA-out", "pinionB-out"]},
        },
    )


def shipped_text(key: str) -> str:
    """Return a generated case as the text of its shipped file.

    Parameters
    ----------
    key : str
        One of `SHIPPED`.

    Returns
    -------
    str
        TOML, with a comment on its origin.
    """
    head = "Generated by `python -m benchmarks.families cases`: edit the generator instead."
    return f"# {head}\n\n{SHIPPED[key]().to_toml()}"


def write_shipped(folder: Path) -> None:
    """Write the generated cases of the repository.

    Parameters
    ----------
    folder : pathlib.Path
        Folder of cases of the repository.
    """
    for key in SHIPPED:
        path = folder / f"{key}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(shipped_text(key), encoding="utf-8")


def _idler_circle(pairs: int, seed: float, reach: float, idler: float) -> float:
    """Return the radius of the idlers' circle, times the cosine of the pressure angle [m].

    From 1.1 idler ≤ circle · sin(π/pairs − ψ), which keeps the idlers of neighbouring pairs apart,
    with sin ψ = reach/circle, which puts each pinion on the line between its idlers.
    """
    if pairs == 1:
        return seed
    # A tenth more than the pitch circles leaves room for the teeth.
    room = 1.1 * idler
    share = math.pi / pairs
    needed = math.hypot(reach, (room + reach * math.cos(share)) / math.sin(share))
    return max(seed, needed)


def _mesh(angle: float, stiffness: str) -> dict[str, Any]:
    return {"pressure_angle": f"{math.degrees(angle):.6g} deg", "stiffness": stiffness}


def _polar(distance: float, angle: float) -> dict[str, str]:
    return {"distance": _mm(distance), "angle": f"{math.degrees(angle):.9g} deg"}


def _mm(length: float) -> str:
    # Adding 0 turns the -0 that a cosine may give into 0.
    return f"{round(1e3 * length, 6) + 0.0:.9g} mm"


if __name__ == "__main__":
    write_shipped(Path(sys.argv[1]))
