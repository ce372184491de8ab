"""Everything a result tells, from the claims and the train: the only way in which one is made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from loadshare.case import Case
from loadshare.certify import Certificate
from loadshare.certify.uniqueness import uniqueness
from loadshare.certify.validity import Validity, validity
from loadshare.results.claim import Claim
from loadshare.results.result import Effort, Position, Result, Stamp
from loadshare.results.share import largest, pair_shares, stage_shares
from loadshare.train.equilibrium import Range
from loadshare.train.train import Train


def position_of(
    train: Train,
    index: int,
    claim: Claim,
    certificate: Certificate,
    undetermined: Mapping[str, Range],
    effort: Effort,
    measured: Validity | None = None,
) -> Position:
    """Return what a claim says of a position.

    Parameters
    ----------
    train : Train
    index : int
        1-based.
    claim : Claim
    certificate : Certificate
        Of the claim.
    undetermined : mapping of coordinate to (float, float)
    effort : Effort
    measured : Validity, optional
        Of the claim, if it was measured before.
    """
    equilibrium = claim.equilibrium(index, undetermined)
    drive, coast = {}, {}
    for name, mesh in train.meshes.items():
        parts = [mesh.lever(d) * claim.flank_force[mesh.flank_name(d)] for d in mesh.flanks]
        coast[name] = sum(max(-part, 0.0) for part in parts)
        drive[name] = sum(parts)
    moved = {n: g.frame @ claim.displacement[n] for n, g in train.gears.items()}
    return Position(
        position=index,
        torque=drive,
        coast_torque=coast,
        share=stage_shares(drive, train.stages),
        pair_share=pair_shares(drive, train.stages),
        rotation=claim.rotation,
        displacement={n: (float(d[0]), float(d[1])) for n, d in moved.items()},
        floats=certificate.floats,
        certificate=certificate,
        validity=measured or validity(train, equilibrium, certificate.deflection),
        uniqueness=uniqueness(claim.train(train), equilibrium),
        undetermined=undetermined,
        effort=effort,
        claim=claim,
    )


def result_from(case: Case, train: Train, positions: Sequence[Position], stamp: Stamp) -> Result:
    """Put positions together as a result.

    Parameters
    ----------
    case : Case
        As it was solved, its mesh laws computed.
    train : Train
        Of that case.
    positions : sequence of Position
    stamp : Stamp
    """
    stages = train.stages
    return Result(
        stamp=stamp,
        frames={
            n: (tuple(g.frame[0].tolist()), tuple(g.frame[1].tolist()))
            for n, g in train.gears.items()
        },
        stages={s.name: s.meshes for s in stages},
        positions=tuple(positions),
        omega=largest([p.share for p in positions], stages),
        pair_omega=largest([p.pair_share for p in positions], stages),
        case=case,
    )
