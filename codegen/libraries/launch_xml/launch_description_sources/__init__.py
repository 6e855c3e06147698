"""Launch files in XML as sources of descriptions."""

from launch.launch_description_sources import FrontendLaunchDescriptionSource

__all__ = ["XMLLaunchDescriptionSource"]


class XMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A launch file in XML."""
