"""Measurements of loadshare: speed, stability, the seed paper, attacks, random trains.

Each is run as ``python -m benchmarks.NAME`` from a clone; nothing here is installed. There is also
a reference in 50 digits, and peers that solve the same data. Published results go to ``docs``.
"""

import os

# This must happen before anything imports NumPy. The matrices are far too small to be shared among
# threads.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
