"""The rendering of a program as Python text."""
