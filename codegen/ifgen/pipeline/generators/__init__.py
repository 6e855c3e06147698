"""Runs the generators of `[tool.ifgen.generate]`: finds them, gives them the model, checks their files."""
