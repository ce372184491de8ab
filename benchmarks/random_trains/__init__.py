"""Random trains of every element, solved and compared with the 50-digit reference.

`python -m benchmarks.random_trains --count 5000 --seed 1` draws, solves, compares and reports.
"""
