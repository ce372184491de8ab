"""How far something has come, as those who wait for it are told."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

Progress: TypeAlias = Callable[[int, int], None]
"""Called from time to time with the number of what is done and the number of all."""
