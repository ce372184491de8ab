"""Pictures and reports: one specification for screen and paper, and no network.

Nothing is imported here, so that the command line can use number formats from this package without
waiting for Altair.
"""
