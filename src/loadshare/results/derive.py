"""Everything in a result, from the claims and the train: the only way to make one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from loadshare.case import Case
from loadshare.case.table import Table
from loadshare.results.result import Answered, Position, Result, Stamp
from loadshare.results.share import coefficients, flank_torques, largest, largest_of
from loadshare.train.train import Train


def position_of(
    train: Train, index: int, flank_force: Mapping[str, float], answer: Answered
) -> Position:
    """Return what an answer says of a position.

    Parameters
    ----------
    train : Train
        As the position finds it.
    index : int
        1-based.
    flank_force : mapping of flank to float
        Of the answer [N].
    answer : Answered
    """
    flanks = flank_torques(train, flank_force)
    torque = Table({name: sum(both) for name, both in flanks.items()})
    coast = Table({n: sum(max(-part, 0.0) for part in both) for n, both in flanks.items()})
    largest_torque = largest_of(flanks)
    stages = train.stages
    return Position(
        position=index,
        torque=torque,
        coast_torque=coast,
        share=coefficients(torque, [s.meshes for s in stages], largest_torque),
        pair_share=coefficients(torque, [g for s in stages for g in s.groups], largest_torque),
        train=train,
        answer=answer,
    )


def result_from(
    case: Case,
    solved: Case,
    train: Train,
    positions: Sequence[Position],
    stamped: Callable[[], Stamp],
) -> Result:
    """Put positions together as a result.

    Parameters
    ----------
    case : Case
        As it was given.
    solved : Case
        The same, its mesh laws computed.
    train : Train
        Of that case.
    positions : sequence of Position
    stamped : callable
        Returns the stamp.
    """
    stages = train.stages
    return Result(
        frames=Table(
            {
                n: (tuple(g.plane[0].tolist()), tuple(g.plane[1].tolist()))
                for n, g in train.gears.items()
            }
        ),
        stages=Table({s.name: s.meshes for s in stages}),
        positions=tuple(positions),
        omega=largest([p.share for p in positions], stages),
        pair_omega=largest([p.pair_share for p in positions], stages),
        case=case,
        solved=solved,
        stamped=stamped,
    )
