"""Newton's method on a fixed active set, and the exchange of elements with wrong signs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from operator import mul
from typing import Any

from benchmarks.reference.elements import Contact, Graph
from benchmarks.reference.elimination import Contradiction, solve_sparse
from benchmarks.reference.equations import (
    CURVED,
    Equations,
    Guess,
    offset,
    on_piece,
    pinned,
)
from benchmarks.reference.machine import Machine

ROUNDING = 1e-9
"""Imbalance along a free direction, over the load, that the rounding of a case's figures explains.
"""
NOWHERE = 1e10
"""Displacement, in deflections under the load, so large that only a rounded direction explains it.
"""
WANING = 1000
"""Divisor of the force of a flank with a Hertz law when a Newton step would make it negative. Its
compliance is infinite at zero force, so the force may only approach zero; there are 45 digits to
go."""
STEPS = 60
"""Most Newton steps on one active set."""


class NoReference(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """There is no reference for a problem; the message says why."""


@dataclass(frozen=True, slots=True)
class Settled:
    """Answer on an active set, its largest residual, null vectors, and imbalance along them."""

    at: Guess
    residual: Any
    free: tuple[tuple[Any, ...], ...]
    imbalance: Any = 0


def settle(machine: Machine, guess: Guess, tolerance: Any, nothing: Any) -> Settled:
    """Exchange until every sign is right.

    Parameters
    ----------
    machine : Machine
    guess : Guess
    tolerance : number
        Residual, and violation of a sign, that counts as zero.
    nothing : number
        Pivot that counts as zero.

    Raises
    ------
    NoReference
        If the exchange does not end, or an active set has no answer.
    """
    seen: set[tuple[Any, ...]] = set()
    one_only = False
    for _ in range(60 + 8 * len(machine.contacts)):
        settled = _newton(machine, guess, tolerance, nothing)
        wrong = _wrong(machine, settled.at, tolerance)
        if not wrong:
            if settled.residual > tolerance:
                raise NoReference(f"Newton's method stays at {float(settled.residual):.1e}")
            return settled
        key = (frozenset(guess.forces), tuple(sorted(guess.places.items())))
        one_only = one_only or key in seen
        seen.add(key)
        guess = _exchanged(settled.at, wrong[:1] if one_only else wrong, machine)
    raise NoReference("the exchange of active sets did not end")


def _newton(machine: Machine, guess: Guess, tolerance: Any, nothing: Any) -> Settled:
    """Apply Newton's method; directions that the train's own rounding leaves free are held fixed.

    A free pinion between two flanks is in balance only as far as their normals are opposite, and
    normals in doubles are opposite to 1e-12. Such a direction shows as a null vector of
    contradictory equations, or as a huge displacement at which round-off would be in balance. It
    then gets a tie at the position of the guess; the force of the tie is that rounding.
    """
    zero = machine.arithmetic.mpf(0)
    spans: list[list[Any]] = []
    fault: Contradiction | None = None
    for _ in range(machine.size):
        held = [
            ({i: v for i, v in enumerate(s) if v}, sum(map(mul, s, guess.x), zero)) for s in spans
        ]
        tied = replace(guess, ties=[*guess.ties, *(zero for _ in held)])
        trial = replace(machine, ties=[*machine.ties, *held])
        try:
            settled = _iterated(trial, tied, tolerance, nothing)
        except Contradiction as found:
            fault = found
            more = [s[: machine.size] for s in found.spans if any(s[: machine.size])]
            more = more if found.left <= ROUNDING else []
        else:
            furthest = max(map(abs, settled.at.x), default=zero)
            if not furthest > NOWHERE:
                return _released(machine, guess, settled, spans)
            more = [[v / furthest for v in settled.at.x]]
        if not more:
            break
        spans += more
    raise NoReference(f"an active set contradicts itself: {fault}") from fault


def _released(machine: Machine, guess: Guess, settled: Settled, spans: list[list[Any]]) -> Settled:
    """Remove the ties of free directions, provided that they carry round-off only."""
    if not spans:
        return settled
    count = len(guess.ties)
    imbalance = max(map(abs, settled.at.ties[count:]))
    if imbalance > ROUNDING * max(max(map(abs, s)) for s in spans):
        raise NoReference(f"a free direction is out of balance by {float(imbalance):.1e}")
    at = replace(settled.at, ties=settled.at.ties[:count])
    return Settled(at, settled.residual, tuple(tuple(s) for s in spans), imbalance)


def _iterated(machine: Machine, guess: Guess, tolerance: Any, nothing: Any) -> Settled:
    at = guess
    free: tuple[tuple[Any, ...], ...] = ()
    equations = Equations(machine, at)
    for _ in range(STEPS):
        at, free = _step(equations, nothing)
        arrived = equations.residual <= tolerance
        equations = Equations(machine, at)
        if arrived:
            break
    return Settled(at, equations.residual, free)


def _step(equations: Equations, nothing: Any) -> tuple[Guess, tuple[tuple[Any, ...], ...]]:
    """Return the next guess of Newton's method; it does not move along null vectors."""
    machine, at = equations.machine, equations.at
    n = machine.size
    step, spans = solve_sparse(equations.rows, list(equations.right), equations.count, nothing)
    x = [a + s for a, s in zip(at.x, _across(step[:n], spans, n), strict=True)]
    forces = {}
    for name, force in at.forces.items():
        new = force + step[equations.force_at[name]]
        curved = machine.contacts[name].law.c
        forces[name] = force / WANING if curved and new <= 0 else new
    bounds = {
        name: bound + step[equations.bound_at[name]] if name in equations.bound_at else bound
        for name, bound in at.bounds.items()
    }
    pulls = {}
    for name, graph in machine.graphs.items():
        q, radius = offset(machine, graph, x)
        unknown = equations.pull_at.get(name, [])
        if len(unknown) == 2:
            pulls[name] = [p + step[k] for p, k in zip(at.pulls[name], unknown, strict=True)]
        elif unknown:
            before, size = offset(machine, graph, at.x)
            now = _along(at.pulls[name], before, size) + step[unknown[0]]
            pulls[name] = [now * v / radius for v in q]
        else:
            pulls[name] = on_piece(graph, at.places[name], q, radius, bounds[name])[0]
    ties = [t + step[k] for t, k in zip(at.ties, equations.tie_at, strict=True)]
    return Guess(x, forces, ties, at.places, pulls, bounds), tuple(tuple(s[:n]) for s in spans)


