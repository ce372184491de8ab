"""Geometry common to all teeth: bodies, flanks as surfaces, the gap between two flanks."""
