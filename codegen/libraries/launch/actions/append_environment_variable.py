"""AppendEnvironmentVariable, by upstream's module name."""

from launch.actions._environment import AppendEnvironmentVariable

__all__ = ["AppendEnvironmentVariable"]
