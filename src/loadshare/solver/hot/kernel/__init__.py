"""Samples of a set side by side, compiled with Numba: the passes of `vectorised`.

Every costly loop runs along the samples, so that the processor works on several of them at a time.
Samples are loaded together and stored together; the few that take longer than the others start
again side by side, from their last iterates. Tangents of power laws are taken at the forces, which
takes fewer passes here than at the compressions. A sample that has settled is refined for as long
as its neighbours need passes; one that is given up no longer changes. So an answer depends on the
samples solved beside it by no more than round-off.

`set_arrays` has the arrays that are read, of a set and of the samples, `work` those that are
written; `sums` adds rows and solves systems. `fill` loads samples, `passes` settles them, with
`laws`, `arcs` and `radials` for nonlinear elements, `signs` finds wrong signs, and `conclude`
stores the result.
"""
