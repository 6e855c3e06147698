"""ThisLaunchFileDir, by upstream's module name."""

from launch.substitutions._places import ThisLaunchFileDir

__all__ = ["ThisLaunchFileDir"]
