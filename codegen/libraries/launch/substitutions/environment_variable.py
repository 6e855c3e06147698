"""EnvironmentVariable, by upstream's module name."""

from launch.substitutions._system import EnvironmentVariable

__all__ = ["EnvironmentVariable"]
