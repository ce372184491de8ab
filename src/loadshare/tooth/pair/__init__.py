"""Pair files: what they may contain, how they are read, and warnings about their pairs."""
