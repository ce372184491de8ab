"""The main job: every position of a case solved, certified, and handed out or refused."""

from loadshare.job.positions import Progress, explain, solve

__all__ = ["Progress", "explain", "solve"]
