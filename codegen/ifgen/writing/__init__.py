"""Writes to disk: all changes of a run or none, and one run at a time."""
