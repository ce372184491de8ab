"""Stability where methods fail: families of problems from harmless to extreme, and their map."""
