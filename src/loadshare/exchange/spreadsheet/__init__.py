"""Tables of a spreadsheet: a case in, from CSV or a workbook; case and result out, likewise."""

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
