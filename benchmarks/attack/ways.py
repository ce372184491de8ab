"""Ways to tamper with an answer; each returns a claim that looks like an equilibrium, or None."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

import loadshare as ls
from benchmarks.attack.balance import Array, Balance
from benchmarks.attack.victims import Victim
from loadshare.case.keys import Path, dotted
from loadshare.contact.law import PowerLaw
from loadshare.results.claim import claim_of
from loadshare.train import build_train
from loadshare.train.equilibrium import Equilibrium

FIELDS = (
    "rotation",
    "displacement",
    "flank_force",
    "ring_force",
    "radial_reaction",
    "shaft_torque",
    "support_force",
)
SMALLEST, LARGEST = 1e-13, 1e-2
"""Range of sizes of self-stress and of moved forces, over the load."""
NUMBER = re.compile(r"\s*([-+0-9.eE]+)\s+(\S+)\s*")

Claim = Equilibrium | None
Way = Callable[[Victim, np.random.Generator], Claim]


def _spread(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a size between two limits, uniformly in its logarithm."""
    return float(10.0 ** rng.uniform(math.log10(low), math.log10(high)))


def _load(victim: Victim) -> float:
    """Return the largest flank force [N]."""
    return max(victim.answer.flank_force.values())


def a_number(victim: Victim, rng: np.random.Generator) -> Claim:
    """Change one claimed number by a fraction of 1e-12 to 1e-6."""
    there = [(f, n) for f in FIELDS for n in getattr(victim.answer, f)]
    field, name = there[rng.integers(len(there))]
    table = dict(getattr(victim.answer, field))
    factor = 1.0 + rng.choice([-1.0, 1.0]) * _spread(rng, 1e-12, 1e-6)
    value = np.array(table[name], dtype=float)
    at = rng.integers(value.size) if value.ndim else ()
    value[at] *= factor
    table[name] = value if value.ndim else float(value)
    changed: dict[str, Any] = {field: table}
    return replace(victim.answer, **changed)


def all_numbers(victim: Victim, rng: np.random.Generator) -> Claim:
    """Change every claimed number by a random fraction."""
    size = _spread(rng, 1e-12, 1e-6)
    fields: dict[str, Any] = {
        field: {
            name: value * (1.0 + size * rng.normal(size=np.shape(value)))
            for name, value in getattr(victim.answer, field).items()
        }
        for field in FIELDS
    }
    return replace(victim.answer, **fields)


def _stressed(victim: Victim, rng: np.random.Generator, more: Array, follow: bool) -> Equilibrium:
    balance = Balance(victim.train, victim.answer)
    found = balance.with_forces(more)
    return balance.followed(found, more) if follow else found


def _sized(victim: Victim, rng: np.random.Generator, direction: Array) -> Array:
    largest: float = np.abs(direction).max()
    return direction * _spread(rng, SMALLEST, LARGEST) * _load(victim) / largest


def self_stress(victim: Victim, rng: np.random.Generator) -> Claim:
    """Add a balanced self-stress of the acting forces; displacements stay."""
    return _self_stress(victim, rng, follow=False)


def self_stress_followed(victim: Victim, rng: np.random.Generator) -> Claim:
    """Add a balanced self-stress of the acting forces; displacements follow."""
    return _self_stress(victim, rng, follow=True)


def _self_stress(victim: Victim, rng: np.random.Generator, follow: bool) -> Claim:
    balance = Balance(victim.train, victim.answer)
    space = balance.null_space(balance.acting)
    if space.shape[1] == 0:
        return None
    direction = space @ rng.normal(size=space.shape[1])
    return _stressed(victim, rng, _sized(victim, rng, direction), follow)


def weakest_self_stress(victim: Victim, rng: np.random.Generator) -> Claim:
    """Add the self-stress that the laws resist least for its size; displacements follow.

    Stiff loops behind soft meshes hide most: this is the hardest to see.
    """
    balance = Balance(victim.train, victim.answer)
    space = balance.null_space(balance.acting)
    if space.shape[1] == 0:
        return None
    _, ways = np.linalg.eigh(space.T @ (balance.compliance[:, None] * space))
    more = _sized(victim, rng, space @ ways[:, rng.integers(len(ways))])
    return _stressed(victim, rng, more, follow=True)


def self_stress_of_everything(victim: Victim, rng: np.random.Generator) -> Claim:
    """Add a balanced self-stress of all forces, including those of open contacts."""
    balance = Balance(victim.train, victim.answer)
    space = balance.null_space(np.arange(len(balance.columns[0])))
    if space.shape[1] == 0:
        return None
    direction = space @ rng.normal(size=space.shape[1])
    return _stressed(victim, rng, _sized(victim, rng, direction), bool(rng.integers(2)))


def wrong_flank(victim: Victim, rng: np.random.Generator) -> Claim:
    """Change the forces of a mesh's flanks by a part of the largest; a flank may even pull."""
    forces = dict(victim.answer.flank_force)
    mesh = list(victim.train.meshes.values())[rng.integers(len(victim.train.meshes))]
    part = _spread(rng, SMALLEST, 1.0)
    names = [mesh.flank_name(d) for d in mesh.flanks]
    if len(names) == 1:
        forces[names[0]] *= 1.0 - 2.0 * part
    else:
        moved = part * max(forces[n] for n in names)
        sign = rng.choice([-1.0, 1.0])
        forces[names[0]] += moved
        forces[names[1]] += sign * moved
    return replace(victim.answer, flank_force=forces)


