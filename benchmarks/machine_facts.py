"""The computer and the software of a measurement."""

from __future__ import annotations

import os
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = (
    "numpy",
    "scipy",
    "numba",
    "clarabel",
    "osqp",
    "daqp",
    "piqp",
    "moreau",
    "cvxpy",
    "mpmath",
)


def facts() -> dict[str, str]:
    """Return date, processor, Python and package versions, by name."""
    from loadshare._version import __version__

    found = {
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "load of the machine (1, 5, 15 min) at the end": _load(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": sys.version.split()[0],
        "BLAS threads": os.environ.get("OPENBLAS_NUM_THREADS", "not set"),
        "loadshare": __version__,
    }
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def _load() -> str:
    """Return the number of processes that wait for a core, including this one."""
    try:
        return ", ".join(f"{load:.2f}" for load in os.getloadavg())
    except (AttributeError, OSError):
        return "unknown"


def _processor() -> str:
    listing = Path("/proc/cpuinfo")
    if listing.exists():
        for line in listing.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"
