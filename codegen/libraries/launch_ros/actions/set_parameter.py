"""SetParameter, by upstream's module name."""

from launch_ros.actions._defaults import SetParameter

__all__ = ["SetParameter"]
