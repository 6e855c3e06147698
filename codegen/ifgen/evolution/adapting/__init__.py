"""Adapters: modules that convert messages of an earlier version of a type (docs/adapters.md)."""
