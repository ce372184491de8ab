"""Commands that need more than one equilibrium of a case."""
