"""Files outside the folder of a case, which are read only if the user allows it."""

OUTSIDE = "LOADSHARE_ALLOW_OUTSIDE"
"""Environment variable; if it is not empty, cases may name such files."""
