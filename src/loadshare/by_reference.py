"""Named tuples of arrays, passed to compiled functions by reference.

Numba passes a named tuple field by field, and reads all fields wherever one is read: for fifty
arrays these are some four hundred numbers, and passing them on took nine tenths of the time to
compile a kernel. `reference_type` registers a better way with Numba.
"""

from __future__ import annotations

from typing import Any


def by_reference(fields: Any) -> Any:
    """Return a reference to a named tuple; only functions that call `set_apart` may read it.

    Code that is not compiled gets the tuple itself.
    """
    return fields


def set_apart() -> None:
    """Keep the compiled function that calls this from being inlined into its callers.

    The callers write the fields, so that within them the fields would not be invariant.
    """
