"""Launch files as sources of descriptions."""

from collections.abc import Callable
from typing import Any

from launch._errors import LaunchError as InvalidFrontendLaunchFileError
from launch._errors import LaunchError as InvalidPythonLaunchFileError
from launch.launch_context import LaunchContext
from launch.launch_description import LaunchDescription
from launch.launch_description_source import LaunchDescriptionSource
from launch.launch_description_sources._reading import load_python_launch_file_as_module, read
from launch.some_substitutions_type import SomeSubstitutionsType

__all__ = [
    "AnyLaunchDescriptionSource",
    "FrontendLaunchDescriptionSource",
    "InvalidFrontendLaunchFileError",
    "InvalidPythonLaunchFileError",
    "PythonLaunchDescriptionSource",
    "get_launch_description_from_any_launch_file",
    "get_launch_description_from_frontend_launch_file",
    "get_launch_description_from_python_launch_file",
    "load_python_launch_file_as_module",
]


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python, XML or YAML."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted launch file")


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in XML or YAML, or in what a parser of users reads."""

    def __init__(
        self,
        launch_file_path: SomeSubstitutionsType,
        *,
        method: str = "interpreted frontend launch file",
        parser: Any = None,
    ) -> None:
        super().__init__(None, launch_file_path, method)
        self._parser = parser

    def _get_launch_description(self, location: str) -> LaunchDescription:
        if self._parser is None:
            return read(location)
        root, parser = self._parser.load(location)
        found: LaunchDescription = parser.parse_description(root)
        return found


class PythonLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A launch file in Python."""


get_launch_description_from_any_launch_file: Callable[[str], LaunchDescription] = read
get_launch_description_from_python_launch_file: Callable[[str], LaunchDescription] = read


def get_launch_description_from_frontend_launch_file(
    launch_file_path: str, *, parser: Any = None
) -> LaunchDescription:
    """Return the description in a file in XML or YAML. Raises LaunchError."""
    source = FrontendLaunchDescriptionSource(launch_file_path, parser=parser)
    return source.get_launch_description(LaunchContext())
