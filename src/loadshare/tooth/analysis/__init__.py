"""Loaded tooth contact analysis: from a pair to its transmission error and its law."""
