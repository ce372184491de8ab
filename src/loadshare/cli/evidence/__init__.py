"""The evidence, measured and computed again: `chart`, `stress`, `reproduce`."""
