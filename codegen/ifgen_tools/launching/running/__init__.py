"""Runs launch descriptions: their processes, timers and events."""
