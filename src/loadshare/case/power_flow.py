"""Which way the torque runs through the meshes: along their names, or against them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from loadshare.case.links import Shaft
from loadshare.case.meshes import Mesh
from loadshare.case.operation import Operating

Steps = list[tuple[str, str]]


def steps(meshes: Mapping[str, Mesh], shafts: Mapping[str, Shaft]) -> Steps:
    """Return the steps of the torque: driver to driven over meshes, either way over shafts."""
    found = [(mesh.driver, mesh.driven) for mesh in meshes.values()]
    for a, b in (shaft.ends for shaft in shafts.values()):
        found += [(a, b), (b, a)]
    return found


def reach(sources: Iterable[str], taken: Steps) -> set[str]:
    """Return the gears that steps lead to, the sources among them."""
    reached, fresh = set(sources), set(sources)
    while fresh:
        fresh = {b for a, b in taken if a in fresh and b not in reached}
        reached |= fresh
    return reached


def backwards(taken: Steps) -> Steps:
    """Return the same steps the other way."""
    return [(b, a) for a, b in taken]


def from_the_other_end(
    operating: Operating, meshes: Mapping[str, Mesh], shafts: Mapping[str, Shaft]
) -> bool:
    """Tell whether the input stands where the meshes' names put the output."""
    forward = steps(meshes, shafts)
    ahead, behind = reach([operating.input], forward), reach([operating.input], backwards(forward))
    return operating.output not in ahead and operating.output in behind


def against_the_names(
    operating: Operating, meshes: Mapping[str, Mesh], shafts: Mapping[str, Shaft]
) -> tuple[bool, ...]:
    """Tell for every input torque whether it presses the flanks that the meshes' names do not.

    It does where the torque is negative (the input brakes), and where the input stands at the other
    end; both together press the usual flanks.
    """
    turned = from_the_other_end(operating, meshes, shafts)
    return tuple((torque < 0.0) != turned for torque in operating.input_torque if torque)
