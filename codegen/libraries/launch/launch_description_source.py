"""Where included descriptions come from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.launch_description import LaunchDescription
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class LaunchDescriptionSource:
    """A description, or a file that contains one."""

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: SomeSubstitutionsType = "",
        method: str = "unspecified mechanism from a script",
    ) -> None:
        self.method = method
        self._description = launch_description
        self._location = normalize_to_list_of_substitutions(location)
        self._expanded: str | None = None

    @property
    def location(self) -> str:
        """The path of the file; before it is read, how it is found."""
        return self._expanded or " + ".join(each.describe() for each in self._location)

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the description, read from its file at the first call."""
        if self._description is None:
            self._expanded = perform_substitutions(context, self._location)
            context.packages.near(self._expanded)
            self._description = self._get_launch_description(self._expanded)
        return self._description

    def _get_launch_description(self, location: str) -> LaunchDescription:
        """Return the description in a file. Raises LaunchError."""
        # It imports descriptions, which import their sources.
        from launch.launch_description_sources._reading import read

        return read(location)

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """Return the description if it is there already."""
        return self._description
