"""Named tuples of arrays, handed to compiled functions by reference.

Numba hands a named tuple over field by field, and reads all of them wherever one is read: of fifty
arrays these are some four hundred numbers, and nine tenths of the time to compile a kernel went
into carrying them about. `reference_type` tells Numba of a better way.
"""

from __future__ import annotations

from typing import Any


def by_reference(fields: Any) -> Any:
    """Return a reference to a named tuple; only functions that are `set_apart` may read it.

    What is not compiled reads the tuple itself.
    """
    return fields


def set_apart() -> None:
    """Keep the compiled function that calls this from becoming a part of its callers.

    There fields are written, and would not be what they are throughout.
    """
