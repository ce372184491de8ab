"""Files outside of the folder of a case: read only where the reader says so."""

OUTSIDE = "LOADSHARE_ALLOW_OUTSIDE"
"""Environment variable: not empty where cases may name such files."""
