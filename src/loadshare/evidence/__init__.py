"""The evidence: a reference in 50 digits, peers on the same data, charts and the stress map.

Nothing a user of the library needs is here. What is measured is written to ``docs/evidence``.
"""
