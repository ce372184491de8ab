"""The fast method on a graphics processor: one thread owns one sample."""
