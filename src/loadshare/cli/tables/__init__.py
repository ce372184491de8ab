"""A result as an engineer reads it."""
