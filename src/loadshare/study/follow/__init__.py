"""Follow an equilibrium along a parameter: its equations on a set, and proof that the set holds."""
