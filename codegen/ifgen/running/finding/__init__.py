"""Finds programs by the names of their packages."""
