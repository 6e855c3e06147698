"""Command, by upstream's module name."""

from launch.substitutions._system import Command

__all__ = ["Command"]
