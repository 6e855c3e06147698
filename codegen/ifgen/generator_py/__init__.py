"""Interfaces in Python: contexts with finished strings, and the templates that they fill."""
