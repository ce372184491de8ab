"""What a solve can find instead of an answer."""


class Unsolved(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """A programme has no answer, or none was found; the message says which."""
