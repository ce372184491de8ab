"""Batches of random trains: how fast they are, and whether they agree with single solves."""
