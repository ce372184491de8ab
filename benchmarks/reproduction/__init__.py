"""The seed paper's figures, computed: printed values, computed values, and why they differ."""
