"""A result as an engineer reads it."""

from loadshare.cli.tables.heading import print_heading
from loadshare.cli.tables.result import print_result

__all__ = ["print_heading", "print_result"]
