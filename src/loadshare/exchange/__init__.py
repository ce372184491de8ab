"""Machines from and for other programs."""
