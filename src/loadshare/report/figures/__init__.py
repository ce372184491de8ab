"""The pictures, one idea a file; each function returns a `Figure`."""

from loadshare.report.altair_alone import import_altair

import_altair()
