"""SetEnvironmentVariable, by upstream's module name."""

from launch.actions._environment import SetEnvironmentVariable

__all__ = ["SetEnvironmentVariable"]
