"""Results of loaded tooth contact analysis as rows of tables in SI units."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from loadshare.tooth.analysis.result import Ltca
from loadshare.tooth.law.file import MeshLaw

Row = dict[str, Any]

STIFFNESS_LOADS = (1.0, 0.95, 0.9)
"""Parts of the rated torque at which the seed shows the stiffness."""


def position_rows(found: Ltca, law: MeshLaw) -> Iterator[Row]:
    """Yield a row for each position: law, stiffness and lead of the driver.

    Parameters
    ----------
    found : Ltca
    law : MeshLaw
        Of the same analysis.
    """
    secants = {f"secant_{part:g}T_Nm_per_rad": found.secant(part) for part in STIFFNESS_LOADS}
    tangent, step = found.tangent(1.0), found.increment(0.9, 1.0)
    parts = found.torque / found.rated
    for k, phase in enumerate(found.phase):
        yield {
            "position": k + 1,
            "phase": float(phase),
            "a_rad": law.a[k].si,
            "b_rad_per_Nm": law.b[k].si,
            "c_rad_per_Nm23": law.c[k].si,
            "misfit": law.misfit[k],
            **{name: float(values[k]) for name, values in secants.items()},
            "tangent_1T_Nm_per_rad": float(tangent[k]),
            "increment_0.9T_1T_Nm_per_rad": float(step[k]),
            "lead_unloaded_rad": float(found.unloaded_error[k]),
            **{
                f"lead_{part:g}T_rad": float(angle)
                for part, angle in zip(parts, found.angle[k], strict=True)
            },
        }


def line_rows(found: Ltca) -> Iterator[Row]:
    """Yield a row for each point on the contact lines of all positions, under every load."""
    for k, row in enumerate(found.lines):
        for torque, lines in zip(found.torque, row, strict=True):
            for load in lines:
                line = load.line
                for n in range(len(load.force)):
                    yield {
                        "position": k + 1,
                        "torque_Nm": float(torque),
                        "pair": line.pair,
                        "point": n + 1,
                        **{f"{axis}_m": float(line.points[n, i]) for i, axis in enumerate("xyz")},
                        "driver_u": float(line.driver_uw[n, 0]),
                        "driver_w": float(line.driver_uw[n, 1]),
                        "driven_u": float(line.driven_uw[n, 0]),
                        "driven_w": float(line.driven_uw[n, 1]),
                        "length_m": float(line.length[n]),
                        "gap_m": float(line.gap[n]),
                        "load_N_per_m": float(load.per_length[n]),
                        "half_width_m": float(load.half_width[n]),
                        "pressure_Pa": float(load.pressure[n]),
                    }
