"""Attack on the certificate: no tampered answer may pass with a wrong torque.

Run with ``python -m benchmarks.attack --count 10000 --page docs/evidence/attack.md``.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
from pathlib import Path

from benchmarks import kept
from benchmarks.attack.judge import ALLOWED, ROUNDING, Attack, part
from benchmarks.attack.ways import WAYS


def text(found: list[Attack]) -> str:
    """Return a table of results by way of tampering, and the answers that slipped through."""
    lines = [
        f"{len(found)} tampered answers of {len({a.train for a in found})} trains",
        "",
        "| way | tried | off by more than 1e-9 | of these passed | passed | worst that passed |",
        "| --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for way in [*WAYS, ""]:
        some = [a for a in found if way in ("", a.way)]
        passed = [a.error for a in some if a.passed]
        cells = (
            way or "**all**",
            str(len(some)),
            str(sum(a.error > ALLOWED for a in some)),
            str(sum(a.slipped for a in some)),
            str(len(passed)),
            f"{max(passed):.1e}" if passed else "–",
        )
        lines.append(f"| {' | '.join(cells)} |")
    broken = [a for a in found if a.margin < -ROUNDING]
    lines += ["", f"Bounds below the true error: {len(broken)}."]
    lines += [f"slipped: {a}" for a in found if a.slipped]
    lines += [f"bound broken: {a}" for a in broken]
    return "\n".join(lines)


ABOUT = """# Attack on the certificate

Can a wrong answer pass the certificate? Here answers are changed so that they still look like
equilibria, and `certify` judges them. None may pass if one of its torques is off by more than 1e-9
of the largest torque (of a flank, or an external one). The reference in 50 digits gives the true
errors. The trains are shipped ones, splits up to a million times as stiff as the mesh before them,
trains with all gears shifted together by 10 mm, and random ones (`benchmarks/random_trains`). The
sizes of the changes are spread evenly over the decades: numbers by 1e-12 to 1e-6 of themselves,
self-stress and moved forces by 1e-13 to 1e-2 of the load. Self-stress is the null space of the
balance of forces and moments, assembled from the train by code that shares nothing with solver,
scene or certificate.

"""


def main() -> None:
    """Attack and report."""
    parser = argparse.ArgumentParser(description="Tampered answers against the certificate.")
    parser.add_argument("--count", type=int, default=10_000, help="number of tampered answers")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2], help="one process for each")
    parser.add_argument("--page", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    shares = [(seed, options.count // len(options.seeds)) for seed in options.seeds]
    with multiprocessing.get_context("spawn").Pool(len(shares)) as pool:
        found = [attack for some in pool.imap(part, shares) for attack in some]
    seeds = " ".join(map(str, options.seeds))
    words = f"benchmarks.attack --count {options.count} --seeds {seeds}"
    kept.publish(options.page, ABOUT, words, text(found))
    sys.exit(any(a.slipped or a.margin < -ROUNDING for a in found))


if __name__ == "__main__":
    main()
