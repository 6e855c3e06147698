"""Definitions over time: two versions of an interface compared, and the lock file that keeps one."""
