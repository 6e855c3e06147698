"""AnyLaunchDescriptionSource, by upstream's module name."""

from launch.launch_description_sources import AnyLaunchDescriptionSource

__all__ = ["AnyLaunchDescriptionSource"]
