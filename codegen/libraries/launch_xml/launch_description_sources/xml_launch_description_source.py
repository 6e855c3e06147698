"""XMLLaunchDescriptionSource, by upstream's module name."""

from launch_xml.launch_description_sources import XMLLaunchDescriptionSource

__all__ = ["XMLLaunchDescriptionSource"]
