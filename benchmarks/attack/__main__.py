"""Attack on the certificate: tampered answers, of which none may pass with a wrong torque.

Run with ``python -m benchmarks.attack --count 10000 --seed 1``.
"""

from __future__ import annotations

import argparse
import sys

from benchmarks.attack.judge import ALLOWED, ROUNDING, Attack, attacks
from benchmarks.attack.ways import WAYS


def text(found: list[Attack]) -> str:
    """Table by way, and what slipped through."""
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


def main() -> None:
    """Attack and tell."""
    parser = argparse.ArgumentParser(description="Tampered answers against the certificate.")
    parser.add_argument("--count", type=int, default=10_000, help="tampered answers")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    found = []
    for attack in attacks(asked.seed, asked.count):
        found.append(attack)
        if len(found) % 100 == 0:
            print(f"\r{len(found)} of {asked.count}", end="", file=sys.stderr)  # noqa: T201
    print(text(found))  # noqa: T201
    sys.exit(any(a.slipped or a.margin < -ROUNDING for a in found))


if __name__ == "__main__":
    main()
