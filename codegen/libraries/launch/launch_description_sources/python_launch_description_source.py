"""PythonLaunchDescriptionSource, by upstream's module name."""

from launch.launch_description_sources import PythonLaunchDescriptionSource

__all__ = ["PythonLaunchDescriptionSource"]
