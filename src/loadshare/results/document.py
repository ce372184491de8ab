"""The JSON form of a result, and back, without loss."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from loadshare.certify import Certificate, FloatState, Residual, Touch
from loadshare.results.result import Effort, Position, Result, Stamp


def to_document(result: Result) -> dict[str, Any]:
    """Return the result as plain data: the documented JSON form, self-contained."""
    return {
        "case": result.stamp.case,
        "version": result.stamp.version,
        "stamp": asdict(result.stamp),
        "frames": {g: [list(v) for v in f] for g, f in result.frames.items()},
        "stages": {n: list(m) for n, m in result.stages.items()},
        "positions": [_position(p) for p in result.positions],
        "omega": dict(result.omega),
        "pair_omega": dict(result.pair_omega),
    }


def _position(p: Position) -> dict[str, Any]:
    verdict: dict[str, Any] = {"passed": p.certificate.passed}
    verdict |= {name: r.scaled for name, r in p.certificate.residuals.items()}
    return {
        "position": p.position,
        "torque": dict(p.torque),
        "share": dict(p.share),
        "pair_share": dict(p.pair_share),
        "displacement": {g: list(d) for g, d in p.displacement.items()},
        "floats": {g: _plain(f) for g, f in p.floats.items()},
        "certificate": verdict,
        "coast_torque": dict(p.coast_torque),
        "rotation": dict(p.rotation),
        "residuals": {n: asdict(r) for n, r in p.certificate.residuals.items()},
        "scales": {
            "load": p.certificate.load,
            "deflection": p.certificate.deflection,
            "tolerance": p.certificate.tolerance,
        },
        "undetermined": list(p.undetermined),
        "effort": asdict(p.effort),
    }


def _plain(rest: FloatState) -> dict[str, Any]:
    """Return a float's state with lists where JSON has lists."""
    state = asdict(rest)
    for key in ("normal", "reaction"):
        state[key] = None if state[key] is None else list(state[key])
    state["boundaries"] = [b | {"normal": list(b["normal"])} for b in state["boundaries"]]
    return state


def from_document(document: dict[str, Any]) -> Result:
    """Rebuild a result from its JSON form.

    Raises
    ------
    KeyError, TypeError
        If the document is not one that :func:`to_document` wrote.
    """
    return Result(
        stamp=Stamp(**document["stamp"]),
        frames={g: (tuple(f[0]), tuple(f[1])) for g, f in document["frames"].items()},
        stages={n: tuple(m) for n, m in document["stages"].items()},
        positions=tuple(_read_position(p) for p in document["positions"]),
        omega=document["omega"],
        pair_omega=document["pair_omega"],
    )


def _read_position(p: dict[str, Any]) -> Position:
    floats = {g: _read_float(f) for g, f in p["floats"].items()}
    return Position(
        position=p["position"],
        torque=p["torque"],
        coast_torque=p["coast_torque"],
        share=p["share"],
        pair_share=p["pair_share"],
        rotation=p["rotation"],
        displacement={g: (d[0], d[1]) for g, d in p["displacement"].items()},
        floats=floats,
        certificate=Certificate(
            residuals={n: Residual(**r) for n, r in p["residuals"].items()},
            floats=floats,
            tolerance=p["scales"]["tolerance"],
            load=p["scales"]["load"],
            deflection=p["scales"]["deflection"],
        ),
        undetermined=tuple(p["undetermined"]),
        effort=Effort(**p["effort"]),
    )


def _read_float(f: dict[str, Any]) -> FloatState:
    pairs = {k: tuple(f[k]) if f[k] is not None else None for k in ("normal", "reaction")}
    touches = tuple(Touch(**(t | {"normal": tuple(t["normal"])})) for t in f["boundaries"])
    return FloatState(**(f | pairs | {"boundaries": touches}))
