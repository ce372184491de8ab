"""The seed paper's figures, computed: what is printed, what comes out, and why they part."""
