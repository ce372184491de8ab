"""Tables of a spreadsheet: a case in, from CSV or a workbook; case and result out, as CSV."""

from loadshare.exchange.spreadsheet.exporting import export_tables
from loadshare.exchange.spreadsheet.importing import import_tables, is_spreadsheet

__all__ = ["export_tables", "import_tables", "is_spreadsheet"]
