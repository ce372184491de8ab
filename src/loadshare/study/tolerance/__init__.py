"""Tolerance studies: inputs that scatter, and what load sharing makes of them.

Inputs are drawn in fixed blocks, each from its own seed, so that a sample is the same whoever
solves it and when. Whole blocks make a part, one Parquet file; statistics are read from the parts.
"""
