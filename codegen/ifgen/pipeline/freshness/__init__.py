"""Skips the work of a run where nothing has changed: what it finds is compared with notes on earlier runs."""
