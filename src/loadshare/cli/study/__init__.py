"""Commands that ask more than one equilibrium of a case."""
