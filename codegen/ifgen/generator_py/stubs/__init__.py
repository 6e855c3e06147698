"""Stubs for type checkers: `.pyi` files with the signatures of modules that are there."""
