"""Face gears and their pinions: generation, flanks, limits, pairs."""
