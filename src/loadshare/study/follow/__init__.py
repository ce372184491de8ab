"""Follow an equilibrium along a parameter: equations on an active set, and proof that it holds."""
