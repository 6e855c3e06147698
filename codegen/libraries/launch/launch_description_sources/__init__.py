"""Launch files as sources of descriptions."""

from launch.launch_description_source import LaunchDescriptionSource
from launch.some_substitutions_type import SomeSubstitutionsType

__all__ = [
    "AnyLaunchDescriptionSource",
    "FrontendLaunchDescriptionSource",
    "PythonLaunchDescriptionSource",
]


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python, XML or YAML."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted launch file")


class FrontendLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A launch file in XML or YAML."""


class PythonLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A launch file in Python."""