def _rebalanced(victim: Victim, column: int, change: float) -> Equilibrium | None:
    """Change one force [N] and balance it with the smallest change of the others."""
    balance = Balance(victim.train, victim.answer)
    some = np.union1d(balance.acting, [column])
    space = balance.null_space(some)
    weight = float(space[column] @ space[column])
    if weight < 1e-20:
        return None
    more = space @ (space[column] * change / weight)
    return balance.followed(balance.with_forces(more), more)


def dropped_contact(victim: Victim, rng: np.random.Generator) -> Claim:
    """Release a closed contact, wholly or in part; the others balance and displacements follow."""
    balance = Balance(victim.train, victim.answer)
    closed = [
        (k, getattr(victim.answer, c.field)[c.name])
        for k, c in enumerate(balance.columns[0])
        if c.field in ("flank_force", "ring_force") and c.acts
    ]
    column, force = closed[rng.integers(len(closed))]
    return _rebalanced(victim, column, -force * rng.choice([1.0, _spread(rng, 1e-12, 1.0)]))


def added_contact(victim: Victim, rng: np.random.Generator) -> Claim:
    """Add a force on an open contact; the others balance and displacements follow."""
    balance = Balance(victim.train, victim.answer)
    opened = [
        k
        for k, c in enumerate(balance.columns[0])
        if c.field in ("flank_force", "ring_force") and not c.acts
    ]
    if not opened:
        return None
    column = opened[rng.integers(len(opened))]
    return _rebalanced(victim, column, _spread(rng, SMALLEST, LARGEST) * _load(victim))


def wrong_stage(victim: Victim, rng: np.random.Generator) -> Claim:
    """Change the force of a spline or round ring, or the displacement of its gear."""
    names = {s.name: g for g, s in victim.train.splines.items()}
    names |= {r.name: r.gear for r in victim.train.rounds}
    if not names:
        return None
    name = list(names)[rng.integers(len(names))]
    balance = Balance(victim.train, victim.answer)
    columns = [k for k, c in enumerate(balance.columns[0]) if c.name == name]
    if rng.integers(2):
        return _rebalanced(
            victim,
            columns[rng.integers(2)],
            rng.choice([-1.0, 1.0]) * _spread(rng, SMALLEST, 1.0) * _load(victim),
        )
    gear, moved = names[name], dict(victim.answer.displacement)
    moved[gear] = moved[gear] * (1.0 + rng.choice([-1.0, 1.0]) * _spread(rng, 1e-12, 1.0))
    return replace(victim.answer, displacement=moved)


def another_case(victim: Victim, rng: np.random.Generator) -> Claim:
    """Claim the certified answer of a case in which one input is slightly different."""
    keys = list(_quantities(victim.case.to_dict()))
    path, text = keys[rng.integers(len(keys))]
    number, unit = NUMBER.fullmatch(text).groups()  # type: ignore[union-attr]
    factor = 1.0 + rng.choice([-1.0, 1.0]) * _spread(rng, 1e-13, 1e-2)
    try:
        changed = victim.case.replace({dotted(path): f"{float(number) * float(factor)!r} {unit}"})
        found = ls.explain(changed, victim.answer.index)
    except (ls.CaseError, ls.Refused):
        return None
    there = build_train(changed)
    claim = claim_of(there, found.equilibrium)
    return claim.equilibrium(victim.answer.index, found.equilibrium.undetermined)


def _quantities(data: Any, path: Path = ()) -> Iterator[tuple[Path, str]]:
    if isinstance(data, Mapping):
        for key, value in data.items():
            if path or key not in ("title", "source", "notes", "study", "measured"):
                yield from _quantities(value, (*path, key))
    elif isinstance(data, list):
        for at, value in enumerate(data):
            yield from _quantities(value, (*path, at))
    elif isinstance(data, str) and (match := NUMBER.fullmatch(data)):
        try:
            if float(match[1]) != 0.0:
                yield path, data
        except ValueError:
            return


def another_load(victim: Victim, rng: np.random.Generator) -> Claim:
    """Scale all forces and displacements: another load's answer if laws are linear, gaps zero."""
    factor = 1.0 + rng.choice([-1.0, 1.0]) * _spread(rng, 1e-12, 1e-3)
    laws = (law for mesh in victim.train.meshes.values() for law in mesh.laws)
    if rng.integers(2) and all(isinstance(law, PowerLaw) and law.is_linear for law in laws):
        # The external torque is then the only thing that disagrees.
        factor = 1.0 + (factor - 1.0) * 1e-2
    fields: dict[str, Any] = {
        field: {name: value * factor for name, value in getattr(victim.answer, field).items()}
        for field in FIELDS
    }
    return replace(victim.answer, **fields)


WAYS: dict[str, tuple[Way, float]] = {
    "one number": (a_number, 2.0),
    "all numbers": (all_numbers, 0.5),
    "self-stress": (self_stress, 1.0),
    "self-stress, displacements follow": (self_stress_followed, 1.5),
    "weakest self-stress, displacements follow": (weakest_self_stress, 1.5),
    "self-stress of open contacts too": (self_stress_of_everything, 0.5),
    "wrong flank": (wrong_flank, 0.5),
    "wrong slip state": (wrong_stage, 0.5),
    "contact dropped": (dropped_contact, 0.5),
    "contact added": (added_contact, 0.5),
    "another case's answer": (another_case, 0.7),
    "another load": (another_load, 0.3),
}
"""Ways of tampering by what they do, each with the relative frequency at which it is tried."""
