"""Tolerance studies: how load sharing scatters if inputs do.

Inputs are drawn in fixed blocks, each from its own seed, so that a sample does not depend on which
process solves it or when. A part is one or more whole blocks in one Parquet file; statistics are
read from the parts.
"""
