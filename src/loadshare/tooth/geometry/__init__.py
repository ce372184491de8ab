"""What all teeth share: bodies, flanks as surfaces, the gap between two of them."""
