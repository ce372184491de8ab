"""`loadshare batch`: many cases, none of which can stop the others."""
