"""SetRemap, by upstream's module name."""

from launch_ros.actions._defaults import SetRemap

__all__ = ["SetRemap"]
