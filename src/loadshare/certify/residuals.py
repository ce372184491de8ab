"""The residuals of a claimed equilibrium (formulation, section 8), each the train's worst."""

from __future__ import annotations

import math

import numpy as np

from loadshare.certify.state import State

ROUNDED = 16.0 * float(np.finfo(float).eps)
"""Rounding of energies, relative to the sum of their sizes."""


def force_balance(state: State) -> tuple[float, str]:
    """Largest unbalanced force [N] on a gear that can be displaced, and the gear."""
    train = state.train
    total = {name: -force @ train.gears[name].frame for name, _, _, force in state.bearings()}
    for push in state.pushes:
        for gear, sign in ((push.pushed, 1.0), (push.pushing, -1.0)):
            if gear in total:
                total[gear] = total[gear] + sign * push.force * push.normal
    for pull in state.pulls:
        total[pull.gear] = total[pull.gear] + pull.reaction
    return _worst({g: float(np.linalg.norm(train.gears[g].frame @ f)) for g, f in total.items()})


def moment_balance(state: State) -> tuple[float, str]:
    """Largest unbalanced moment over base radius [N] on gears that turn as one, and one of them."""
    train = state.train
    unbalanced = {}
    for group in state.rigid.groups:
        if train.output not in group:
            radius = max(train.gears[g].base_radius for g in group)
            unbalanced[group[0]] = abs(math.fsum(state.moment[g] for g in group)) / radius
    return _worst(unbalanced)


def penetration(state: State) -> tuple[float, str]:
    """Deepest overlap [m] that a force of the claimed size does not explain, and the contact."""
    overlaps = {}
    for push in state.pushes:
        overlaps[push.name] = push.approach - push.law.compression(max(push.force, 0.0))
    for pull in state.pulls:
        overlaps[pull.name] = float(np.linalg.norm(pull.offset)) - pull.law.reach
    return _worst(overlaps)


def complementarity(state: State) -> tuple[float, str]:
    """Largest work [J] of a force over an open gap, and the contact."""
    return _worst(
        {
            p.name: p.force * (p.law.compression(max(p.force, 0.0)) - p.approach)
            for p in state.pushes
        }
    )


def deformation_law(state: State, band: float) -> tuple[float, str]:
    """Largest misfit [m] of a compressed contact, shaft or bearing with its law, and the element.

    Parameters
    ----------
    state : State
    band : float
        Force [N] below which a contact counts as open; complementarity judges it then.
    """
    misfits = {
        p.name: abs(p.approach - p.law.compression(p.force)) for p in state.pushes if p.force > band
    }
    for name, wind, torque in state.winds():
        shaft = state.train.shafts[name]
        lag = abs(wind - torque / shaft.stiffness)
        misfits[name] = lag * state.train.gears[shaft.first].base_radius
    for name, moved, stiffness, force in state.bearings():
        held = stiffness > 0.0
        off = (moved - force / np.where(held, stiffness, 1.0))[held]
        misfits[f"bearing {name}"] = float(np.linalg.norm(off))
    for name, gear in state.train.gears.items():
        allowed = np.zeros(3)
        if gear.support is not None:
            allowed = (gear.frame @ state.moved(name)) @ gear.frame
        misfits[f"gear {name}"] = float(np.linalg.norm(state.moved(name) - allowed))
    output = state.train.output
    turned = state.answer.rotation[output] * state.train.gears[output].base_radius
    misfits[f"gear {output} rotation"] = abs(turned)
    return _worst(misfits)


def cone_membership(state: State, band: float) -> tuple[float, str]:
    """Largest excess [N] of a force over what its contact or graph admits, and the element.

    Parameters
    ----------
    state : State
    band : float
        Radius [m] within which a graph's corner admits its whole step.
    """
    excess = {p.name: -p.force for p in state.pushes}
    for name, _, stiffness, force in state.bearings():
        excess[f"bearing {name}"] = float(np.linalg.norm(force[stiffness == 0.0]))
    excess |= state.squeezes(band)
    for pull in state.pulls:
        radius = float(np.linalg.norm(pull.offset))
        size = float(np.linalg.norm(pull.reaction))
        low, high = pull.law.interval(radius, band)
        along = size
        sideways = 0.0
        if radius > band:
            outward = pull.offset / radius
            along = -float(pull.reaction @ outward)
            sideways = float(np.linalg.norm(pull.reaction + along * outward))
            sideways -= size * band / radius
        excess[pull.name] = max(low - along, along - high, sideways)
    return _worst(excess)


def energy_gap(state: State) -> tuple[float, str]:
    """Potential less complementary energy [J], beyond rounding: zero at an equilibrium.

    Bearings and rings may hold far more energy against one another than the load brings in.
    """
    primal, dual = [], []
    for gear, torque in state.situation.torque.items():
        primal.append(-torque * state.answer.rotation[gear])
    for push in state.pushes:
        primal.append(push.law.energy(push.approach))
        dual += [-push.law.complementary(max(push.force, 0.0)), push.force * push.at_rest]
    for name, wind, torque in state.winds():
        shaft = state.train.shafts[name]
        if not math.isinf(shaft.stiffness):
            primal.append(0.5 * shaft.stiffness * wind**2)
        dual += [-0.5 * torque**2 / shaft.stiffness, -torque * shaft.clocking]
    for _, moved, stiffness, force in state.bearings():
        primal.append(0.5 * float(stiffness @ moved**2))
        held = stiffness > 0.0
        dual.append(-0.5 * float((force[held] ** 2 / stiffness[held]).sum()))
    for spline in state.train.splines.values() if state.train.slip is not None else ():
        bent = float(np.linalg.norm(state.bending(spline)))
        energy = 0.5 * spline.bending_stiffness * bent**2
        primal.append(energy)
        dual.append(-energy)
    for pull in state.pulls:
        # What exceeds a graph's strength is for cone membership to judge.
        size = min(float(np.linalg.norm(pull.reaction)), pull.law.strength)
        primal.append(pull.law.energy(float(np.linalg.norm(pull.offset))))
        dual += [-pull.law.complementary(size), float(pull.reaction @ pull.centre)]
    rounding = ROUNDED * math.fsum(map(abs, (*primal, *dual)))
    gap = abs(math.fsum(primal) - math.fsum(dual))
    return max(gap - rounding, 0.0), "the whole train"


def _worst(values: dict[str, float]) -> tuple[float, str]:
    """Largest value, not below zero, and where it stands; not-a-number is the worst of all."""
    worst, where = 0.0, ""
    for name, value in values.items():
        if math.isnan(value):
            return math.inf, name
        if value > worst:
            worst, where = value, name
    return worst, where
