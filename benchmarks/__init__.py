"""What is measured about loadshare: speed, stability, the seed paper, attacks, random trains.

Each is run as ``python -m benchmarks.NAME`` from a clone; nothing here is installed. With the
measurements come a reference in 50 digits and peers on the same data. What is published goes to
``docs``.
"""

import os

# Before anything imports NumPy: the matrices are far too small to share among threads.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