def loose_directions(machine: Machine, at: Guess) -> list[list[Any]]:
    """Return directions of the coordinates that no force above `ROUNDING` and no spring holds."""
    carrying = {name: force for name, force in at.forces.items() if force > ROUNDING}
    equations = Equations(machine, replace(at, forces=carrying))
    none = [0 * r for r in equations.right]
    _, spans = solve_sparse(equations.rows, none, equations.count, 10 * ROUNDING)
    return [s[: machine.size] for s in spans if any(s[: machine.size])]


def _across(step: list[Any], spans: list[list[Any]], n: int) -> list[Any]:
    """Return the part of a step of the coordinates that is orthogonal to null vectors."""
    moving = [s[:n] for s in spans if any(s[:n])]
    if not moving:
        return step
    rows = [{j: sum(map(mul, one, other)) for j, other in enumerate(moving)} for one in moving]
    right = [-sum(map(mul, one, step)) for one in moving]
    shares, _ = solve_sparse(rows, right, len(moving), 0)
    return [
        v + sum(w * m[i] for w, m in zip(shares, moving, strict=True)) for i, v in enumerate(step)
    ]


def _along(pull: list[Any], q: list[Any], radius: Any) -> Any:
    """Return the component of a pull along an offset; zero without an offset."""
    return (pull[0] * q[0] + pull[1] * q[1]) / radius if radius else pull[0] * 0


def _wrong(machine: Machine, at: Guess, tolerance: Any) -> list[tuple[str, Any]]:
    """Return contacts with the wrong sign, and graphs off their place with the place to move to."""
    found: list[tuple[str, Any]] = []
    for name, contact in machine.contacts.items():
        if name in at.forces:
            if at.forces[name] < -tolerance:
                found.append((name, None))
        elif contact.approach(at.x)[0] > tolerance:
            found.append((name, None))
    for name, graph in machine.graphs.items():
        q, radius = offset(machine, graph, at.x)
        bound, place = at.bounds[name], at.places[name]
        if place in CURVED and not pinned(graph, at):
            size = _along(at.pulls[name], q, radius)
        else:
            p = at.pulls[name]
            size = machine.arithmetic.sqrt(p[0] * p[0] + p[1] * p[1])
        if _admits(graph, place, radius, size, bound, tolerance):
            continue
        better = _next_place(graph, place, radius, size, bound)
        if better != place:
            found.append((name, better))
    return found


def _admits(graph: Graph, place: str, radius: Any, size: Any, bound: Any, band: Any) -> bool:
    end = graph.stick_end(bound)
    if place == "stick":
        only = graph.stick is None and graph.reach < end
        return bool(only or radius <= end + band)
    if place == "step":
        low = graph.stiffness * end
        return bool(low - band <= size <= bound + band)
    if place == "slip":
        return bool(end - band <= radius <= graph.reach + band)
    if place == "stop":
        return bool(radius >= graph.reach - band)
    return bool(size >= bound - band)


def _next_place(graph: Graph, place: str, radius: Any, size: Any, bound: Any) -> str:
    """Return the neighbouring place that a graph moves to."""
    end = graph.stick_end(bound)
    jumps = graph.stiffness is not None and bound > graph.stiffness * end
    last = "wall" if graph.stiffness is None else "stop"
    chain = [
        p
        for p, there in (
            ("stick", end > 0),
            ("step", jumps),
            ("slip", graph.reach > end),
            (last, True),
        )
        if there
    ]
    if place not in chain:
        return graph.place(radius, size, bound)
    up = {
        "stick": radius > end,
        "step": size > bound,
        "slip": radius > graph.reach,
    }.get(place, False)
    index = chain.index(place) + (1 if up else -1)
    return chain[min(max(index, 0), len(chain) - 1)]


def _exchanged(at: Guess, wrong: list[tuple[str, Any]], machine: Machine) -> Guess:
    forces, places = dict(at.forces), dict(at.places)
    for name, place in wrong:
        if place is not None:
            places[name] = place
        elif name in forces:
            del forces[name]
        else:
            contact = machine.contacts[name]
            overlap = contact.approach(at.x)[0]
            forces[name] = _force_of(contact, overlap)
    return replace(at, forces=forces, places=places)


def _force_of(contact: Contact, overlap: Any) -> Any:
    """Return the start of Newton's method on a law: an upper bound of the force at the overlap."""
    law = contact.law
    if law.points or not law.c:
        return overlap * 0
    root = law.arithmetic.sqrt(overlap / law.c)
    if law.b:
        root = min(root, law.arithmetic.cbrt(overlap / law.b))
    return root**3
