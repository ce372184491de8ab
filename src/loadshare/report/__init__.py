"""Pictures and reports: one specification for screen and paper, and no network.

Nothing is imported here, so that the command line may take number formats from this room without
waiting for Altair.
"""
