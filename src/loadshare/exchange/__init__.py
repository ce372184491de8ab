"""Exchange of machines with other programs."""
