"""LaunchConfiguration, by upstream's module name."""

from launch.substitutions._texts import LaunchConfiguration

__all__ = ["LaunchConfiguration"]
