"""Solvers of programmes, behind one small interface."""
