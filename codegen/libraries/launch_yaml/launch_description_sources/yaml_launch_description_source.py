"""YAMLLaunchDescriptionSource, by upstream's module name."""

from launch_yaml.launch_description_sources import YAMLLaunchDescriptionSource

__all__ = ["YAMLLaunchDescriptionSource"]
