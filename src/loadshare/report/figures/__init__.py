"""The pictures, one idea a file; each function returns a `Figure`."""
