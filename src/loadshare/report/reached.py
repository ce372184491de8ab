"""Where a load-sharing coefficient is largest, in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from loadshare.report.numbers import NONE, omega

Shares = Sequence[tuple[int, Mapping[str, float | None]]]


def reached(shares: Shares, meshes: Sequence[str]) -> str:
    """Return the branch, and the position if it matters, at which Ω is largest.

    Parameters
    ----------
    shares : sequence of (position, mapping of mesh to float or None)
    meshes : sequence of str
        Of the stage; none for the whole system, of which nothing is told.
    """
    found = [(s[m], m, k) for k, s in shares for m in meshes]
    known = [(v, m, k) for v, m, k in found if v is not None]
    if not known:
        return "" if not meshes else NONE
    largest, mesh, position = max(known, key=lambda f: f[0])
    top = [(m, k) for v, m, k in known if omega(v) == omega(largest)]
    if len(top) == len(found):
        return "all alike"
    if sum(m == mesh for m, _ in top) == len(shares):
        return mesh
    return f"{mesh}, position {position}"
