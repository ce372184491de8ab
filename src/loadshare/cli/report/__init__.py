"""A result as an engineer reads it."""

from loadshare.cli.report.heading import print_heading
from loadshare.cli.report.result import print_result

__all__ = ["print_heading", "print_result"]
