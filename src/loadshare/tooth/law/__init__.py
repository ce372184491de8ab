"""Sources of the law of a mesh: a standard, a file, an analysis kept on disk."""
