"""The hot path on a graphics processor: one thread owns one sample."""
