"""Modules that convert messages of another version of a type (docs/adapters.md)."""
