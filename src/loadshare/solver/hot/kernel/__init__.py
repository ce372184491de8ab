"""Samples of a set side by side, compiled with Numba: the passes of `vectorised`.

Every loop that costs runs along the samples, so that the processor works on several of them at a
time. They are taken up together and put down together; the few samples that take longer than the
others begin again side by side, where they stand. Tangents of power laws are taken at the
forces, which here takes fewer passes than at the compressions. What has settled is refined for as
long as its neighbours pass; what is given up stands. So an answer depends on the company it was
found in by no more than round-off.

`set_arrays` is what is read of a set and of the samples, `work` what is written; `sums` adds rows
and solves. `fill` takes samples up, `passes` settles them, with `laws`, `arcs` and `radials`
for what is nonlinear, `signs` says what has the wrong sign, and `conclude` stores it.
"""
