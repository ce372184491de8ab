r"""The common period of all meshes of a train, in whole numbers.

Mesh m goes through :math:`q_m = z_i |\omega_i - \omega_c|` cycles while the input turns once, where
i is its driver and c the carrier from which it is seen. Speeds follow from tooth numbers as
fractions. With the :math:`q_m` in lowest terms, all meshes have first made whole cycles after

.. math:: T = \frac{\operatorname{lcm}(\text{denominators})}{\gcd(\text{numerators})}

revolutions of the input. Source: formulation, section 13.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

from loadshare.train.gear import Gear
from loadshare.train.seen import along, seen_from
from loadshare.train.willis import Ends, SpeedLinks

Row = dict[str, Fraction]


@dataclass(frozen=True, slots=True)
class Period:
    """The common period of all meshes.

    Attributes
    ----------
    revolutions : Fraction
        Of the input.
    cycles : mapping of mesh to int
        Number of cycles of each mesh in the period.
    """

    revolutions: Fraction
    cycles: Mapping[str, int]

    @property
    def fastest(self) -> str:
        """The mesh that goes through the most cycles."""
        return max(self.cycles, key=lambda mesh: self.cycles[mesh])

    def steps(self, positions: int) -> int:
        """Return the number of positions if the fastest mesh has `positions` in each cycle."""
        return positions * self.cycles[self.fastest]


def period_of(
    gears: Mapping[str, Gear],
    meshes: Mapping[str, Ends],
    shafts: Mapping[str, Ends],
    teeth: Mapping[str, int],
    driving: str,
) -> Period:
    """Return the common period of all meshes.

    Parameters
    ----------
    gears : mapping of str to Gear
        Their senses settled.
    meshes, shafts : mapping of str to (str, str)
    teeth : mapping of gear to int
        Of every gear that meshes.
    driving : str
        The input.

    Raises
    ------
    ValueError
        If tooth numbers contradict one another on two paths, or nothing turns.
    """
    counted = {n: replace(gear, base_radius=teeth.get(n, 0)) for n, gear in gears.items()}
    links = SpeedLinks.of(counted, meshes, shafts)
    rows = [
        ({n: Fraction(int(v)) for n, v in zip(counted, row, strict=True) if v}, Fraction(0))
        for row in links.matrix.tolist()
    ]
    rows += [({name: Fraction(1)}, Fraction(0)) for name, gear in gears.items() if gear.held]
    rows.append(({driving: Fraction(1)}, Fraction(1)))
    speeds = _solved(rows)
    passings = {}
    for name, (driver, driven) in meshes.items():
        speed = speeds.get(driver, Fraction(0))
        carrier = seen_from(gears, driver, driven)
        if carrier is not None:
            turns = int(along(gears[driver], gears[carrier]))
            speed -= turns * speeds.get(carrier, Fraction(0))
        passings[name] = teeth[driver] * abs(speed)
    turning = [q for q in passings.values() if q]
    if not turning:
        raise ValueError("no mesh goes through its cycle: nothing turns")
    whole = reduce(lcm, (q.denominator for q in turning))
    period = Fraction(whole, reduce(gcd, (q.numerator for q in turning)))
    return Period(period, {name: int(q * period) for name, q in passings.items()})


def _solved(rows: list[tuple[Row, Fraction]]) -> Row:
    """Solve linear equations in fractions, row after row; unknowns that stay open are left out.

    Raises
    ------
    ValueError
        If they contradict one another.
    """
    known: dict[str, tuple[Row, Fraction]] = {}
    for given, due in rows:
        row, right = dict(given), due
        while (name := next((n for n in row if n in known), None)) is not None:
            right -= _taken(row, name, known[name])
        if not row:
            if right:
                raise ValueError("the tooth numbers on two paths contradict one another")
            continue
        pivot, factor = next(iter(row.items()))
        found = {n: v / factor for n, v in row.items() if n != pivot}, right / factor
        for name, (other, value) in known.items():
            if pivot in other:
                known[name] = other, value - _taken(other, pivot, found)
        known[pivot] = found
    return {name: right for name, (row, right) in known.items() if not row}


def _taken(row: Row, name: str, known: tuple[Row, Fraction]) -> Fraction:
    """Eliminate an unknown, name + others = value, from a row; return what its right side loses."""
    factor = row.pop(name)
    for other, value in known[0].items():
        row[other] = row.get(other, Fraction(0)) - factor * value
        if not row[other]:
            del row[other]
    return factor * known[1]
