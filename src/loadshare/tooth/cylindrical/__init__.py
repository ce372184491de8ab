"""Cylindrical involute gears: dimensions, flanks, solid teeth, pairs."""
