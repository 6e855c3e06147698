"""SetLaunchConfiguration, by upstream's module name."""

from launch.actions.declare_launch_argument import SetLaunchConfiguration

__all__ = ["SetLaunchConfiguration"]
