"""Launch files in YAML as sources of descriptions."""

from launch.launch_description_sources import FrontendLaunchDescriptionSource

__all__ = ["YAMLLaunchDescriptionSource"]


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A launch file in YAML."""
