"""Flanks in mesh without load: where they touch, and how far apart they are elsewhere."""
