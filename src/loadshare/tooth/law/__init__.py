"""Where the law of a mesh comes from: a standard, a file, an analysis kept on disk."""
