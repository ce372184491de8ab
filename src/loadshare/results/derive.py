"""Everything in a result, from the claims and the train: the only way to make one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from loadshare.case import Case
from loadshare.results.result import Answered, Position, Result, Stamp
from loadshare.results.share import largest, pair_shares, stage_shares
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
    drive, coast = {}, {}
    for name, mesh in train.meshes.items():
        parts = [mesh.lever(d) * float(flank_force[mesh.flank_name(d)]) for d in mesh.flanks]
        coast[name] = sum(max(-part, 0.0) for part in parts)
        drive[name] = sum(parts)
    return Position(
        position=index,
        torque=drive,
        coast_torque=coast,
        share=stage_shares(drive, train.stages),
        pair_share=pair_shares(drive, train.stages),
        train=train,
        answer=answer,
    )


def result_from(
    case: Case, train: Train, positions: Sequence[Position], stamped: Callable[[], Stamp]
) -> Result:
    """Put positions together as a result.

    Parameters
    ----------
    case : Case
        As it was solved, its mesh laws computed.
    train : Train
        Of that case.
    positions : sequence of Position
    stamped : callable
        Returns the stamp.
    """
    stages = train.stages
    return Result(
        frames={
            n: (tuple(g.plane[0].tolist()), tuple(g.plane[1].tolist()))
            for n, g in train.gears.items()
        },
        stages={s.name: s.meshes for s in stages},
        positions=tuple(positions),
        omega=largest([p.share for p in positions], stages),
        pair_omega=largest([p.pair_share for p in positions], stages),
        case=case,
        stamped=stamped,
    )
