"""Pair files: what they may say, how they are read, what is worth knowing of them."""
