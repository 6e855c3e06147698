"""Skips the work of a run where nothing has changed: compares what it reads with a record of earlier runs."""
