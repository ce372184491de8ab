"""Spreadsheets, as CSV files or workbooks: import of cases, export of cases and results."""

from loadshare.exchange.spreadsheet.exporting import (
    export_frames,
    export_tables,
    workbook_of,
    write_tables,
)
from loadshare.exchange.spreadsheet.importing import import_tables, is_spreadsheet

__all__ = [
    "export_frames",
    "export_tables",
    "import_tables",
    "is_spreadsheet",
    "workbook_of",
    "write_tables",
]
