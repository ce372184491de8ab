"""Studies of a case: sweeps, critical values, sensitivities, marches with memory, fits.

A study asks for many equilibria, or for how one equilibrium changes. Every equilibrium on which an
answer rests is certified; what lies between them is computed from the equations of an active set.
"""
