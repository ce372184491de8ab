"""The main job: solve and certify every position of a case, and hand out or refuse the answers."""

from loadshare.job.positions import explain, solve

__all__ = ["explain", "solve"]
