"""The fast method: the force method on an identified set of acting elements, for many samples.

One sample is solved like this. A set of acting elements is assumed. On it the redundant forces
follow from compatibility by Newton's method in displacement form: every nonlinear law is replaced
by its tangent at the force that belongs to the last *compression* (a closed form), so the tangent
stays finite when a force vanishes; ring arcs, friction circles and friction bounds that follow the
torque are renewed in the same passes, and there is no outer loop. Then the signs are checked.
Elements with the wrong sign are exchanged, at first all at once, later one at a time; a sample
without a consistent set is left to the next rung of the ladder.

`vectorised` does this with NumPy for all samples of a set together, `compiled` with Numba for
samples side by side (`kernel`); `exchange` takes either of them from set to set.
"""
