"""REXS, the exchange format of gear units (www.rexs.info), versions 1.0 to 2.0."""

from loadshare.exchange.imported import Imported
from loadshare.exchange.rexs.exporting import export_rexs, in_form_of
from loadshare.exchange.rexs.importing import import_rexs

__all__ = ["Imported", "export_rexs", "import_rexs", "in_form_of"]
