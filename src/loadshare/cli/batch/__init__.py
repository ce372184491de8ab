"""`loadshare batch`: many cases, of which none can stop the others."""
